"""What differs between episodes beside the layout: one table, to which a library may add rows."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import cast

from rtphys.core import library
from rtphys.core.errors import BadFile, BadValue, UnknownName


@dataclass(frozen=True)
class VisualRules:
    """What the look of an episode may be. Every default is "as in clean".

    Rates are shares of episodes. Numbers are RoboTwin's randomised configuration's, except the
    camera's, which it leaves at zero.
    """

    textures: bool = False  # a picture on the table and one on the wall
    clean_background_rate: float = 0.0  # table and wall, each: no picture after all
    light_colours: bool = False  # of the directional and the point lights, uniform in [0, 1]^3
    flicker_rate: float = 0.0  # light colours drawn anew for every picture
    table_drop: float = 0.0  # [m] the table is lower by up to this, below where physics has it
    camera_shift: float = 0.0  # [m] head camera, uniform in a ball of this radius
    camera_turn_deg: float = 0.0  # head camera, up to this about any axis
    clutter: int = 0  # at most so many objects that the task does not need

    def to_json(self) -> dict[str, bool | int | float]:
        return {f.name: getattr(self, f.name) for f in fields(self)}

    @staticmethod
    def from_json(data: Mapping[str, object], where: str | Path = "") -> "VisualRules":
        """Inverse of `to_json`; what is left out is as in clean.

        Raises:
            UnknownName, BadValue: name the key.
        """
        known = {f.name: f.default for f in fields(VisualRules)}
        values: dict[str, bool | int | float] = {}
        for key, value in data.items():
            if key not in known:
                raise UnknownName("visual rule", key, known, where)
            values[key] = _checked(key, value, where)
        return VisualRules(**values)  # type: ignore[arg-type] - _checked knows the types


_BOUNDS = {
    "clean_background_rate": 1.0,
    "flicker_rate": 1.0,
    "table_drop": 0.1,  # [m] the table's legs end 12 cm above the ground
    "camera_shift": 0.1,  # [m]
    "camera_turn_deg": 30.0,
    "clutter": 20,
}
"""Largest value of each number; the smallest is 0."""


def _checked(key: str, value: object, where: str | Path) -> bool | int | float:
    if key not in _BOUNDS:
        if not isinstance(value, bool):
            raise BadValue(key, value, "write true or false", where)
        return value
    bound = _BOUNDS[key]
    kind = int if isinstance(bound, int) else int | float
    if isinstance(value, bool) or not isinstance(value, kind) or not 0 <= value <= bound:
        raise BadValue(key, value, f"a number from 0 to {bound:g}", where)
    return value if isinstance(bound, int) else float(value)


@dataclass(frozen=True)
class Protocol:
    """A row of the table. The layout of a seed is the same under every one."""

    name: str
    visual: VisualRules | None  # None: everything looks as in clean
    physics: bool  # whether the task's domain is drawn from
    what: str


OFFICIAL = VisualRules(
    textures=True,
    clean_background_rate=0.02,
    light_colours=True,
    flicker_rate=0.02,
    table_drop=0.03,
    camera_shift=0.01,
    camera_turn_deg=1.0,
    clutter=10,
)

_LOOK = "textures, lights, clutter, table height, head camera"
BUILTIN = (
    Protocol("clean", None, False, "nothing varies but the layout"),
    Protocol("official_random", OFFICIAL, False, _LOOK),
    Protocol("phys_random", None, True, "the 13 physical attributes of the task's domain"),
    Protocol("phys_random_all", OFFICIAL, True, f"the physical attributes; {_LOOK}"),
)


def protocols() -> dict[str, Protocol]:
    """Every protocol by name: the builtin ones, then those of the libraries.

    Raises:
        BadFile, BadValue, UnknownName: a library's file cannot be read.
    """
    own = {name: read_protocol(path) for name, path in library.names("protocols").items()}
    return {row.name: row for row in BUILTIN} | own


def protocol_names() -> tuple[str, ...]:
    """Names of all protocols, from file names alone."""
    builtin = tuple(row.name for row in BUILTIN)
    return (*builtin, *(name for name in library.names("protocols") if name not in builtin))


def load_protocol(name: str) -> Protocol:
    """A protocol by name.

    Raises:
        UnknownName: with the nearest match.
        BadFile, BadValue: a library's file cannot be read.
    """
    for row in BUILTIN:
        if row.name == name:
            return row
    if name not in protocol_names():
        raise UnknownName("protocol", name, protocol_names())
    return read_protocol(library.find("protocols", name))


def read_protocol(path: Path) -> Protocol:
    """`what`, `physics: true|false` and `visual`, a mapping of rules or `official`.

    Raises:
        BadFile, BadValue, UnknownName: what is wrong with the file.
    """
    content = library.read_yaml(path)
    for key in content:
        if key not in ("what", "physics", "visual"):
            raise UnknownName("key of a protocol", key, ("what", "physics", "visual"), path)
    if any(row.name == path.stem for row in BUILTIN):
        raise BadFile(path, f"{path.stem} is builtin; give the protocol another name")
    physics, visual = content.get("physics", False), content.get("visual")
    if not isinstance(physics, bool):
        raise BadValue("physics", physics, "write true or false", path)
    if visual == "official":
        rules: VisualRules | None = OFFICIAL
    elif visual is None:
        rules = None
    elif isinstance(visual, Mapping):
        rules = VisualRules.from_json(cast(Mapping[str, object], visual), path)
    else:
        raise BadValue("visual", visual, "a mapping of rules, or `official`", path)
    return Protocol(path.stem, rules, physics, str(content.get("what", "")))
