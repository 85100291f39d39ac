"""The world under examination beside its label, and what an experiment finds in it."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import isqrt

import numpy as np

from rtphys.assets.pack import Pack
from rtphys.core.poses import Array, Pose, axis_angle
from rtphys.physics.attribute import attribute
from rtphys.physics.reach import MARK, keys_of, split
from rtphys.physics.values import Value
from rtphys.sim.engine import to_sapien
from rtphys.sim.objects import SceneObject
from rtphys.sim.world import World

Number = float | tuple[float, ...]  # in the attribute's own unit

TOLERANCES: Mapping[str, tuple[float, float]] = {
    "arm_joint_damping": (0.02, 0.0),
    "camera_angle": (0.0, 0.01),  # [deg]
    "camera_distance": (0.0, 1e-5),  # [m]
    "center_of_mass": (0.0, 2e-5),  # [m]
    "external_force": (0.01, 1e-4),
    "friction": (0.005, 5e-4),
    "gripper_joint_damping": (0.02, 0.0),
    "object_joint_damping": (0.01, 1e-3),  # [N m s/rad or N s/m]
    "object_mass": (0.01, 0.0),
    "object_scale": (0.001, 0.0),
    "restitution": (0.0, 0.01),
    "table_height": (0.0, 1e-4),  # [m]
    "table_tilt": (0.0, 0.02),  # [deg]
}
"""Attribute -> how exactly its experiment measures it: the larger of a share of the label and an
absolute deviation in the attribute's own unit."""


@dataclass(frozen=True)
class Measurement:
    """One value of one body, surface or joint."""

    key: str  # the attribute
    place: str  # "can", "table", "laptop/lid"
    label: Number
    measured: Number
    allowed: float | None = None  # None: what the attribute's experiment resolves

    @property
    def deviation(self) -> float:
        """Largest difference of a component; infinite where nothing sensible came out."""
        gap = np.max(np.abs(np.subtract(self.measured, self.label)))
        return float(gap) if np.isfinite(gap) else float("inf")

    @property
    def tolerance(self) -> float:
        """The deviation that is allowed."""
        if self.allowed is not None:
            return self.allowed
        relative, absolute = TOLERANCES[split(self.key)[0]]
        return max(absolute, relative * float(np.max(np.abs(self.label))))

    @property
    def passed(self) -> bool:
        return self.deviation <= self.tolerance


@dataclass(frozen=True)
class Unmeasured:
    """Something that a label states and no experiment can measure."""

    key: str
    place: str  # empty: nowhere in this episode
    why: str


Finding = Measurement | Unmeasured


HEIGHT = 4.0  # [m] above wall and robot, and low enough for single precision to resolve 0.5 um
SPACING = 1.0  # [m]
# No axis of a joint is parallel or square to an axis of the world in this orientation.
ASKEW = axis_angle((0.267, 0.535, 0.802), 1.0)
REST = [0.0, 0.0, 0.0]


@dataclass(frozen=True, eq=False)
class Specimen:
    """A freshly built world in which nothing has moved yet, and the label it should obey.

    Args:
        pack: the assets from which it was built.
        values: attributes and auxiliary draws as the label has them.
    """

    world: World
    pack: Pack
    values: Mapping[str, Value]

    def key(self, key: str, name: str) -> str:
        """The key whose value a body, surface or joint has: that of its prop, or of all."""
        own = f"{key}{MARK}{name.partition('/')[0]}"
        return own if own in self.values else key

    def number(self, key: str) -> float:
        """A label that is a number; where it is null, the attribute's nominal value."""
        value = self.values.get(key)
        value = attribute(key).nominal if value is None else value
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise TypeError(f"{key} is {value!r}, not a number")
        return float(value)

    def smallest(self, key: str) -> float:
        """The scene's smallest label of an attribute: what table and finger pads have."""
        return min(self.number(one) for one in keys_of(key, self.values))

    def offset(self, name: str) -> Array:
        """(3,) [m] centre of mass that a body's label says."""
        return np.array(self.values[self.key("center_of_mass", name)], float)

    def rigid(self) -> list[SceneObject]:
        """Task objects of one dynamic body with shapes."""
        things = self.world.objects.values()
        loose = (o for o in things if o.articulation is None and o.bodies)
        return [o for o in loose if o.root.collision_shapes]


def lift(world: World) -> None:
    """Put every object into the air, at rest, without gravity and apart from all others."""
    things = list(world.scene_objects.values())
    side = isqrt(max(len(things) - 1, 0)) + 1
    for i, thing in enumerate(things):
        x, y = (SPACING * (j - (side - 1) / 2) for j in divmod(i, side))
        hang(thing, np.array([x, y, HEIGHT]))


def hang(thing: SceneObject, p: Array) -> None:
    """Put one object at a point (3,) of the world, at rest and without gravity.

    A rigid one keeps no rotation: its axes are the world's. Joints stand in the middle of their
    range.
    """
    art, root = thing.articulation, thing.root
    for component in thing.links.values():
        if hasattr(component, "set_disable_gravity"):
            component.set_disable_gravity(True)  # pyright: ignore[reportAttributeAccessIssue]
    if art is not None:
        art.set_root_pose(to_sapien(Pose(p, ASKEW)))
        limits = np.clip(np.asarray(art.qlimits, float), -1.0, 1.0)  # some hinges have no limits
        art.set_qpos(limits.mean(axis=1).astype(np.float32))
        art.set_qvel(np.zeros(art.dof, np.float32))
        art.set_qf(np.zeros(art.dof, np.float32))
        art.set_root_linear_velocity(REST)
        art.set_root_angular_velocity(REST)
        return
    root.entity.set_pose(to_sapien(Pose(p)))
    if thing.bodies:
        root.set_linear_velocity(REST)  # pyright: ignore[reportAttributeAccessIssue]
        root.set_angular_velocity(REST)  # pyright: ignore[reportAttributeAccessIssue]
