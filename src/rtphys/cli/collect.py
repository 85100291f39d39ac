"""`rtphys collect`: verified episodes of one or more tasks."""

import fnmatch
import os
import shlex
import signal
import sys
from collections.abc import Sequence
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING, Annotated

import typer

from rtphys import library
from rtphys.errors import RtphysError, UnknownName

if TYPE_CHECKING:
    from rtphys.collect import CollectPlan, Summary

Tasks = Annotated[list[str], typer.Option("--task", help="A task or a pattern; repeatable.")]
Held = Annotated[
    list[str] | None, typer.Option("--set", help="key=value of an attribute; repeatable.")
]
Workers = Annotated[int | None, typer.Option(help="Processes; default one a core.")]


Sweep = Annotated[str, typer.Option(help="key=value,value: the same seeds under each of these.")]


class Incomplete(RtphysError):
    """Tasks were given up before they had their episodes."""

    exit_code = 4


class Interrupted(RtphysError):
    """Ctrl-C or a polite kill."""

    exit_code = 130


def collect(
    task: Tasks,
    episodes: Annotated[int, typer.Option(help="How many, of each task.")] = 10,
    seed: Annotated[int, typer.Option(help="The first seed; attempts go upward from it.")] = 0,
    protocol: Annotated[str, typer.Option(help="What varies between episodes.")] = "clean",
    out: Annotated[Path, typer.Option(help="The dataset's folder.")] = Path("data"),
    workers: Workers = None,
    cameras: Annotated[str, typer.Option(help="Of head, left, right, front.")] = "head,left,right",
    layout: Annotated[str, typer.Option(help="native or legacy.")] = "native",
    only: Annotated[str, typer.Option(help="Vary these attributes alone (comma-separated).")] = "",
    held: Held = None,
    sweep: Sweep = "",
    resume: Annotated[bool, typer.Option(help="Continue what is in the folder.")] = True,
    shader: Annotated[str, typer.Option(help="slim, default, minimal or rt.")] = "slim",
    max_attempts: Annotated[
        int | None, typer.Option(help="Of each task, those of earlier runs included.")
    ] = None,
) -> None:
    """Collect verified episodes of one or more tasks.

    Attempts are simulated without pictures, and only successes are drawn. What comes out depends
    on the options alone, not on the number of workers or on interruptions.
    """
    # Imported here: everything above this line should be refused before the simulator is loaded.
    names = expand(task)
    from rtphys.collect import CollectPlan, swept
    from rtphys.physics.overrides import parse_overrides

    plan = CollectPlan(
        tasks=names,
        episodes=episodes,
        out=out,
        first_seed=seed,
        protocol=protocol,
        only=split(only) or None,
        overrides=parse_overrides(held or []),
        cameras=split(cameras),
        layout=layout,
        shader=shader,
        workers=cores() if workers is None else workers,
        resume=resume,
        most_attempts=max_attempts,
    )
    _collect_all(swept(plan, sweep) if sweep else (plan,))


def _collect_all(plans: Sequence["CollectPlan"]) -> None:
    """One after the other, also when some are given up.

    Raises:
        Incomplete: some were.
    """
    given_up: list[str] = []
    for one in plans:
        if one.config:
            typer.echo(f"{one.config}:", err=True)
        given_up += _tell(_run(one))
    if given_up:
        raise Incomplete("; ".join(given_up) + "; `rtphys check` tells why attempts fail")
    typer.echo(f"to check every file: rtphys verify-manifest {shlex.quote(str(plans[0].out))}")


def expand(patterns: list[str]) -> tuple[str, ...]:
    """Task names of names and patterns, each once, in the order asked for.

    Raises:
        UnknownName: a name or pattern that matches no task; names the nearest match.
    """
    known = library.names("tasks")
    found: dict[str, None] = {}
    for pattern in patterns:
        matches = fnmatch.filter(known, pattern)
        if not matches:
            raise UnknownName("task", pattern, known)
        found |= dict.fromkeys(matches)
    return tuple(found)


def split(text: str) -> tuple[str, ...]:
    """`"a, b"` -> `("a", "b")`."""
    return tuple(part for raw in text.split(",") if (part := raw.strip()))


def cores() -> int:
    """CPU cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _run(plan: "CollectPlan") -> "Summary":
    from rtphys.cli.collect_progress import Lines, Live
    from rtphys.collect import collect as run

    signal.signal(signal.SIGTERM, _as_interrupt)
    with Live() if sys.stderr.isatty() else Lines() as shown:
        try:
            return run(plan, shown)
        except KeyboardInterrupt:
            told = f"stopped; what is there is whole. To go on, repeat: {_same_command()}"
            raise Interrupted(told) from None


def _as_interrupt(_: int, __: FrameType | None) -> None:
    raise KeyboardInterrupt


def _same_command() -> str:
    return shlex.join(["rtphys", *sys.argv[1:]])


def _tell(summary: "Summary") -> list[str]:
    """Shows what came of a run; returns which tasks were given up, and why."""
    from rtphys.cli.collect_progress import summary_table, wide_console

    wide_console().print(summary_table(summary.tallies))
    minutes = summary.seconds / 60
    new = sum(tally.new_episodes for tally in summary.tallies)
    typer.echo(f"{new} new episodes in {minutes:.1f} min, in {summary.out}")
    return [f"{t.task}: {t.stopped}" for t in summary.tallies if t.stopped]
