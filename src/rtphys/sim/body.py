"""Bodies, surfaces, joints and servos of SAPIEN, as the physics layer wants to see them."""

from collections.abc import Iterable
from typing import Literal

import numpy as np
import sapien
from numpy.typing import ArrayLike
from sapien import physx

from rtphys.core.poses import Array
from rtphys.physics.handles import Material

Component = physx.PhysxRigidDynamicComponent | physx.PhysxArticulationLinkComponent
AnyBody = Component | physx.PhysxRigidStaticComponent

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
    return [shape for shape in component.collision_shapes if not _is_foot(shape)]


def _is_foot(shape: physx.PhysxCollisionShape) -> bool:
    sphere = isinstance(shape, physx.PhysxCollisionShapeSphere)
    return sphere and shape.radius < 2 * FOOT_RADIUS


def body_points(component: AnyBody) -> Array:
    """Collision vertices (n, 3) of a body in its own frame [m], its feet left out."""
    parts = [shape_points(shape) for shape in own_shapes(component)]
    return np.vstack(parts) if parts else np.empty((0, 3))


class SimBody:
    """A dynamic task body; remembers what it weighed as built (`rtphys.physics.handles.Body`)."""

    def __init__(self, name: str, component: Component) -> None:
        self._name, self.component = name, component
        self._mass = float(component.mass)
        self._inertia = np.array(component.inertia, float)
        self._com = np.array(component.cmass_local_pose.p, float)

    @property
    def name(self) -> str:
        return self._name

    @property
    def nominal_mass(self) -> float:
        return self._mass

    @property
    def nominal_inertia(self) -> Array:
        return self._inertia.copy()

    @property
    def nominal_com(self) -> Array:
        return self._com.copy()

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
        self._name = name
        self.shapes = list(shapes)
        # SAPIEN bodies share a default material: editing one would edit them all.
        material = physx.PhysxMaterial(*MATERIAL)
        for shape in self.shapes:
            shape.set_physical_material(material)
            shape.set_patch_radius(SINGLE)

    @property
    def name(self) -> str:
        return self._name

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
        self._name, self.joint = name, joint
        # SAPIEN's default joint friction of 0.05 is load-dependent; nothing asked for it.
        joint.set_friction(0.0)
        if damping is not None:
            joint.set_drive_properties(0.0, damping)
        self._nominal = float(joint.damping)

    @property
    def name(self) -> str:
        return self._name

    @property
    def kind(self) -> Literal["revolute", "prismatic"]:
        return "prismatic" if self.joint.type == "prismatic" else "revolute"

    @property
    def nominal_damping(self) -> float:
        return self._nominal

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


class SimServo:
    """The position servo of one robot joint (`rtphys.physics.handles.Servo`)."""

    def __init__(
        self, joint: physx.PhysxArticulationJoint, gains: tuple[float, float], armature: float
    ) -> None:
        """Take over a joint.

        Args:
            gains: stiffness [N m/rad or N/m] and nominal damping [N m s/rad or N s/m].
            armature: inertia of the rotor as the joint feels it [kg m^2 or kg].
        """
        self.joint, (self._stiffness, self._damping) = joint, gains  # the nominal ones
        joint.set_friction(0.0)
        joint.set_drive_properties(*gains)
        joint.set_armature(np.array([[armature]], np.float32))

    @property
    def name(self) -> str:
        return self.joint.name

    @property
    def nominal_stiffness(self) -> float:
        return self._stiffness

    @property
    def stiffness(self) -> float:
        return float(self.joint.stiffness)

    def set_stiffness(self, stiffness: float) -> None:
        self.joint.set_drive_properties(stiffness, self.joint.damping)

    @property
    def nominal_damping(self) -> float:
        return self._damping

    @property
    def damping(self) -> float:
        return float(self.joint.damping)

    def set_damping(self, damping: float) -> None:
        self.joint.set_drive_properties(self.joint.stiffness, damping)
