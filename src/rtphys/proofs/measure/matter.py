"""Mass, inertia and shape that files state for a body: the reference of every weighing."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from rtphys.assets.pack import Pack
from rtphys.assets.solid import hull
from rtphys.core.poses import Array
from rtphys.proofs.measure.mesh_file import corners
from rtphys.task.props import Ball, Box, Mesh, Prop

UNSTATED_DENSITY = 400.0  # [kg/m^3] of models whose pack states no mass (docs/objects.md)


@dataclass(frozen=True, eq=False)
class Matter:
    """A body in its own frame."""

    mass: float  # [kg]
    com: Array  # (3,) [m]
    inertia: Array  # (3, 3) about the centre of mass [kg m^2]

    def sized(self, k: float) -> "Matter":
        """Of the same substance, `k` times as large."""
        return Matter(self.mass * k**3, self.com * k, self.inertia * k**5)

    def labelled(self, factor: float, offset: Array) -> "Matter":
        """`factor` times as heavy, with its centre of mass aside by (3,) [m], axes of the body."""
        return Matter(self.mass * factor, self.com + offset, self.inertia * factor)


def matter_of(prop: Prop, pack: Pack) -> Matter:
    """A rigid prop as its asset states it, at nominal size."""
    stated = _stated(prop, pack)
    if prop.mass_kg is None:
        return stated
    return Matter(prop.mass_kg, stated.com, stated.inertia * (prop.mass_kg / stated.mass))


def parts_of(prop: Prop, pack: Pack) -> list[Array]:
    """Corners (n, 3) [m] of each collision part of a box or a mesh, at nominal size."""
    if isinstance(prop, Mesh):
        model = pack.model(prop.category, prop.model)
        return [part * model.scale for part in corners(model.collision)]
    assert isinstance(prop, Box)
    signs = np.array(np.meshgrid((-1, 1), (-1, 1), (-1, 1))).reshape(3, -1).T
    return [signs * np.array(prop.half_size)]


def _stated(prop: Prop, pack: Pack) -> Matter:
    if isinstance(prop, Box):
        x, y, z = sides = 2 * np.array(prop.half_size)
        mass = float(prop.density * np.prod(sides))
        moments = mass / 12 * np.array([y * y + z * z, x * x + z * z, x * x + y * y])
        return Matter(mass, np.zeros(3), np.diag(moments))
    if isinstance(prop, Ball):
        mass = prop.density * 4 / 3 * np.pi * prop.radius**3
        return Matter(mass, np.zeros(3), 0.4 * mass * prop.radius**2 * np.eye(3))
    assert isinstance(prop, Mesh)
    model = pack.model(prop.category, prop.model)
    if model.mass_kg is not None and model.inertia is not None and model.center_of_mass is not None:
        return Matter(model.mass_kg, np.array(model.center_of_mass), np.array(model.inertia))
    whole = hulls(parts_of(prop, pack), model.density or UNSTATED_DENSITY)
    if model.mass_kg is None:
        return whole
    return Matter(model.mass_kg, whole.com, whole.inertia * (model.mass_kg / whole.mass))


def hulls(parts: Iterable[Array], density: float) -> Matter:
    """Convex hulls of some parts together, each counted in full where they overlap."""
    moments = [hull(part).moments for part in parts]
    mass = density * sum(volume for volume, _, _ in moments)
    first = density * np.sum([m for _, m, _ in moments], axis=0)
    second = density * np.sum([s for _, _, s in moments], axis=0)
    com = first / mass
    central = second - mass * np.outer(com, com)
    return Matter(mass, com, np.trace(central) * np.eye(3) - central)
