"""Parses attribute values from text such as `friction=0.2`."""

from collections.abc import Iterable

from rtphys.core.errors import BadValue, UnknownName
from rtphys.physics.auxiliary import AUXILIARY
from rtphys.physics.registry import attributes
from rtphys.physics.sampling import check_overrides
from rtphys.physics.values import Value


def parse_overrides(texts: Iterable[str]) -> dict[str, Value]:
    """Values by key from texts like "friction=0.2", "center_of_mass=0,0,0.01", "camera_mode=orbit".

    Raises:
        UnknownName: no such key; names the nearest match.
        BadValue: not `key=value`, not a number, or outside what the simulator can do.
    """
    values: dict[str, Value] = {}
    for text in texts:
        key, equals, value_text = text.partition("=")
        key = key.strip()
        known = [*attributes(), *AUXILIARY]
        if not equals:
            raise BadValue("set", text, "write key=value, such as friction=0.2")
        if key not in known:
            raise UnknownName("attribute", key, known)
        values[key] = _value(key, value_text.strip())
    check_overrides(values)
    return values


def _value(key: str, text: str) -> Value:
    if key == "camera_mode":
        return text
    try:
        numbers = tuple(float(part) for part in text.split(","))
    except ValueError:
        raise BadValue(key, text, "it needs a number, or numbers with commas between") from None
    return numbers[0] if len(numbers) == 1 else numbers
