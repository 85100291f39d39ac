"""What a generator returns: looks, collision, weight and the points to use an object by."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rtphys.assets.material import Finish, substance
from rtphys.assets.solid import Solid

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Part:
    """One visible piece. Edges sharper than `crease_deg` are drawn sharp."""

    solid: Solid
    finish: Finish
    material: str = "plastic"  # for mass and inertia, see material.SUBSTANCES
    crease_deg: float = 35.0


@dataclass(frozen=True, eq=False)
class Body:
    """A rigid piece of matter: a whole model, or one link of an articulation.

    `mass_kg` is what a scale would show; None weighs the parts by their materials. Inertia and
    centre of mass always follow the visible solids, hollow as they are.
    """

    visual: tuple[Part, ...]
    collision: tuple[Solid, ...]  # each convex
    mass_kg: float | None = None
    given: "Inertial | None" = None  # a data sheet's figures, which then win

    def inertial(self) -> "Inertial":
        """Mass properties of all parts, scaled to `mass_kg`."""
        if self.given is not None:
            return self.given
        weighed = [(substance(p.material).density, *p.solid.moments) for p in self.visual]
        mass = sum(rho * volume for rho, volume, _, _ in weighed)
        first = sum((rho * m for rho, _, m, _ in weighed), start=np.zeros(3))
        second = sum((rho * m for rho, _, _, m in weighed), start=np.zeros((3, 3)))
        com = first / mass
        about_com = second - mass * np.outer(com, com)
        inertia = np.trace(about_com) * np.eye(3) - about_com
        factor = 1.0 if self.mass_kg is None else self.mass_kg / mass
        volume = sum(v for _, v, _, _ in weighed)
        return Inertial(mass * factor, com, inertia * factor, mass * factor / volume)


@dataclass(frozen=True, eq=False)
class Inertial:
    """Mass [kg], centre of mass (3,) [m], inertia about it (3, 3) [kg m^2], density [kg/m^3]."""

    mass: float
    com: Array
    inertia: Array
    density: float


@dataclass(frozen=True, eq=False)
class AssetModel:
    """A rigid model as its generator returns it, in the official object frame."""

    body: Body
    material: str  # names friction
    description: tuple[str, ...]  # noun phrases without article; the last third stays unseen
    contact_points: tuple[Array, ...] = ()  # (4, 4)
    functional_points: tuple[Array, ...] = ()
    categories: tuple[str, ...] = ()
    stable: bool = True  # rests upright by itself


@dataclass(frozen=True, eq=False)
class Joint:
    """How a link hangs on its parent; `origin` is parent <- joint at q = 0."""

    name: str
    kind: str  # "revolute", "prismatic" or "fixed"
    parent: str
    child: str
    origin: Array  # (4, 4)
    axis: tuple[float, float, float] = (1.0, 0.0, 0.0)
    limits: tuple[float, float] = (0.0, 0.0)  # [rad] or [m]
    effort: float = 100.0  # [N m] or [N]
    speed: float = 10.0  # [rad/s] or [m/s]
    damping: float = 0.0  # [N m s/rad] or [N s/m]


@dataclass(frozen=True, eq=False)
class ArticulatedModel:
    """An articulated model as its generator returns it. The first link is the root, z up."""

    links: dict[str, Body]
    joints: tuple[Joint, ...]
    material: str
    description: tuple[str, ...]
    root_height: float = 0.0  # [m] of the root frame above what it stands on
    contact_points: tuple[tuple[str, Array], ...] = ()  # link name, (4, 4) in the link frame
    functional_points: tuple[tuple[str, Array], ...] = ()
    balanced: tuple[str, ...] = ()  # links whose weight a spring in the hinge carries
    categories: tuple[str, ...] = ()


def frame(p: ArrayLike, y: ArrayLike, x: ArrayLike) -> Array:
    """(4, 4) frame at p with this y axis and, made perpendicular to it, this x axis."""
    v = np.asarray(y, float) / np.linalg.norm(y)
    u = np.asarray(x, float) - v * (np.asarray(x, float) @ v)
    u /= np.linalg.norm(u)
    m = np.eye(4)
    m[:3, 0], m[:3, 1], m[:3, 2], m[:3, 3] = u, v, np.cross(u, v), p
    return m


def contact(p: ArrayLike, outward: ArrayLike, camera_up: ArrayLike) -> Array:
    """A contact point: the gripper comes against `outward`; fingers close along x cross y."""
    return frame(p, outward, camera_up)


def functional(p: ArrayLike, z: ArrayLike, x: ArrayLike) -> Array:
    """A functional point whose z axis is what the object states (down, out of a face ...)."""
    w = np.asarray(z, float)
    return frame(p, np.cross(w, np.asarray(x, float)), x)


def from_above(p: ArrayLike, yaws_deg: Iterable[float] = (0, 90, 180, 270)) -> tuple[Array, ...]:
    """Top-down grasps of a y-up model. At yaw 0 the camera looks up along +x, fingers close
    along z; the yaw turns both about +y."""
    turns = [np.deg2rad(a) for a in yaws_deg]
    return tuple(contact(p, (0, 1, 0), (np.cos(a), 0, -np.sin(a))) for a in turns)


def from_sides(
    height: float, azimuths_deg: Iterable[float] = range(0, 360, 45), radius: float = 0.0
) -> tuple[Array, ...]:
    """Horizontal grasps of a y-up model at `height`, coming from these azimuths about +y.

    Azimuth 0 comes from +z, 90 from +x. Fingers close horizontally, camera up is +y.
    """
    out = []
    for a in np.deg2rad(list(azimuths_deg)):
        outward = np.array([np.sin(a), 0, np.cos(a)])
        p = radius * outward + [0, height, 0]
        out.append(contact(p, outward, (0, 1, 0)))
    return tuple(out)
