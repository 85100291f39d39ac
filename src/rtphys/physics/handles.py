"""Protocols for the parts of a simulator that attributes read and write; `rtphys.sim` has them.

All numbers are in SI units. Every `nominal_*` is the asset's own value as built (after
`object_scale`), stored once, so that an attribute always scales from the same number. Every
property without `nominal_` reads the simulator itself, never a cache.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, Protocol

from numpy.typing import ArrayLike

from rtphys.core.poses import Array, Pose

GRAVITY = 9.81  # [m/s^2] along -z, SAPIEN's default

Hook = Callable[[], None]  # runs at every physics step
Material = tuple[float, float, float]  # static friction, dynamic friction, restitution


@dataclass
class Happened:
    """What has happened in an episode that an attribute needs to change anything."""

    impact: bool = False  # two bodies met so fast that they bounce
    object_joints: bool = False  # a joint of an object moved
    arms: bool = False  # a joint of an arm moved
    fingers: bool = False  # a finger moved


@dataclass
class Blueprint:
    """Physics that must be known before the world is built; `before_build` attributes write it."""

    object_scale: float = 1.0  # [1] of every task object: geometry, annotations, spawn height
    table_tilt: float = 0.0  # [rad] the table's normal leans towards azimuth 90 deg (+y)
    table_height: float = 0.0  # [m] added to the nominal table top


class Body(Protocol):
    """A dynamic task body: a rigid object or a non-root link of an articulated one.

    Masses are in kg, inertias (3,) principal moments about the centre of mass [kg m^2], centres of
    mass (3,) [m] in the body's frame. `set_mass` leaves the inertia as it was; the principal axes
    stay whatever is set. `component` is SAPIEN's own object, for what this handle does not reach.
    """

    @property
    def name(self) -> str: ...
    @property
    def component(self) -> Any: ...
    @property
    def nominal_mass(self) -> float: ...
    @property
    def nominal_inertia(self) -> Array: ...
    @property
    def nominal_com(self) -> Array: ...
    @property
    def spin_decay(self) -> float: ...  # without contact [1/s]: 0 but for soft balls
    @property
    def hull(self) -> Array: ...  # (n, 3) collision vertices in the body's frame [m]
    @property
    def mass(self) -> float: ...
    @property
    def inertia(self) -> Array: ...
    @property
    def com(self) -> Array: ...
    def set_mass(self, kg: float) -> None: ...
    def set_inertia(self, diagonal: ArrayLike) -> None: ...
    def set_com(self, p: ArrayLike) -> None: ...


class Surface(Protocol):
    """The collision shapes of one body that have the same contact material.

    A body whose parts differ has several surfaces. Two surfaces never share a SAPIEN material
    object, because editing one would edit both. `materials` has one of each shape.
    """

    @property
    def name(self) -> str: ...
    def set_material(self, static: float, dynamic: float, restitution: float) -> None: ...
    def materials(self) -> list[Material]: ...


class Joint(Protocol):
    """A joint of an articulated task object; `joint` is SAPIEN's own."""

    @property
    def name(self) -> str: ...
    @property
    def joint(self) -> Any: ...
    @property
    def kind(self) -> Literal["revolute", "prismatic"]: ...
    @property
    def nominal_damping(self) -> float: ...  # [N m s/rad] revolute, [N s/m] prismatic
    @property
    def damping(self) -> float: ...
    @property
    def friction(self) -> float: ...  # [1] SAPIEN's, which depends on the load
    def set_damping(self, damping: float) -> None: ...
    def set_friction(self, friction: float) -> None: ...


class Servo(Protocol):
    """The position servo of one robot joint; `joint` is SAPIEN's own.

    Stiffness is in N m/rad and damping in N m s/rad, of a finger in N/m and N s/m.
    """

    @property
    def name(self) -> str: ...
    @property
    def joint(self) -> Any: ...
    @property
    def nominal_stiffness(self) -> float: ...
    @property
    def stiffness(self) -> float: ...
    def set_stiffness(self, stiffness: float) -> None: ...
    @property
    def nominal_damping(self) -> float: ...
    @property
    def damping(self) -> float: ...
    def set_damping(self, damping: float) -> None: ...


class Camera(Protocol):
    """A camera that is fixed in the world; its frame has x forward, y left, z up."""

    @property
    def name(self) -> str: ...
    @property
    def nominal_pose(self) -> Pose: ...
    @property
    def pose(self) -> Pose: ...
    def set_pose(self, pose: Pose) -> None: ...
    @property
    def range_to_table(self) -> float:
        """[m] from the nominal pose along the optical axis to the nominal table top."""
        ...


class World(Protocol):
    """The parts of a built scene that physical attributes read and write."""

    external_force: float  # [m g] along world +X at every body's CoM, in the policy stage only

    @property
    def scene(self) -> Any:
        """SAPIEN's own scene, for what these handles do not reach."""
        ...

    @property
    def step_hooks(self) -> Mapping[str, tuple[Hook | None, Hook | None]]:
        """What `on_step` was called with, by key; `read` may look into its own."""
        ...

    def on_step(self, key: str, before: Hook | None = None, after: Hook | None = None) -> None:
        """Calls `before` ahead of every physics step (4 ms), and `after` behind it.

        It begins with the episode's settling. `key`, the attribute's, names the pair: a second call
        with it takes the place of the first. Forces must be added anew ahead of every step.
        """
        ...

    @property
    def bodies(self) -> Sequence[Body]: ...
    @property
    def surfaces(self) -> Sequence[Surface]: ...  # of task objects, clutter, table, finger pads
    @property
    def table_and_pads(self) -> Sequence[Surface]: ...  # those that props touch
    @property
    def scenery(self) -> Sequence[Surface]: ...  # the rest, which no attribute writes
    @property
    def joints(self) -> Sequence[Joint]: ...
    @property
    def arm_servos(self) -> Sequence[Servo]: ...
    @property
    def gripper_servos(self) -> Sequence[Servo]: ...
    @property
    def head_camera(self) -> Camera: ...
    @property
    def blueprint(self) -> Blueprint: ...

    def measured_scale(self) -> Mapping[str, float]:
        """Task object name -> size of its shapes in the simulator / nominal size of the asset."""
        ...

    def measured_table(self) -> tuple[float, float]:
        """Tilt [rad] and height above nominal [m] of the table, from its pose in the simulator."""
        ...

    def measured_force(self) -> Mapping[str, float]:
        """Body name -> force [N] along world +X that a step of the policy stage now applies."""
        ...
