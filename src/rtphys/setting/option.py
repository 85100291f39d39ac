"""What a field of a setting or a study's plan allows, and how a command line asks for it.

The dataclasses of settings and plans are the files and the command lines: a field's annotation
carries its checks, which run whenever one is made, and the help text of its option.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from pydantic import AfterValidator, ValidationInfo

from rtphys.core import library
from rtphys.core.errors import BadValue, UnknownName


@dataclass(frozen=True)
class Option:
    """A field that a command line can set.

    Args:
        help: what its option does.
        name: what users call it, where that is not the field's name.
        positional: an argument of the command instead of an option.
    """

    help: str
    name: str = ""
    positional: bool = False


def at_least(bound: float, most: float = float("inf")) -> AfterValidator:
    """A number within bounds; None passes. Raises `BadValue`, which names the field."""

    def check(value: float | None, info: ValidationInfo) -> float | None:
        if value is not None and not bound <= value <= most:
            allowed = f"at least {bound:g}" if value < bound else f"at most {most:g}"
            raise BadValue(str(info.field_name), value, allowed)
        return value

    return AfterValidator(check)


def one_of(kind: str, known: Iterable[str] | Callable[[], Iterable[str]]) -> AfterValidator:
    """A name of a known set, or several; None passes.

    Args:
        kind: what the name is called in an error, such as "texture split".
        known: the names, or a function that lists them when they are needed.

    Raises:
        UnknownName: with the nearest match.
    """

    def check(value: str | tuple[str, ...] | None) -> str | tuple[str, ...] | None:
        allowed = tuple(known() if callable(known) else known)
        for name in (value,) if isinstance(value, str) else value or ():
            if name not in allowed:
                raise UnknownName(kind, name, allowed)
        return value

    return AfterValidator(check)


def entries_of(kind: str) -> AfterValidator:
    """Names of library entries, such as "tasks", from names and patterns, each once.

    Raises:
        UnknownName: a name or pattern that matches nothing; names the nearest match.
    """
    return AfterValidator(lambda patterns: library.matching(kind, list(patterns)))
