"""The `rtphys` command: global options and the list of commands.

To add a command, write a function of its name (dashes become underscores), or a `typer.Typer` of
its name if it has commands of its own, in `rtphys/cli/<name>.py` or in a module that
`rtphys.cli.lazy.MODULES` names, and add a line below.
"""

import os
from importlib.metadata import version
from pathlib import Path
from typing import Annotated

import typer

from rtphys.cli.lazy import LazyGroup, add_stubs
from rtphys.cli.terminal import say

GROUPS = {
    "Make a dataset": {
        "collect": "Collect verified episodes of one or more tasks.",
        "render": "Draw a dataset again: other cameras, sizes, senses or looks.",
        "merge": "Join datasets, such as the shards of a collection.",
        "subset": "Copy a part of a dataset.",
        "convert": "Write a dataset again in the other official layout.",
        "verify": "Check a dataset against its manifest, and its seeds.",
        "export": "Write a dataset in the format of another tool.",
        "verify-export": "Compare a LeRobot export with its dataset, number by number.",
    },
    "Look at it": {
        "show": "Show one episode in the terminal or as a picture.",
        "view": "Look at an episode in Rerun, a viewer of recordings.",
        "report": "Show a dataset, or an evaluation, on one HTML page.",
    },
    "Extend it: tasks and physics of your own": {
        "tasks": "List the tasks and what they need.",
        "new-task": "Write a task file to start from.",
        "try": "Try a task's expert once: its stages, and where it stuck.",
        "check": "Try a task's expert over many seeds, without pictures.",
        "domains": "Show and check the ranges of the physical attributes.",
        "protocols": "Show what may differ between episodes.",
        "physics": "Draw physical attributes and prove their laws.",
    },
    "Evaluate policies": {
        "certify": "Find the seeds on which policies are evaluated.",
        "evaluate": "Say how often a policy succeeds on certified instances.",
        "compare": "Show evaluations side by side, and beside the paper's.",
        "robotwin-root": "Write a folder that RoboTwin's scripts take for RoboTwin.",
    },
    "Studies": {
        "sensitivity": "Measure how far from nominal physics may be in a task.",
        "identify": "Find which physics can be inferred from what a robot senses.",
    },
    "This machine": {
        "assets": "Build, inspect or link the asset packs.",
        "bench": "Measure what an episode costs on this machine.",
        "doctor": "Find what keeps this machine from working, and its cure.",
    },
}
COMMANDS = {name: text for group in GROUPS.values() for name, text in group.items()}

SHIPPED = ("probes", "examples/own_attributes")  # libraries of their own, beside the tasks

EPILOG = """Examples:

rtphys collect click_bell --episodes 10\n
rtphys collect 'stack_*' --protocol phys_random --set friction=0.2\n
rtphys check click_bell --seeds 50 --protocol clean,phys_random\n
rtphys verify data
"""

app = typer.Typer(
    cls=LazyGroup,
    add_completion=True,  # `rtphys --install-completion`; subcommands have no such options
    no_args_is_help=True,
    pretty_exceptions_show_locals=False,
    epilog=EPILOG,
    context_settings={"help_option_names": ["-h", "--help"]},
)
for _group, _commands in GROUPS.items():
    add_stubs(app, _commands, _group)


def _version(wanted: bool) -> None:
    if wanted:
        say(f"rtphys {version('rtphys')}")
        raise typer.Exit()


def _folder(path: Path) -> Path:
    """A library's folder; one that ships with rtphys is found from anywhere."""
    from rtphys.core.library import bundled

    shipped = str(path) in SHIPPED and not path.exists()
    return bundled() / path if shipped else path.resolve()


@app.callback()
def main(
    library: Annotated[
        list[Path] | None,
        typer.Option(
            metavar="DIR",
            help="A folder with tasks/, domains/, manifests/ of your own; repeatable. "
            "`probes`: the short tasks that find physics out.",
        ),
    ] = None,
    assets: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="An asset pack to use instead of the builtin one."),
    ] = None,
    fallback: Annotated[
        str,
        typer.Option(metavar="TEXT", help="`builtin`: it stands in for what --assets lacks."),
    ] = "",
    debug: Annotated[bool, typer.Option("--debug", help="Show tracebacks.")] = False,
    say_version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    """Physics-diverse bimanual manipulation: sample, solve, keep what is feasible, prove it."""
    # Environment variables, because workers are spawned processes that read them again.
    if library:
        known = os.environ.get("RTPHYS_LIBRARY")
        os.environ["RTPHYS_LIBRARY"] = os.pathsep.join(
            [*([known] if known else []), *(str(_folder(path)) for path in library)]
        )
    if assets:
        os.environ["RTPHYS_ASSETS"] = str(assets.resolve())
    if fallback:
        os.environ["RTPHYS_ASSETS_FALLBACK"] = fallback


if __name__ == "__main__":
    app()
