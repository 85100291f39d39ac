"""The physics of an episode: an immutable mapping from attribute key to value."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from math import isfinite
from types import MappingProxyType
from typing import cast

from rtphys.core.errors import UnknownName

Vector = tuple[float, ...]
Value = float | int | str | Vector | None

REDRAWS = "center_of_mass_redraws"  # key: draws that fell outside a body before this one


class Physics(Mapping[str, Value]):
    """Attribute and auxiliary keys -> value, in each attribute's own unit.

    `friction@puck` is there where the puck has a friction of its own; `friction` is for the others.

    None means the asset's own value (`object_joint_damping`). For an auxiliary key
    such as `camera_mode` it means that nothing in this episode needs it.
    """

    __slots__ = ("_values", "varied")

    def __init__(self, values: Mapping[str, Value], varied: Iterable[str] = ()) -> None:
        self._values = MappingProxyType({key: values[key] for key in sorted(values)})
        self.varied = frozenset(varied)  # attributes set by a domain or by the user
        if unknown := self.varied - self._values.keys():
            raise ValueError(f"varied names keys without a value: {sorted(unknown)}")

    def __getitem__(self, key: str) -> Value:
        """The value of a key; raises `KeyError` with the nearest key where there is none."""
        if key not in self._values:
            raise KeyError(str(UnknownName("attribute", key, self._values)))
        return self._values[key]

    def __contains__(self, key: object) -> bool:
        return key in self._values

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Physics):
            return NotImplemented
        return self._values == other._values and self.varied == other.varied

    def __hash__(self) -> int:
        return hash((tuple(self._values.items()), self.varied))

    def __repr__(self) -> str:
        values = ", ".join(f"{key}={self[key]!r}" for key in sorted(self.varied))
        return f"Physics({values or 'nominal'})"

    def __reduce__(self) -> tuple[object, ...]:  # mapping proxies do not pickle
        return Physics, (dict(self._values), self.varied)

    def scalar(self, key: str, default: float | None = None) -> float:
        """The value of a key that holds a number; `default` where it is None, the asset's own.

        Raises `TypeError`: the value is not a number and there is no default.
        """
        value = self[key]
        if value is None and default is not None:
            return default
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise TypeError(f"{key} is {value!r}, not a number")
        return float(value)

    def key_of(self, key: str, prop: str) -> str:
        """The key whose value of an attribute a prop has: its own, else that of all."""
        own = f"{key}@{prop}"
        return own if own in self else key

    def of(self, key: str, prop: str) -> Value:
        """The value of an attribute for a prop."""
        return self[self.key_of(key, prop)]

    def vector(self, key: str) -> Vector:
        """The value of a key that holds a vector, such as `center_of_mass`; raises `TypeError`."""
        value = self[key]
        if not isinstance(value, tuple):
            raise TypeError(f"{key} is {value!r}, not a vector")
        return value


def components(value: object) -> tuple[object, ...]:
    """The components of a vector; any other value is its own only component."""
    return cast(tuple[object, ...], value) if isinstance(value, tuple) else (value,)


def plain_value(raw: object) -> Value:
    """Convert a value read from JSON or YAML: lists of numbers become tuples.

    Raises `ValueError`: anything that is no number, name, vector or null.
    """
    if raw is None or (isinstance(raw, str | int | float) and not isinstance(raw, bool)):
        return raw
    if isinstance(raw, list | tuple) and raw:
        parts = cast(list[object] | tuple[object, ...], raw)
        numbers = [v for v in parts if isinstance(v, int | float) and not isinstance(v, bool)]
        if len(numbers) == len(parts):
            return tuple(float(v) for v in numbers)
    raise ValueError(f"{raw!r} is neither a number, a name, a vector nor null")


@dataclass(frozen=True)
class Interval:
    """All numbers from `low` to `high`, both ends included.

    Raises `ValueError`: ends that are not finite or in the wrong order.
    """

    low: float
    high: float

    def __post_init__(self) -> None:
        if not (isfinite(self.low) and isfinite(self.high) and self.low <= self.high):
            raise ValueError(f"[{self.low}, {self.high}] is not an interval")

    def __contains__(self, value: object) -> bool:
        """Whether a number, or every component of a vector, lies in the interval."""
        if isinstance(value, tuple):
            return all(part in self for part in cast(tuple[object, ...], value))
        if isinstance(value, bool) or not isinstance(value, int | float):
            return False
        return self.low <= value <= self.high

    def __str__(self) -> str:
        return f"[{self.low:g}, {self.high:g}]"
