"""What a URDF states of the links and joints of an articulated object."""

import xml.etree.ElementTree as ElementTree
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np
from scipy.spatial.transform import Rotation

from rtphys.assets.model import Articulation
from rtphys.core.poses import Array
from rtphys.proofs.measure.matter import Matter, hulls
from rtphys.proofs.measure.mesh_file import corners

URDF_DENSITY = 1000.0  # [kg/m^3] of links without stated inertia: what SAPIEN's loader assumes


@dataclass(frozen=True, eq=False)
class Link:
    """One link, at the asset's nominal size and in its own frame."""

    matter: Matter | None  # None: a mere frame
    parts: tuple[Array, ...] | None  # corners (n, 3) [m] of each part; None: some part is round


@dataclass(frozen=True, eq=False)
class Description:
    """An articulated asset at nominal size."""

    links: Mapping[str, Link]
    damping: Mapping[str, float]  # joint -> [N m s/rad or N s/m]


def describe(asset: Articulation) -> Description:
    """Read an asset's URDF; a damping that the pack states replaces the file's own."""
    root = ElementTree.parse(asset.urdf).getroot()
    links = {
        link.get("name", ""): _link(link, asset.urdf.parent, asset.scale)
        for link in root.findall("link")
    }
    damping: dict[str, float] = {}
    for joint in root.findall("joint"):
        dynamics = joint.find("dynamics")
        own = 0.0 if dynamics is None else float(dynamics.get("damping", "0"))
        stated = asset.joint_damping
        damping[joint.get("name", "")] = own if stated is None else stated
    return Description(links, damping)


def _link(link: Element, folder: Path, scale: float) -> Link:
    parts = _parts(link, folder, scale)
    inertial = link.find("inertial")
    if inertial is not None:
        return Link(_matter(inertial).sized(scale), parts)
    return Link(hulls(parts, URDF_DENSITY) if parts else None, parts)


def _matter(inertial: Element) -> Matter:
    com, R = _origin(inertial)
    mass, moments = inertial.find("mass"), inertial.find("inertia")
    assert mass is not None and moments is not None
    ixx, ixy, ixz, iyy, iyz, izz = (
        float(moments.get(name, "0")) for name in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    )
    tensor = np.array([[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]])
    return Matter(float(mass.get("value", "0")), com, R @ tensor @ R.T)


def _parts(link: Element, folder: Path, scale: float) -> tuple[Array, ...] | None:
    found: list[Array] = []
    for collision in link.findall("collision"):
        p, R = _origin(collision)
        mesh, box = collision.find("geometry/mesh"), collision.find("geometry/box")
        if mesh is not None:
            name = mesh.get("filename", "").removeprefix("package://")
            own = [part * _numbers(mesh, "scale", (1, 1, 1)) for part in corners(folder / name)]
        elif box is not None:
            signs = np.array(np.meshgrid((-1, 1), (-1, 1), (-1, 1))).reshape(3, -1).T
            own = [signs * _numbers(box, "size", (1, 1, 1)) / 2]
        else:
            return None
        found += [scale * (part @ R.T + p) for part in own]
    return tuple(found)


def _origin(element: Element) -> tuple[Array, Array]:
    """Position (3,) and rotation (3, 3) of an element in its link."""
    origin = element.find("origin")
    if origin is None:
        return np.zeros(3), np.eye(3)
    angles = _numbers(origin, "rpy", (0, 0, 0))
    return _numbers(origin, "xyz", (0, 0, 0)), Rotation.from_euler("xyz", angles).as_matrix()


def _numbers(element: Element, key: str, default: tuple[float, float, float]) -> Array:
    text = element.get(key)
    return np.array(default if text is None else text.split(), float)
