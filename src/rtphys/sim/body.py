"""Bodies, surfaces, joints and servos of SAPIEN, as the physics layer wants to see them."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

import numpy as np
import sapien
from numpy.typing import ArrayLike
from sapien import physx

from rtphys.assets.embodiment import Drive
from rtphys.assets.solid import Solid
from rtphys.core.poses import Array, Pose
from rtphys.physics.handles import Material
from rtphys.sim.engine import AnyBody, Component, from_sapien, to_sapien

FOOT_RADIUS = 5e-4  # [m] of the spheres of `feet.py`; no other shape is so small

# [m] Radius for torsional friction, far too small to matter. With any radius PhysX solves a contact
# by itself, not four at once in a code that gets the friction of light bodies wrong (a plate of
# 20 g at mu 0.01, with three others in the scene, never slid).
SINGLE = 1e-6

_CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
_RING = np.array([[np.cos(a), np.sin(a)] for a in np.arange(24) * np.pi / 12])


def shape_points(shape: physx.PhysxCollisionShape) -> Array:
    """Vertices (n, 3) of one collision shape in its body's frame [m]; round ones are sampled."""
    if isinstance(shape, physx.PhysxCollisionShapeConvexMesh):
        points = np.asarray(shape.vertices, float) * np.asarray(shape.scale, float)
    elif isinstance(shape, physx.PhysxCollisionShapeBox):
        points = _CORNERS * np.asarray(shape.half_size, float)
    elif isinstance(shape, physx.PhysxCollisionShapeSphere):
        points = _sphere_points(shape.radius)
    elif isinstance(shape, physx.PhysxCollisionShapeCylinder):
        ends = [np.c_[np.full(24, s * shape.half_length), shape.radius * _RING] for s in (-1, 1)]
        points = np.vstack(ends)  # PhysX cylinders and capsules lie along x
    elif isinstance(shape, physx.PhysxCollisionShapeCapsule):
        shift = np.array([shape.half_length, 0, 0])
        ball = _sphere_points(shape.radius)
        points = np.vstack([ball - shift, ball + shift])
    else:
        return np.empty((0, 3))
    local = shape.local_pose
    X_BS = np.asarray(local.to_transformation_matrix(), float)
    return points @ X_BS[:3, :3].T + X_BS[:3, 3]


def _sphere_points(radius: float) -> Array:
    rings = [np.c_[_RING * np.cos(t), np.full(24, np.sin(t))] for t in np.linspace(-1.5, 1.5, 7)]
    return radius * np.vstack(rings)


def shape_size(shape: physx.PhysxCollisionShape) -> float:
    """A length that scales with the shape: norm of mesh scale or half size, or the radius."""
    if isinstance(shape, physx.PhysxCollisionShapeConvexMesh):
        return float(np.linalg.norm(np.asarray(shape.scale, float)))
    if isinstance(shape, physx.PhysxCollisionShapeBox):
        return float(np.linalg.norm(np.asarray(shape.half_size, float)))
    if isinstance(shape, physx.PhysxCollisionShapeSphere):
        return float(shape.radius)
    raise TypeError(f"no size for a {type(shape).__name__}")


def own_shapes(component: AnyBody) -> list[physx.PhysxCollisionShape]:
    """A body's collision shapes without its feet, which lie within them but for micrometres."""
    return [shape for shape in component.collision_shapes if not is_foot(shape)]


def is_foot(shape: physx.PhysxCollisionShape) -> bool:
    """Whether it is one of the spheres of `feet.py`."""
    sphere = isinstance(shape, physx.PhysxCollisionShapeSphere)
    return sphere and shape.radius < 2 * FOOT_RADIUS


def body_points(component: AnyBody) -> Array:
    """Collision vertices (n, 3) of a body in its own frame [m], its feet left out."""
    parts = [shape_points(shape) for shape in own_shapes(component)]
    return np.vstack(parts) if parts else np.empty((0, 3))


# [kg] Fingers sink by millimetres into a body that is lighter, because ten iterations a step do
# not carry the force of a servo through so little mass.
LIGHT, ITERATIONS = 0.005, (10, 40)


class SimBody:
    """A dynamic task body; remembers what it weighed as built (`rtphys.physics.handles.Body`)."""

    def __init__(self, name: str, component: Component) -> None:
        self.name, self.component = name, component
        self.nominal_mass = self.mass
        self.nominal_inertia, self.nominal_com = self.inertia, self.com
        for array in (self.nominal_inertia, self.nominal_com):
            array.setflags(write=False)

    @property
    def spin_decay(self) -> float:
        return float(self.component.angular_damping)

    @property
    def hull(self) -> Array:
        return body_points(self.component)

    @property
    def mass(self) -> float:
        return float(self.component.mass)

    @property
    def inertia(self) -> Array:
        return np.array(self.component.inertia, float)

    @property
    def com(self) -> Array:
        return np.array(self.component.cmass_local_pose.p, float)

    def set_mass(self, kg: float) -> None:
        self.component.set_mass(kg)
        if isinstance(self.component, physx.PhysxRigidDynamicComponent) and not self._is_ball:
            few, many = ITERATIONS
            self.component.set_solver_position_iterations(many if kg < LIGHT else few)

    @property
    def _is_ball(self) -> bool:
        """Balls are poured, and hands hold none."""
        sphere = physx.PhysxCollisionShapeSphere
        return any(isinstance(shape, sphere) for shape in own_shapes(self.component))

    def set_inertia(self, diagonal: ArrayLike) -> None:
        self.component.set_inertia(np.asarray(diagonal, float).tolist())

    def set_com(self, p: ArrayLike) -> None:
        # Keep the rotation: it is that of the principal axes, and replacing it turns the inertia.
        rotation = self.component.cmass_local_pose.q
        self.component.set_cmass_local_pose(sapien.Pose(np.asarray(p, float).tolist(), rotation))


# Friction, static and dynamic, and restitution of whatever no attribute writes: what RoboTwin
# states for its scenes (`default_physical_material`), instead of SAPIEN's 0.3, 0.3 and 0.1.
MATERIAL: Material = (0.5, 0.5, 0.0)


class SimSurface:
    """Shapes that share one material of their own (`rtphys.physics.handles.Surface`)."""

    def __init__(self, name: str, shapes: Iterable[physx.PhysxCollisionShape]) -> None:
        self.name, self.shapes = name, list(shapes)
        # SAPIEN bodies share a default material: editing one would edit them all.
        material = physx.PhysxMaterial(*MATERIAL)
        for shape in self.shapes:
            shape.set_physical_material(material)
            shape.set_patch_radius(SINGLE)

    def set_material(self, static: float, dynamic: float, restitution: float) -> None:
        for shape in self.shapes:
            material = shape.physical_material
            material.set_static_friction(static)
            material.set_dynamic_friction(dynamic)
            material.set_restitution(restitution)

    def materials(self) -> list[Material]:
        physical = [shape.physical_material for shape in self.shapes]
        return [(m.static_friction, m.dynamic_friction, m.restitution) for m in physical]


class SimJoint:
    """A joint of an articulated task object (`rtphys.physics.handles.Joint`)."""

    def __init__(
        self, name: str, joint: physx.PhysxArticulationJoint, damping: float | None
    ) -> None:
        self.name, self.joint = name, joint
        # SAPIEN's default joint friction of 0.05 is load-dependent; nothing asked for it.
        joint.set_friction(0.0)
        if damping is not None:
            joint.set_drive_properties(0.0, damping)
        self.nominal_damping = float(joint.damping)

    @property
    def kind(self) -> Literal["revolute", "prismatic"]:
        return "prismatic" if self.joint.type == "prismatic" else "revolute"

    @property
    def damping(self) -> float:
        return float(self.joint.damping)

    @property
    def friction(self) -> float:
        return float(self.joint.friction)

    def set_damping(self, damping: float) -> None:
        self.joint.set_drive_properties(0.0, damping)

    def set_friction(self, friction: float) -> None:
        self.joint.set_friction(friction)


UNLIMITED = 3.4e38  # [N m or N] the largest single-precision number, as SAPIEN has it


class SimServo:
    """The position servo of one robot joint (`rtphys.physics.handles.Servo`)."""

    def __init__(self, joint: physx.PhysxArticulationJoint, drive: Drive, effort: float) -> None:
        """`effort`: largest torque or force of the motor [N m or N]."""
        self.name, self.joint = joint.name, joint
        self.nominal_stiffness, self.nominal_damping = drive.stiffness, drive.damping
        joint.set_friction(0.0)
        self._effort = min(effort, UNLIMITED)
        joint.set_drive_properties(drive.stiffness, drive.damping, self._effort)
        joint.set_armature(np.array([[drive.armature]], np.float32))

    @property
    def stiffness(self) -> float:
        return float(self.joint.stiffness)

    def set_stiffness(self, stiffness: float) -> None:
        self.joint.set_drive_properties(stiffness, self.joint.damping, self._effort)

    @property
    def damping(self) -> float:
        return float(self.joint.damping)

    def set_damping(self, damping: float) -> None:
        self.joint.set_drive_properties(self.joint.stiffness, damping, self._effort)


# ---- mass properties -----------------------------------------------------------------------------

NEGLIGIBLE = 1e-6  # share of the trace: single precision, so the axes are the body's own


@dataclass(frozen=True, eq=False)
class MassProperties:
    """Mass, centre of mass and inertia of a rigid body, in its own frame, by exact integrals.

    SAPIEN's own automatic inertia is never below 1e-6 kg m^2, forty times that of a small ball.
    """

    mass: float  # [kg]
    com: Array  # (3,) [m]
    inertia: Array  # (3, 3) about the centre of mass [kg m^2]

    def weighing(self, mass: float) -> "MassProperties":
        """The same shape of another mass [kg]."""
        return MassProperties(mass, self.com, self.inertia * (mass / self.mass))

    def scaled(self, k: float) -> "MassProperties":
        """The same substance, k times as large: mass grows with k³, inertia with k⁵."""
        return MassProperties(self.mass * k**3, self.com * k, self.inertia * k**5)

    def give(self, component: physx.PhysxRigidBodyComponent) -> None:
        """Put them in force; SAPIEN computes none of them any more."""
        moments, axes = np.diag(self.inertia), np.eye(3)  # principal ones, axes as columns
        if np.abs(self.inertia - np.diag(moments)).max() >= NEGLIGIBLE * moments.sum():
            moments, axes = np.linalg.eigh(self.inertia)
            axes[:, 2] *= np.sign(np.linalg.det(axes))  # right-handed
        component.set_cmass_local_pose(to_sapien(Pose(self.com, Pose.from_matrix(axes).q)))
        component.set_mass(self.mass)  # leaves the inertia as it was
        component.set_inertia(moments.tolist())


def of_shapes(shapes: Iterable[physx.PhysxCollisionShape]) -> MassProperties:
    """What shapes of their own densities weigh together.

    Where parts overlap, each counts in full, as in SAPIEN's own sum.
    """
    mass, first, second = 0.0, np.zeros(3), np.zeros((3, 3))
    for shape in shapes:
        volume, by_place, by_square = _integrals(shape)
        X_BS = from_sapien(shape.local_pose)
        p, turned = X_BS.p, X_BS.R @ by_place
        moved = X_BS.R @ by_square @ X_BS.R.T + np.outer(turned, p) + np.outer(p, turned)
        mass += shape.density * volume
        first += shape.density * (turned + volume * p)
        second += shape.density * (moved + volume * np.outer(p, p))
    com = first / mass
    central = second - mass * np.outer(com, com)
    return MassProperties(mass, com, np.trace(central) * np.eye(3) - central)


Integrals = tuple[float, Array, Array]  # of 1 [m^3], x [m^4] and x x^T [m^5] over a solid


def _integrals(shape: physx.PhysxCollisionShape) -> Integrals:
    """Over a shape in its own frame."""
    if isinstance(shape, physx.PhysxCollisionShapeConvexMesh):
        points = np.asarray(shape.vertices, float) * np.asarray(shape.scale, float)
        volume, first, second = Solid(points, np.asarray(shape.triangles, np.int64)).moments
        # A mirrored mesh, or one that looks inward, has all three negative.
        return (volume, first, second) if volume > 0 else (-volume, -first, -second)
    if isinstance(shape, physx.PhysxCollisionShapeBox):
        half = np.asarray(shape.half_size, float)
        return _centred(8 * float(np.prod(half)), half**2 / 3)
    if isinstance(shape, physx.PhysxCollisionShapeSphere):
        return _centred(4 / 3 * np.pi * shape.radius**3, np.full(3, shape.radius**2 / 5))
    if isinstance(shape, physx.PhysxCollisionShapeCylinder):
        h, r = shape.half_length, shape.radius  # it lies along x
        return _centred(2 * np.pi * r**2 * h, np.array([h**2 / 3, r**2 / 4, r**2 / 4]))
    raise TypeError(f"no mass for a {type(shape).__name__}")


def _centred(volume: float, mean_square: Array) -> Integrals:
    """Of a solid that is symmetric about its frame's planes."""
    return volume, np.zeros(3), volume * np.diag(mean_square)
