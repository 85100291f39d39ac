"""Protocols: what varies between episodes besides the layout. A library may add its own."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import cast

from rtphys.core import library
from rtphys.core.errors import BadFile, BadValue, UnknownName


@dataclass(frozen=True)
class VisualRules:
    """How the visual appearance varies. Every default is that of protocol clean: it does not.

    Rates are shares of episodes. The numbers of OFFICIAL are those of RoboTwin's randomised
    configuration, except the camera's, which it leaves at zero.
    """

    textures: bool = False  # random pictures on table and wall
    clean_background_rate: float = 0.0  # table and wall, each: keeps its clean colour
    light_colours: bool = False  # random colours of directional and point lights, in [0, 1]^3
    flicker_rate: float = 0.0  # light colours change with every picture
    table_drop: float = 0.0  # [m] largest lowering of the table below its physical height
    camera_shift: float = 0.0  # [m] radius of the ball of random head camera shifts
    camera_turn_deg: float = 0.0  # largest random rotation of the head camera, any axis
    clutter: int = 0  # largest number of objects that the task does not need

    def to_json(self) -> dict[str, bool | int | float]:
        """The rules as plain JSON, one key per field."""
        return {f.name: getattr(self, f.name) for f in fields(self)}

    @staticmethod
    def from_json(data: Mapping[str, object], where: str | Path = "") -> "VisualRules":
        """Inverse of `to_json`; a missing key has its default, as in protocol clean.

        Raises:
            UnknownName, BadValue: a wrong key or value; they name the key.
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
    """A named choice of what varies. The layout of a seed is the same under every protocol."""

    name: str
    visual: VisualRules | None  # None: the appearance does not vary
    physics: bool  # whether the physics is drawn from the task's domain
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
    """All protocols by name: the builtin ones, then those of the libraries.

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
    """The protocol of this name.

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
    """Read a protocol: `what`, `physics: true|false`, and `visual`, a mapping or `official`.

    Raises:
        BadFile, BadValue, UnknownName: a mistake in the file; they name it.
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
