"""What physics may touch in a simulator, as Protocols; `rtphys.sim` implements them.

Numbers cross this border in SI units. Every `nominal_*` is the asset's own value *as built*
(after `object_scale`), remembered once, so that an attribute always scales from the same number.
Every property without `nominal_` reads the simulator itself, never a cache.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, Protocol

from numpy.typing import ArrayLike

from rtphys.core.poses import Array, Pose

GRAVITY = 9.81  # [m/s^2] along -z, SAPIEN's default

Material = tuple[float, float, float]  # static friction, dynamic friction, restitution


@dataclass
class Blueprint:
    """What must be known before the world is built. `before_build` attributes write it."""

    object_scale: float = 1.0  # [1] of every task object: geometry, annotations, spawn height
    table_tilt: float = 0.0  # [rad] the table's normal leans towards azimuth 90 deg (+y)
    table_height: float = 0.0  # [m] added to the nominal table top


class Body(Protocol):
    """A dynamic task body: a rigid object or a non-root link of an articulated one."""

    @property
    def name(self) -> str: ...
    @property
    def nominal_mass(self) -> float:
        """[kg]"""
        ...

    @property
    def nominal_inertia(self) -> Array:
        """(3,) principal moments about the centre of mass [kg m^2]."""
        ...

    @property
    def nominal_com(self) -> Array:
        """(3,) centre of mass in the body frame [m]."""
        ...

    @property
    def hull(self) -> Array:
        """(n, 3) collision vertices in the body frame [m]."""
        ...

    @property
    def mass(self) -> float: ...
    @property
    def inertia(self) -> Array: ...
    @property
    def com(self) -> Array: ...

    def set_mass(self, kg: float) -> None:
        """Mass alone: SAPIEN leaves the inertia as it was."""
        ...

    def set_inertia(self, diagonal: ArrayLike) -> None:
        """Principal moments (3,) [kg m^2]; the principal axes stay."""
        ...

    def set_com(self, p: ArrayLike) -> None:
        """Centre of mass (3,) in the body frame [m]; keeps the rotation of the principal axes."""
        ...


class Surface(Protocol):
    """The collision shapes of one body that share one material of their own.

    A body whose parts differ is several surfaces. Shapes of two surfaces never share a SAPIEN
    material object: editing one would edit both.
    """

    @property
    def name(self) -> str: ...

    def set_material(self, static: float, dynamic: float, restitution: float) -> None: ...

    def materials(self) -> list[Material]:
        """One (static, dynamic, restitution) per shape, read from the simulator."""
        ...


class Joint(Protocol):
    """A joint of an articulated task object."""

    @property
    def name(self) -> str: ...
    @property
    def kind(self) -> Literal["revolute", "prismatic"]: ...
    @property
    def nominal_damping(self) -> float:
        """[N m s/rad] revolute, [N s/m] prismatic."""
        ...

    @property
    def damping(self) -> float: ...
    @property
    def friction(self) -> float:
        """SAPIEN's load-dependent joint friction [1]."""
        ...

    def set_damping(self, damping: float) -> None: ...
    def set_friction(self, friction: float) -> None: ...


class Servo(Protocol):
    """The position servo of one robot joint."""

    @property
    def name(self) -> str: ...
    @property
    def nominal_damping(self) -> float: ...
    @property
    def damping(self) -> float: ...
    def set_damping(self, damping: float) -> None: ...


class Camera(Protocol):
    """A camera fixed in the world; frame x forward, y left, z up."""

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
    """A built scene, as far as the physical attributes reach into it."""

    external_force: float  # [m g] along world +X at the CoM of every body, in the policy stage

    @property
    def bodies(self) -> Sequence[Body]: ...
    @property
    def surfaces(self) -> Sequence[Surface]:
        """Of task objects, table top and finger pads: where friction and restitution apply."""
        ...

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
        """Task object name -> size of the simulator's shapes over the asset's nominal size."""
        ...

    def measured_table(self) -> tuple[float, float]:
        """Tilt [rad] and height above nominal [m], from the pose of the simulator's table."""
        ...

    def measured_force(self) -> Mapping[str, float]:
        """Body name -> force [N] along world +X that a policy-stage step puts on it now."""
        ...
