"""How specs are stored and compared: one way for labels, manifests, logs and command lines.

A spec is a frozen dataclass that pydantic checks. What a file holds of it is `stored(spec)`, what
makes a spec of that again is `load`, and whether two runs may continue each other is `differences`
of the two. No field is ever copied by hand.
"""

from collections.abc import Generator, Mapping
from contextlib import contextmanager
from functools import lru_cache
from pathlib import Path
from typing import TypeVar

from pydantic import ConfigDict, Field, TypeAdapter, ValidationError

from rtphys.core.bounds import SHOWN_CHARACTERS
from rtphys.core.errors import BadFile, RtphysError, shortened
from rtphys.core.untrusted import JSON

T = TypeVar("T")

MAX_PROBLEMS = SHOWN_CHARACTERS // 40  # that an error names
CLOSED = ConfigDict(extra="forbid")  # an unknown key is a mistake, not an extension
Extent = Field(exclude=True)  # how much is made, not what: it is not stored, and may change


class SchemaError(RtphysError):
    """Data that breaks its schema; one clause per problem, naming the place."""

    def __init__(self, what: str, error: ValidationError) -> None:
        found = error.errors(include_url=False, include_context=False, include_input=False)
        self.problems = [
            f"{shortened('.'.join(map(str, item['loc']))) or 'top level'}: {item['msg'].lower()}"
            for item in found[:MAX_PROBLEMS]
        ]
        if len(found) > MAX_PROBLEMS:
            self.problems.append(f"and {len(found) - MAX_PROBLEMS} more")
        super().__init__(f"{what} breaks its schema: {'; '.join(self.problems)}")


@contextmanager
def problems_of(path: str | Path) -> Generator[None]:
    """Turns what a file's content breaks into `BadFile`, which names each problem's place."""
    try:
        yield
    except ValidationError as error:
        raise BadFile(path, "; ".join(SchemaError(str(path), error).problems)) from error


@lru_cache(maxsize=64)
def adapter(kind: type[T]) -> TypeAdapter[T]:
    """What reads and writes values of a type; made once, since making it takes milliseconds."""
    return TypeAdapter(kind)


def stored(spec: object) -> dict[str, JSON]:
    """Plain JSON values of a spec by field, extents left out."""
    return adapter(type(spec)).dump_python(spec, mode="json")


def load(kind: type[T], value: object, path: str | Path) -> T:
    """Inverse of `stored`. Raises `BadFile`, which names the path and each field that is wrong."""
    try:
        with problems_of(path):
            return adapter(kind).validate_python(value)
    except BadFile:
        raise
    except RtphysError as error:  # a field's own check
        raise BadFile(path, str(error)) from error


def differences(before: Mapping[str, JSON], now: Mapping[str, JSON]) -> list[str]:
    """One clause for each value that is not the same, nested keys spelled with dots."""
    clauses: list[str] = []
    for key in sorted({*before, *now}):
        old, new = before.get(key), now.get(key)
        if old == new:
            continue
        if isinstance(old, Mapping) and isinstance(new, Mapping):
            clauses += [f"{key}.{clause}" for clause in differences(old, new)]
        else:
            clauses.append(f"{key} was {old!r}, now {new!r}")
    return clauses
