"""JSON as this package writes it: plain numbers, stable order, the same bytes; its models."""

import json
import math
from collections.abc import Mapping, Sequence
from typing import Annotated

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, FiniteFloat

from rtphys.core.bounds import WHOLE_NUMBER
from rtphys.core.errors import BadValue
from rtphys.core.untrusted import JSON

Seed = Annotated[int, Field(ge=0, le=WHOLE_NUMBER)]
Count = Annotated[int, Field(ge=0, le=WHOLE_NUMBER)]
Sha256 = Annotated[str, Field(pattern=r"^[0-9a-f]{64}$")]
Vector3 = Annotated[list[FiniteFloat], Field(min_length=3, max_length=3)]
Quaternion = Annotated[list[FiniteFloat], Field(min_length=4, max_length=4)]


class Model(BaseModel):
    """A closed record of a JSON file: an unknown key is a mistake, not an extension."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


def plain(value: object, where: str = "value") -> JSON:
    """Copy with numpy values, tuples and paths turned into what JSON knows.

    Raises `BadValue`: a number that is not finite, or a type that JSON has not; names its place.
    """
    if isinstance(value, np.generic | np.ndarray):
        return plain(value.tolist(), where)
    if isinstance(value, float) and not math.isfinite(value):
        raise BadValue(where, value, "numbers in a dataset are finite")
    if value is None or isinstance(value, bool | int | float | str):
        return value
    if isinstance(value, Mapping):
        return {str(key): plain(item, f"{where}.{key}") for key, item in value.items()}
    if isinstance(value, Sequence) and not isinstance(value, bytes):
        return [plain(item, f"{where}[{i}]") for i, item in enumerate(value)]
    raise BadValue(where, value, f"JSON has no {type(value).__name__}")


def spelled(text: str) -> str:
    r"""A text that a file can hold: half a character, as in a name in Latin-1, becomes `\udce9`."""
    return text.encode(errors="backslashreplace").decode()


def check_spelled(key: str, text: str, allowed: str) -> None:
    """Raises `BadValue` of `key`: the text is not UTF-8, so that no file can hold it."""
    if spelled(text) != text:
        raise BadValue(key, text, allowed)


def pretty(value: JSON, *, ascii_only: bool = False, indent: int = 2, sort: bool = True) -> bytes:
    """Indented, keys sorted, one newline at the end."""
    text = json.dumps(
        value, indent=indent, sort_keys=sort, ensure_ascii=ascii_only, allow_nan=False
    )
    return (text + "\n").encode()


def compact(value: JSON) -> bytes:
    """One line without spaces, keys sorted: what checksums are taken of."""
    return json.dumps(
        value, separators=(",", ":"), sort_keys=True, ensure_ascii=False, allow_nan=False
    ).encode()
