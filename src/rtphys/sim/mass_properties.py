"""Mass, centre of mass and inertia of collision shapes by exact integrals.

SAPIEN's own automatic inertia is never below 1e-6 kg m^2, forty times that of a small ball.
"""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from sapien import physx

from rtphys.assets.solid import Solid
from rtphys.core.poses import Array, Pose
from rtphys.sim.engine import from_sapien, to_sapien

NEGLIGIBLE = 1e-6  # share of the trace: single precision, so the axes are the body's own


@dataclass(frozen=True, eq=False)
class MassProperties:
    """Of a rigid body, in its own frame."""

    mass: float  # [kg]
    com: Array  # (3,) [m]
    inertia: Array  # (3, 3) about the centre of mass [kg m^2]

    def weighing(self, mass: float) -> "MassProperties":
        """The same shape of another mass [kg]."""
        return MassProperties(mass, self.com, self.inertia * (mass / self.mass))

    def scaled(self, k: float) -> "MassProperties":
        """The same substance, k times as large: mass grows with k³, inertia with k⁵."""
        return MassProperties(self.mass * k**3, self.com * k, self.inertia * k**5)

    def principal(self) -> tuple[Array, Array]:
        """Principal moments (3,) [kg m^2], and their axes (3, 3) as columns, right-handed."""
        moments = np.diag(self.inertia)
        if np.abs(self.inertia - np.diag(moments)).max() < NEGLIGIBLE * moments.sum():
            return moments, np.eye(3)
        moments, axes = np.linalg.eigh(self.inertia)
        axes[:, 2] *= np.sign(np.linalg.det(axes))
        return moments, axes

    def give(self, component: physx.PhysxRigidBodyComponent) -> None:
        """Put them in force; SAPIEN computes none of them any more."""
        moments, axes = self.principal()
        component.set_cmass_local_pose(to_sapien(Pose(self.com, Pose.from_matrix(axes).q)))
        component.set_mass(self.mass)  # leaves the inertia as it was
        component.set_inertia(moments.tolist())


def of_shapes(shapes: Iterable[physx.PhysxCollisionShape]) -> MassProperties:
    """What shapes of their own densities weigh together.

    Where parts overlap, each counts in full, as in SAPIEN's own sum.
    """
    mass, first, second = 0.0, np.zeros(3), np.zeros((3, 3))
    for shape in shapes:
        volume, by_place, by_square = _placed(_integrals(shape), from_sapien(shape.local_pose))
        mass += shape.density * volume
        first += shape.density * by_place
        second += shape.density * by_square
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


def _placed(integrals: Integrals, X_BS: Pose) -> Integrals:
    volume, first, second = integrals
    p, turned = X_BS.p, X_BS.R @ first
    moved = X_BS.R @ second @ X_BS.R.T + np.outer(turned, p) + np.outer(p, turned)
    return volume, turned + volume * p, moved + volume * np.outer(p, p)
