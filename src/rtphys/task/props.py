"""The things on the table, and how they stand: what a layout yields and a world builds.

Poses are in the task frame: +x is the robot's right, +y away from it, +z up. Official models are
y-up in their own frame; each orientation (wxyz) says where a model's x, y, z go. UP_Y is RoboTwin's
most frequent.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from rtphys.core.errors import BadValue, UnknownName
from rtphys.core.poses import Array, Pose, axis_angle, quat_multiply
from rtphys.core.untrusted import plain_name
from rtphys.physics.attribute import Part, attribute, is_attribute
from rtphys.physics.reach import MARK, split

IDENTITY = (1.0, 0.0, 0.0, 0.0)
UP_Y = (0.5, 0.5, 0.5, 0.5)  # x -> +y, y -> up, z -> +x
UP_Z = (0.7071067811865476, 0.7071067811865476, 0.0, 0.0)  # x -> +x, y -> up, z -> -y
UP_F = (0.0, 0.0, 0.7071067811865476, 0.7071067811865476)  # x -> -x, y -> up, z -> +y
UP_S = (0.5, 0.5, -0.5, -0.5)  # x -> -y, y -> up, z -> -x
DOWN = (0.0, 1.0, 0.0, 0.0)  # x -> +x, y -> -y, z -> down: a target seen by a tool pointing down


def yawed(q: tuple[float, ...] | Array, yaw: float) -> Array:
    """`q` turned by `yaw` [rad] about the vertical, (4,)."""
    return quat_multiply(axis_angle((0, 0, 1), yaw), q)


TABLE_TOP = 0.74  # [m] task-frame height of the table's surface (RoboTwin)
PINE = 450.0  # [kg/m^3] what wooden toy blocks are made of

RED, GREEN, BLUE = (0.85, 0.10, 0.10), (0.10, 0.65, 0.15), (0.10, 0.25, 0.85)

COLOURS: dict[str, tuple[float, float, float]] = {
    "red": (1, 0, 0), "green": (0, 1, 0), "blue": (0, 0, 1), "yellow": (1, 1, 0),
    "cyan": (0, 1, 1), "magenta": (1, 0, 1), "black": (0, 0, 0), "gray": (0.5, 0.5, 0.5),
    "orange": (1, 0.5, 0), "purple": (0.5, 0, 0.5), "brown": (0.65, 0.4, 0.16),
    "pink": (1, 0.75, 0.8), "lime": (0.5, 1, 0), "olive": (0.5, 0.5, 0),
    "teal": (0, 0.5, 0.5), "maroon": (0.5, 0, 0), "navy": (0, 0, 0.5),
    "coral": (1, 0.5, 0.31), "turquoise": (0.25, 0.88, 0.82), "indigo": (0.29, 0, 0.51),
    "beige": (0.96, 0.91, 0.81), "tan": (0.82, 0.71, 0.55), "silver": (0.75, 0.75, 0.75),
}  # fmt: skip
"""RoboTwin's 23 named colours; the first eight are its short list."""
SHORT_COLOURS = tuple(COLOURS)[:8]


@dataclass(frozen=True, kw_only=True)
class Prop:
    """What every prop has. `pose.p[2]` is the height of the frame's origin, unless `resting`."""

    name: str
    pose: Pose  # task frame, for the nominal scale
    fixed: bool = False  # static (or, articulated: fixed root)
    resting: bool = True  # the world sets z so that the lowest point is 1 mm above the table
    on_table: bool = True  # false: it stands on the ground, and `pose` is a world pose
    anchor: tuple[float, float, float] = (0.0, 0.0, 0.0)  # [m] own point that no scale moves
    catches: bool = False  # things fall into it, faster than 1 m/s
    mass_kg: float | None = None  # None: what the asset says
    # Own axis (0 x, 1 y, 2 z, or any direction) of a round thing that lies: it starts rolled so
    # that its centre of mass is underneath, as a real one would come to lie.
    rolls_about: int | tuple[float, float, float] | None = None
    phrase: str = ""  # how language names it; empty: the asset's own phrases
    label: str = ""  # placeholder value in scene_info; empty: "<category>/base<k>" or the phrase

    def __post_init__(self) -> None:
        if self.mass_kg is not None:
            self._check("mass_kg", self.mass_kg)

    def _check(self, key: str, *numbers: float, zero: bool = False) -> None:
        """Raise `BadValue` where a number is not above 0 (or is 0): no body has it."""
        if not all(0 < number < np.inf or (zero and number == 0) for number in numbers):
            allowed = f"each number is {'0 or above' if zero else 'above 0'}"
            raise BadValue(key, getattr(self, key), allowed, f"prop {self.name}")

    @property
    def rolling_axis(self) -> Array | None:
        """`rolls_about` as a unit vector (3,), own frame."""
        if self.rolls_about is None:
            return None
        if isinstance(self.rolls_about, int):
            return np.eye(3)[self.rolls_about]
        return np.asarray(self.rolls_about) / np.linalg.norm(self.rolls_about)

    def at(self, pose: Pose) -> "Prop":
        """The same prop elsewhere."""
        return replace(self, pose=pose)


@dataclass(frozen=True, kw_only=True)
class Box(Prop):
    """A box with frame at its centre. fp 0 bottom centre, 1 top centre, both z down.

    Contact points: ids 0-3 top-down at four yaws at the centre; with `upright_grasps`
    ids 0-3 are horizontal from four sides at +0.7 of the half height, 4-7 at -0.7.
    """

    half_size: tuple[float, float, float]  # [m]
    colour: tuple[float, float, float] = RED
    density: float = PINE  # [kg/m^3]
    visual_only: bool = False  # a mark on the table: no collision shape
    upright_grasps: bool = False

    def __post_init__(self) -> None:
        super().__post_init__()
        self._check("half_size", *self.half_size, zero=self.visual_only)
        self._check("density", self.density)


@dataclass(frozen=True, kw_only=True)
class Ball(Prop):
    """A sphere with frame at its centre; the only thing that may roll for ever."""

    radius: float  # [m]
    colour: tuple[float, float, float] = RED
    density: float = 1000.0  # [kg/m^3]
    # PhysX knows no rolling resistance; a soft ball's spin decays at this rate instead [1/s].
    spin_decay: float = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        self._check("radius", self.radius)
        self._check("density", self.density)


@dataclass(frozen=True, kw_only=True)
class Mesh(Prop):
    """A rigid model of the asset pack (`rtphys assets list`), in its own frame: y up, in most."""

    category: str  # "050_bell"
    model: int


@dataclass(frozen=True, kw_only=True)
class Articulated(Prop):
    """An articulated model of the asset pack; `opening` presets joint 0 as a share of its range."""

    category: str
    model: int
    opening: float = 0.0

    def __post_init__(self) -> None:
        if self.mass_kg is not None:
            allowed = "an articulated prop weighs what its asset says"
            raise BadValue("mass_kg", self.mass_kg, allowed, f"prop {self.name}")


def parts(props: Iterable[Prop]) -> Mapping[str, frozenset[Part]]:
    """Prop -> what its world has of it for physical attributes to act on."""
    return {prop.name: frozenset(_parts(prop)) for prop in props}


def _parts(prop: Prop) -> Iterator[Part]:
    if not (isinstance(prop, Box) and prop.visual_only):
        yield "surfaces"
    if isinstance(prop, Articulated):
        yield "joints"
    if isinstance(prop, Articulated) or not prop.fixed:
        yield "bodies"


# How an error calls a prop with such a part.
ABLE: Mapping[Part, str] = {
    "surfaces": "prop that can be touched",
    "joints": "prop with joints",
    "bodies": "prop that can move",
}


# Names of other parts of a world, and of clutter, which labels and contacts use beside the props'.
HANDS = tuple(f"{side}_{part}" for side in ("left", "right") for part in ("gripper", "arm"))
RESERVED = ("table", "ground", "wall", "robot", *HANDS)
CLUTTER = "clutter"


def check_names(props: Iterable[Prop], where: str) -> None:
    """Raise `BadValue` where a name of a prop is no name, or not its own."""
    taken = set[str]()
    for name in (prop.name for prop in props):
        try:
            plain_name(name)
        except ValueError as problem:
            raise BadValue("prop", name, str(problem), where) from problem
        if MARK in name:
            raise BadValue("prop", name, f"{MARK} stands before a prop in keys of physics", where)
        if name in RESERVED or (name.startswith(CLUTTER) and name[len(CLUTTER) :].isdigit()):
            others = f"{', '.join(RESERVED)} and {CLUTTER}0, {CLUTTER}1 ... name other things"
            raise BadValue("prop", name, others, where)
        if name in taken:
            raise BadValue("prop", name, "two props have this name", where)
        taken.add(name)


def check_props(keys: Iterable[str], props: Iterable[Prop]) -> None:
    """Raise `UnknownName` where a key names no prop, or one without what its attribute changes."""
    has = parts(props)
    for key in keys:
        name, prop = split(key)
        if not prop or not is_attribute(key):
            continue
        needed: Part = attribute(name).acts_on or "surfaces"
        able = [other for other, own in has.items() if needed in own]
        if prop not in able:
            kind = ABLE[needed] if prop in has else "prop"
            raise UnknownName(kind, prop, able, key)
