"""Options of a command as one dataclass, and what several commands do with theirs."""

from collections.abc import Callable
from dataclasses import MISSING, fields
from functools import wraps
from inspect import Parameter, Signature
from typing import TYPE_CHECKING, TypeVar

from rtphys.core import library

if TYPE_CHECKING:
    from rtphys.physics.domain import Domain

Chosen = TypeVar("Chosen")


def taking(kind: type[Chosen]) -> Callable[[Callable[[Chosen], None]], Callable[..., None]]:
    """Makes `f(options)` a command with one option for each field of a dataclass.

    Fields carry what typer wants to know, `Annotated[type, typer.Option(...)]`; a field without
    a default must be given.
    """

    def command(function: Callable[[Chosen], None]) -> Callable[..., None]:
        @wraps(function)
        def call(**given: object) -> None:  # typer knows no other way
            function(kind(**given))

        call.__signature__ = _signature(kind)  # type: ignore[attr-defined] - read by inspect
        return call

    return command


def _signature(kind: type) -> Signature:
    return Signature(
        [
            Parameter(
                field.name,
                Parameter.KEYWORD_ONLY,
                default=Parameter.empty if field.default is MISSING else field.default,
                annotation=field.type,
            )
            for field in fields(kind)
        ]
    )


def expand(patterns: list[str]) -> tuple[str, ...]:
    """Task names of names and patterns, each once, in the order asked for; commas part them too.

    Raises:
        UnknownName: a name or pattern that matches no task; names the nearest match.
    """
    # What holds no name at all must be refused, not be no task.
    parts = [part for pattern in patterns for part in split(pattern) or (pattern,)]
    return library.matching("tasks", parts)


def domain_of(text: str) -> "Domain | None":
    """What `--domain` names: a domain, or a path to its file; None where it was not given.

    Raises:
        UnknownName: no such domain; names the nearest match.
        BadFile, BadValue: the file is no domain.
    """
    from rtphys.physics.load import load_domain

    return load_domain(text) if text else None


def split(text: str) -> tuple[str, ...]:
    """`"a, b"` -> `("a", "b")`."""
    return tuple(part for raw in text.split(",") if (part := raw.strip()))
