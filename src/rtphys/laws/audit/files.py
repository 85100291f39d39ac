"""What an asset's files state of a body: its shape, mass and inertia, links and joints."""

import xml.etree.ElementTree as ElementTree
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np
from scipy.spatial.transform import Rotation

from rtphys.assets.model import Articulation
from rtphys.assets.pack import Pack
from rtphys.assets.solid import corners, hull
from rtphys.core.poses import Array
from rtphys.task.props import Ball, Box, Mesh, Prop

UNSTATED_DENSITY = 400.0  # [kg/m^3] as in `sim.objects`, which is not trusted here
URDF_DENSITY = 1000.0  # [kg/m^3] of links without stated inertia: what SAPIEN's loader assumes
SIGNS = np.array(np.meshgrid((-1, 1), (-1, 1), (-1, 1))).reshape(3, -1).T  # corners of a box


@dataclass(frozen=True, eq=False)
class Matter:
    """A body in its own frame."""

    mass: float  # [kg]
    com: Array  # (3,) [m]
    inertia: Array  # (3, 3) about the centre of mass [kg m^2]

    def sized(self, k: float) -> "Matter":
        """Of the same substance, `k` times as large."""
        return Matter(self.mass * k**3, self.com * k, self.inertia * k**5)

    def weighing(self, mass: float) -> "Matter":
        """Of the same shape, with another mass [kg]."""
        return Matter(mass, self.com, self.inertia * (mass / self.mass))

    def labelled(self, factor: float, offset: Array) -> "Matter":
        """`factor` times as heavy, with its centre of mass aside by (3,) [m], axes of the body."""
        return Matter(self.mass * factor, self.com + offset, self.inertia * factor)


def matter_of(prop: Prop, pack: Pack) -> Matter:
    """A rigid prop as its asset states it, at nominal size."""
    if isinstance(prop, Box):
        sides = 2 * np.array(prop.half_size)
        mass = float(prop.density * np.prod(sides))
        stated = Matter(mass, np.zeros(3), mass / 12 * np.diag(sides @ sides - sides**2))
    elif isinstance(prop, Ball):
        mass = prop.density * 4 / 3 * np.pi * prop.radius**3
        stated = Matter(mass, np.zeros(3), 0.4 * mass * prop.radius**2 * np.eye(3))
    else:
        assert isinstance(prop, Mesh)
        model = pack.model(prop.category, prop.model)
        mass, com, inertia = model.mass_kg, model.center_of_mass, model.inertia
        if mass is not None and inertia is not None and com is not None:
            stated = Matter(mass, np.array(com), np.array(inertia))
        else:
            stated = hulls(parts_of(prop, pack), model.density or UNSTATED_DENSITY)
            stated = stated if mass is None else stated.weighing(mass)
    return stated if prop.mass_kg is None else stated.weighing(prop.mass_kg)


def parts_of(prop: Prop, pack: Pack) -> list[Array]:
    """Corners (n, 3) [m] of each collision part of a box or a mesh, at nominal size."""
    if isinstance(prop, Mesh):
        model = pack.model(prop.category, prop.model)
        return [part * model.scale for part in corners(model.collision)]
    assert isinstance(prop, Box)
    return [SIGNS * np.array(prop.half_size)]


def hulls(parts: Iterable[Array], density: float) -> Matter:
    """Convex hulls of some parts together, each counted in full where they overlap."""
    moments = [hull(part).moments for part in parts]
    mass = density * sum(volume for volume, _, _ in moments)
    first = density * np.sum([m for _, m, _ in moments], axis=0)
    second = density * np.sum([s for _, _, s in moments], axis=0)
    com = first / mass
    central = second - mass * np.outer(com, com)
    return Matter(mass, com, np.trace(central) * np.eye(3) - central)


@dataclass(frozen=True, eq=False)
class Link:
    """One link, at the asset's nominal size and in its own frame."""

    matter: Matter | None  # None: a mere frame
    parts: list[Array] | None  # corners (n, 3) [m] of each part; None: some part is round


def describe(asset: Articulation) -> tuple[Mapping[str, Link], Mapping[str, float]]:
    """Links of an articulated asset's URDF, and joint -> damping [N m s/rad or N s/m].

    A damping that the pack states replaces the file's own.
    """
    root, links, damping = ElementTree.parse(asset.urdf).getroot(), {}, {}
    for element in root.findall("link"):
        parts = _parts(element, asset.urdf.parent, asset.scale)
        inertial = element.find("inertial")
        if inertial is not None:
            matter = _matter(inertial).sized(asset.scale)
        else:
            matter = hulls(parts, URDF_DENSITY) if parts else None
        links[element.get("name", "")] = Link(matter, parts)
    for joint in root.findall("joint"):
        dynamics = joint.find("dynamics")
        own = 0.0 if dynamics is None else float(dynamics.get("damping", "0"))
        stated = asset.joint_damping
        damping[joint.get("name", "")] = own if stated is None else stated
    return links, damping


def _matter(inertial: Element) -> Matter:
    com, R = _origin(inertial)
    mass, moments = inertial.find("mass"), inertial.find("inertia")
    assert mass is not None and moments is not None
    rows = (("ixx", "ixy", "ixz"), ("ixy", "iyy", "iyz"), ("ixz", "iyz", "izz"))
    tensor = np.array([[float(moments.get(name, "0")) for name in row] for row in rows])
    return Matter(float(mass.get("value", "0")), com, R @ tensor @ R.T)


def _parts(link: Element, folder: Path, scale: float) -> list[Array] | None:
    found: list[Array] = []
    for collision in link.findall("collision"):
        p, R = _origin(collision)
        mesh, box = collision.find("geometry/mesh"), collision.find("geometry/box")
        if mesh is not None:
            name = mesh.get("filename", "").removeprefix("package://")
            own = [part * _numbers(mesh, "scale", (1, 1, 1)) for part in corners(folder / name)]
        elif box is not None:
            own = [SIGNS * _numbers(box, "size", (1, 1, 1)) / 2]
        else:
            return None
        found += [scale * (part @ R.T + p) for part in own]
    return found


def _origin(element: Element) -> tuple[Array, Array]:
    """Position (3,) and rotation (3, 3) of an element in its link."""
    origin = element.find("origin")
    origin = Element("origin") if origin is None else origin
    R = Rotation.from_euler("xyz", _numbers(origin, "rpy", (0, 0, 0))).as_matrix()
    return _numbers(origin, "xyz", (0, 0, 0)), R


def _numbers(element: Element, key: str, default: tuple[float, float, float]) -> Array:
    text = element.get(key)
    return np.array(default if text is None else text.split(), float)
