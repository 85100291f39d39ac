"""A command group that imports a command's module only when that command is called."""

import errno
import re
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from importlib import import_module
from io import TextIOWrapper
from keyword import iskeyword

import typer
from typer.core import TyperGroup

from rtphys.cli.terminal import GIVEN, Interrupted, command_line, say
from rtphys.core.dependencies import cure_of
from rtphys.core.errors import BadValue, RtphysError

GROUPS = {
    "Make a dataset": {
        "collect": ("collect", "Collect verified episodes of one or more tasks."),
        "render": ("datasets", "Draw a dataset again, with other cameras, sizes, senses or looks."),
        "merge": ("datasets", "Join datasets, such as the shards of a collection."),
        "subset": ("datasets", "Copy a part of a dataset, and renumber its episodes."),
        "convert": ("datasets", "Write a dataset again in the other official layout."),
        "verify": ("datasets", "Check every file, and derive the physics again from the seeds."),
        "export": ("datasets", "Write a dataset in the format of another tool."),
        "verify-export": ("datasets", "Compare a LeRobot export with its dataset."),
    },
    "Look at it": {
        "show": ("show", "Show one episode in the terminal or as a picture."),
        "view": ("show", "Show an episode in Rerun: cameras, 3D, forces, physics, stages."),
        "report": ("show", "Show a dataset, or an evaluation, on one HTML page."),
    },
    "Extend it: your own tasks and physics": {
        "tasks": ("authoring", "List the tasks: arms, mechanism, objects, domain, rates."),
        "new-task": ("authoring", "Write a task file to start from; it already runs."),
        "try": ("authoring", "Try a task's expert once; show its stages and where it got stuck."),
        "check": ("authoring", "Try a task's expert over many seeds, without pictures."),
        "domains": ("authoring", "Show and check the ranges of the physical attributes."),
        "protocols": ("authoring", "Show what each protocol varies between episodes."),
        "physics": ("physics", "Show sampled values, test their laws, and audit labels."),
    },
    "Evaluate policies": {
        "certify": ("evaluate", "Find the seeds that the expert solves, to evaluate policies on."),
        "evaluate": ("evaluate", "Say how often a policy succeeds on certified instances."),
        "compare": ("evaluate", "Compare evaluations with each other and with the paper."),
        "robotwin-root": ("evaluate", "Write a folder in which RoboTwin's launch scripts run."),
    },
    "Studies": {
        "sensitivity": ("research", "Measure how far physics may be off before a task fails."),
        "identify": ("research", "Find which physics can be inferred from what a robot senses."),
    },
    "This machine": {
        "assets": ("machine", "Build, inspect or link the asset packs."),
        "bench": ("machine", "Measure what an episode costs on this machine."),
        "doctor": ("machine", "Find what does not work on this machine, and how to fix it."),
    },
}
"""Group in the help -> its commands -> the module in this package, first sentence of the help."""
COMMANDS = {name: facts for group in GROUPS.values() for name, facts in group.items()}
# What a command, or a word after it, was called in 1.0; it works until 1.2.
ALIASES = {"verify-manifest": "verify"}
FORMER = {
    "certify": {"--baselines": "--replays"},
    "check": {"--robots": "--baselines"},
    "collect": {"--seed": "--first-seed"},
    "evaluate": {"--set": "--policy-option", "--seed": "--policy-seed"},
    "verify": {"--replay": "--reproduce"},
    "physics": {"prove": "law-test", "--seed": "--first-seed"},
    "show": {"--number": "--episode"},
}
NO_RESUME = "a folder of another run is refused without it, too"
GONE = {
    ("check", "--sheet"): "`rtphys try TASK --picture FILE` draws an attempt",
    ("collect", "--estimate"): "`--dry-run` says what the table in docs/scale.md knows",
    ("collect", "--no-resume"): NO_RESUME,
    ("compare", "--table"): "`--json` has the rates",
    ("evaluate", "--no-resume"): NO_RESUME,
    ("verify", "--signed-by"): "`ssh-keygen -Y verify` checks a signature, see docs/trust.md",
    ("verify", "--shader"): "a dataset says itself what its pictures were drawn with",
}
"""Options of 1.0 that are no more, and what there is instead."""
OF_LIBRARIES = ("task", "task or domain", "domain", "protocol", "embodiment", "attribute")
FIRST = {"--library", "--assets", "--fallback", "--debug"}  # stand before the command's name
RUNNING = "rtphys.running"  # key of the context's memory: the command, and its arguments


class LazyGroup(TyperGroup):
    """Turns every error that a user can cause into one line and an exit code.

    The line names options by their flags, where the library that raised the error names fields.

    Commands are registered as stubs (name and help); a command's module is imported when it is
    resolved, so `rtphys --help` loads neither SAPIEN nor numpy.
    """

    def resolve_command(self, ctx, args):
        name, stub, rest = super().resolve_command(ctx, _as_called_now(args))
        command = load(name) if name and stub else stub
        ctx.meta[RUNNING] = (command, rest)
        known = {flag for one in _parameters(command, rest) for flag in one.opts}
        for flag in ({word.partition("=")[0] for word in rest} & FIRST) - known:
            _stop(f"{flag} stands before the command's name: `rtphys {flag} ... {name} ...`", 2)
        return name, command, rest

    def parse_args(self, ctx, args):
        # No locale may end a command in the middle of its table: ASCII becomes UTF-8.
        for stream in (sys.stdout, sys.stderr):
            if isinstance(stream, TextIOWrapper):
                ascii_only = stream.encoding.lower() in ("ascii", "us-ascii", "ansi_x3.4-1968")
                encoding = "utf-8" if ascii_only else None
                stream.reconfigure(encoding=encoding, errors="backslashreplace")
        with _refusals_said():  # --help and --version write before any command runs
            return super().parse_args(ctx, args)

    def invoke(self, ctx):
        given = [("--library", path) for path in ctx.params.get("library") or ()]
        given += [(f"--{n}", ctx.params[n]) for n in ("assets", "fallback") if ctx.params.get(n)]
        GIVEN.set(tuple(word for pair in given for word in pair))
        if ctx.params.get("debug"):
            return super().invoke(ctx)
        try:
            with _refusals_said():
                return super().invoke(ctx)
        except RtphysError as error:
            running = _parameters(*ctx.meta.get(RUNNING, (None, ())))
            text = with_flags(error, _flags([*self.params, *running]))
            kind = getattr(error, "kind", "")
            if kind.startswith("attribute of domain "):
                text = _said_of_the_range(kind, error) or text
                text += "; --domain or a protocol chooses a domain that varies it "
                text += f"(`rtphys domains list`); {_own_domain()}"
            elif isinstance(error, BadValue) and re.match(r"domain \S+ holds it at", error.allowed):
                parent = error.allowed.split()[1]
                text += f", so a file that extends it cannot vary it; {_own_domain(parent)}"
            elif isinstance(error, BadValue) and "it is a number in" in error.allowed:
                if isinstance(error.value, tuple) and any("--sweep" in p.opts for p in running):
                    each = ",".join(f"{value:g}" for value in error.value)
                    text += f"; `--sweep {error.key}={each}` collects the same with each value"
            elif kind in OF_LIBRARIES and not ctx.params.get("library"):
                hint = " If it is yours: --library DIR, before the command's name, adds it."
                before, known, names = text.partition(" Known: ")  # the names fill a screen
                text = before + hint + known + names
            _stop(text, error.exit_code)
        except KeyboardInterrupt:
            _stop("stopped", Interrupted.exit_code)
        except ImportError as error:
            if (error.name or "").partition(".")[0] == "rtphys":
                raise
            cure = cure_of(error) or "`rtphys doctor` names what is missing or cannot be loaded"
            _stop(f"{error}; {cure}", 3)


def _said_of_the_range(kind: str, error: RtphysError) -> str:
    """That an attribute is known and a domain lacks a range for it; empty where it is unknown."""
    from rtphys.physics.attribute import is_attribute

    name = getattr(error, "name", "")
    return f"{kind.removeprefix('attribute of ')} has no range for {name}" * is_attribute(name)


def _own_domain(parent: str = "global") -> str:
    copied = command_line("domains", "show", parent, "--yaml")
    return f"`{copied}` prints a file without `extends` to copy, which may name any attribute"


def _as_called_now(args: list[str]) -> list[str]:
    """A command line in which former names are replaced."""
    command = ALIASES.get(args[0], args[0]) if args else ""
    if args and command != args[0]:
        say(f"note: `rtphys {args[0]}` is called `rtphys {command}` now", err=True)
    words = [command, *args[1:]] if args else []
    for place, word in enumerate(words[1:], start=1):
        bare = word == "--video" and (words[place + 1 :] or ["-"])[0].startswith("-")
        if command == "evaluate" and bare:
            words[place] = "--video=all"
            say(
                "note: `--video` of `rtphys evaluate` takes all, failures or a number now", err=True
            )
        flag, equals, value = word.partition("=")
        if instead := GONE.get((command, flag)):
            _stop(f"{flag} is gone: {instead}", 2)
        named = value or (words[place + 1 :] or [""])[0].endswith(".json")
        if command in ("bench", "check") and flag == "--json" and named:
            _stop("--json is a switch now, which prints: write `--json > FILE`", 2)
        if new := FORMER.get(command, {}).get(flag):
            if (command, flag) == ("evaluate", "--set") and _holds(value or words[place + 1 :]):
                _stop("evaluate has no --set: physics follows from the protocol and the seed", 2)
            words[place] = f"{new}{equals}{value}"
            say(f"note: `{flag}` of `rtphys {command}` is called `{new}` now", err=True)
    return words


def _holds(given: str | list[str]) -> bool:
    """Whether what follows `--set` holds an attribute, as in `collect`."""
    from rtphys.physics.attribute import is_attribute

    text = given if isinstance(given, str) else next(iter(given), "")
    return is_attribute(text.partition("=")[0])


@contextmanager
def _refusals_said() -> Iterator[None]:
    """Turns what the operating system refuses into a line and an exit code."""
    try:
        yield
    except BrokenPipeError:
        sys.stdout = None  # whoever read our output has left; the exit flush would complain
        raise typer.Exit(1) from None
    except OSError as error:
        try:
            if sys.stdout is not None:
                sys.stdout.flush()
        except OSError:
            sys.stdout = None  # it takes nothing more; the exit flush would complain
        where = f"{error.filename}: " if error.filename else ""
        full = error.errno in (errno.ENOSPC, errno.EDQUOT)
        hint = "; free some space, then repeat the command" if full else ""
        _stop(f"{where}{error.strerror or error}{hint}", 2)


def add_commands(app: typer.Typer) -> None:
    """Register every command's name and help, so that help and "did you mean" know them all."""
    for title, commands in GROUPS.items():
        for name, (_, text) in commands.items():
            # Nothing ever calls it: `LazyGroup` puts the command in its place.
            app.command(name, help=text, rich_help_panel=title)(lambda: None)


def load(name: str):
    """The real command: the function of its name in its module, or the group of its name."""
    module = import_module(f"rtphys.cli.{COMMANDS[name][0]}")
    identifier = name.replace("-", "_")
    inner = getattr(module, f"{identifier}_" if iskeyword(identifier) else identifier)
    if not isinstance(inner, typer.Typer):
        function, inner = inner, typer.Typer(add_completion=False)
        inner.command()(function)
    command = typer.main.get_command(inner)
    command.help = command.help or COMMANDS[name][1]  # of a group
    for one in (command, *getattr(command, "commands", {}).values()):
        # A paragraph becomes one line: the terminal is narrower than the source.
        parts = (one.help or "").split("\n\n")
        one.help = "\n\n".join(re.sub(r"\n(?! |\* )", " ", part) for part in parts)
    return command


def with_flags(error: RtphysError, flags: Mapping[str, str]) -> str:
    """The text of an error in which fields are spelled as options of the command line.

    Args:
        error: names fields of the running command, a `BadValue` by its key, other texts in
            backticks: `out`. Of another command: `rtphys certify task=click_bell`.
        flags: field -> flag of the running command; a field that is not in it stays as it is.
    """

    def other_command(match: re.Match[str]) -> str:
        flags = _flags(load(match[1]).params)
        words = [word.partition("=") for word in match[2].split()]
        options = (f" {flags[field]} {value}" for field, _, value in words)
        return f"`{command_line(match[1])}{''.join(options)}`"

    if isinstance(error, BadValue) and not error.where and error.key in flags:
        error = BadValue(flags[error.key], error.value, error.allowed)
    text = re.sub(r"`(\w+)`", lambda match: flags.get(match[1], match[0]), str(error))
    return re.sub(r"`rtphys ([\w-]+)((?: \w+=[^`]*)+)`", other_command, text)


def _parameters(command, arguments: Sequence[str]) -> list:
    """All that the command line may hold, also that of the command below a command."""
    if command is None:
        return []
    below = getattr(command, "commands", {}).get(next(iter(arguments), ""))
    return [*command.params, *_parameters(below, arguments[1:])]


def _flags(parameters: Sequence) -> dict[str, str]:
    """Field -> flag, by the parameter's name and by the flag's own; an argument in capitals."""
    spelled = {p.name: p.opts[0] if p.opts[0][0] == "-" else p.name.upper() for p in parameters}
    own = {flag.lstrip("-").replace("-", "_"): flag for flag in spelled.values() if flag[0] == "-"}
    return own | spelled


def _stop(message: str, code: int) -> None:
    say(f"rtphys: {message}", err=True)
    raise typer.Exit(code)
