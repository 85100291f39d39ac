"""Command lines derived from the dataclasses of specs and plans: one option for each field.

A field whose annotation carries an `Option` is an option of the same name; a field that is a
dataclass brings its fields along, or those that `Offers` names. A new option is a field, and
nothing here. (A field of `EpisodeSpec` also changes the code's digest, so lists must be certified
again.) Tasks may also be words of their own: `check click_bell`, `check --task click_bell`.
"""

import inspect
from collections.abc import Callable, Iterator, Mapping, Sequence, Set
from dataclasses import MISSING, dataclass, fields, is_dataclass, replace
from functools import wraps
from pathlib import Path
from types import NoneType, UnionType
from typing import Annotated, Any, NamedTuple, Union, cast, get_args, get_origin, get_type_hints

import typer

from rtphys.core.errors import BadValue
from rtphys.spec.option import Offers, Option

JSON_HELP = "Plain JSON on standard output instead of a table."
Json = Annotated[bool, typer.Option("--json", help=JSON_HELP)]

NAMED = "task_names"  # the words of a command that are its tasks
# What typer reads by itself -> how the help calls a value; all else is text.
_METAVARS = {bool: None, int: "N", float: "X", str: "TEXT", Path: "PATH"}
PANELS = {
    "EpisodeSpec": "What an episode is",
    "CollectionSpec": "Which attempts are made and kept",
    "CertificationSpec": "Which attempts are made and kept",
    "RecordingSpec": "What is recorded",
    "Run": "How it runs",
    "CertificationRun": "How it runs",
    "EvaluationRun": "How it runs",
    "EvaluationSpec": "The policy",
}
"""Class of an option that is not among a command's common ones -> where its help stands."""


@dataclass(frozen=True)
class AsJson:
    """Which form a command's table takes."""

    as_json: Annotated[bool, Option(JSON_HELP, "json")] = False


FIGURES = (".png", ".pdf", ".svg", "")  # how the names of figures end; without an end, a PNG


def check_figure(path: Path) -> None:
    """Raises `BadValue`: no figure can be written under this name."""
    if path.suffix.lower() not in FIGURES:
        raise BadValue("figure", str(path), "its name ends in .png, .pdf or .svg")


def takes(
    *kinds: type, common: Sequence[str] = ()
) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Makes `f(a, b)` a command, where a and b are dataclasses whose fields are its options.

    Args:
        kinds: one of them may be typer's context of the running command.
        common: fields that the help shows first, in this order, the others in panels by their
            classes; none: all in the order of the fields.
    """

    def command(function: Callable[..., None]) -> Callable[..., None]:
        @wraps(function)
        def call(**given: object) -> None:  # typer calls with keywords alone
            if named := given.get(NAMED):
                given["tasks"] = [*cast(list[str], given["tasks"] or []), *cast(list[str], named)]
            made = [
                given["context"] if k is typer.Context else _build(_Part(k), given) for k in kinds
            ]
            function(*made)

        parameters = [p for kind in kinds for p in _parameters(_Part(kind), common)]
        order = (NAMED, *common)
        parameters.sort(key=lambda p: order.index(p.name) if p.name in order else len(order))
        call.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
        return call

    return command


class _Part(NamedTuple):
    """A dataclass that command-line values fill in, and which of its fields they may set."""

    kind: type
    rest: Any = MISSING  # one with the values of the other fields; MISSING: the class's defaults
    names: tuple[str, ...] | None = None  # of the fields that are asked for; None: of all

    def asked(self) -> Iterator[tuple[str, Any, Any, "Option | _Part"]]:
        """Name, annotation, default and option of each field; without option, its own part."""
        hints = get_type_hints(self.kind, include_extras=True)
        for field in fields(self.kind):
            if self.names is not None and field.name not in self.names:
                continue
            hint = hints[field.name]
            made = field.default_factory
            default = field.default if made is MISSING else made()
            default = getattr(self.rest, field.name, default)
            notes, kind = getattr(hint, "__metadata__", ()), _kind(hint)[0]
            options = [note for note in notes if isinstance(note, Option)]
            if options:
                yield field.name, hint, default, options[-1]  # the outermost annotation wins
            elif isinstance(kind, type) and is_dataclass(kind):
                names = next((note.names for note in notes if isinstance(note, Offers)), None)
                # A default that says nothing of its own leaves the class's as they are spelled.
                plain = names is None and default is not MISSING and default == kind()
                yield field.name, hint, default, _Part(kind, MISSING if plain else default, names)


def _build(part: _Part, given: Mapping[str, object]) -> Any:
    """The dataclass that command-line values describe; raises what refuses a value."""
    values: dict[str, object] = {}
    for name, hint, default, found in part.asked():
        if isinstance(found, _Part):
            values[name] = _build(found, given)
        else:
            values[name] = _value(hint, given[name], name, default)
    return part.kind(**values) if part.rest is MISSING else replace(part.rest, **values)


def _value(hint: object, raw: object, name: str, default: Any) -> object:
    if raw is None or (raw == [] and default is not MISSING):
        if default is MISSING and name == "tasks":
            raise BadValue("task", None, "name at least one; `rtphys tasks` lists them")
        return None if default is MISSING else default
    if not isinstance(raw, Sequence) or isinstance(raw, str):
        return raw
    words, (kind, _) = [str(word) for word in raw], _kind(hint)
    if get_origin(kind) is not Mapping:
        return names_in(words)
    if get_args(kind)[1] is not str:
        from rtphys.physics.load import parse_overrides

        return parse_overrides(words)
    pairs = [word.partition("=") for word in words]
    for (key, equals, _), word in zip(pairs, words, strict=True):
        if not key or not equals:
            raise BadValue(name, word, "write key=value")
    return {key: value for key, _, value in pairs}


def _parameters(part: _Part, common: Sequence[str]) -> Iterator[inspect.Parameter]:
    keyword = inspect.Parameter.KEYWORD_ONLY
    if part.kind is typer.Context:
        yield inspect.Parameter("context", keyword, annotation=typer.Context)
        return
    for name, hint, default, found in part.asked():
        if isinstance(found, _Part):
            yield from _parameters(found, common)
            continue
        kind, optional = _kind(hint)
        called, origin = found.name or name, get_origin(kind)
        several = origin in (tuple, Mapping)
        spelled = list[str] if several else kind if kind in _METAVARS else str
        optional |= origin is Mapping or (not several and spelled is not kind)
        if tasks := name == "tasks":
            text = "Tasks or patterns such as 'stack_*'; as an option: --task NAME,NAME."
            words = typer.Argument(help=text, metavar="TASKS", show_default=False)
            named = Annotated[list[str] | None, words]
            yield inspect.Parameter(NAMED, keyword, default=None, annotation=named)
        if tasks or (several and optional):
            default = None
        elif default is MISSING:
            default = inspect.Parameter.empty
        flag, panel = "--" + called.replace("_", "-"), PANELS.get(part.kind.__name__)
        # What a field does without a value is no default where the command brings one.
        text = found.help.partition(" Default:")[0] if default else found.help
        option = typer.Option(
            f"{flag}/--no-{flag[2:]}" if default is True else flag,
            help=text,
            metavar=_METAVARS.get(spelled, "TEXT"),
            rich_help_panel=panel if common and name not in common else None,
            hidden=tasks,  # the words say it
        )
        note = typer.Argument(help=text) if found.positional else option
        annotation = Annotated[spelled | None if optional else spelled, note]
        yield inspect.Parameter(name, keyword, default=default, annotation=annotation)


def _kind(hint: Any) -> tuple[Any, bool]:
    """What a field holds, without notes and None; and whether it may be None."""
    while get_origin(hint) is Annotated:
        hint = get_args(hint)[0]
    if get_origin(hint) not in (Union, UnionType):
        return hint, False
    kinds = [part for part in get_args(hint) if part is not NoneType]
    return _kind(kinds[0])[0] if len(kinds) == 1 else None, len(kinds) < len(get_args(hint))


def refuse_others(context: typer.Context, beside: Set[str], allowed: str) -> None:
    """Raises `BadValue`: an option was given that is not among `beside`."""
    for name in sorted(context.params.keys() - beside):
        source = context.get_parameter_source(name)
        if source is not None and source.name == "COMMANDLINE":
            value = context.params[name]
            text = ",".join(map(str, value)) if isinstance(value, list) else value
            raise BadValue("tasks" if name == NAMED else name, text, allowed)


def names_in(words: Sequence[str]) -> tuple[str, ...]:
    """Names of repeated options, each of which may hold several with commas: `"a, b"`.

    What holds no name at all stays as it is, to be refused rather than to mean nothing.
    """
    split = ([part.strip() for part in word.split(",") if part.strip()] or [word] for word in words)
    return tuple(name for parts in split for name in parts)
