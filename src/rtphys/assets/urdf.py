"""Writes links and joints as URDF, with mesh files beside it."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rtphys.assets.asset_model import Body, Inertial, Joint
from rtphys.assets.shading import DECIMALS
from rtphys.assets.solid import Solid

Array = NDArray[np.float64]


def urdf_text(
    name: str, links: Mapping[str, Body], joints: Sequence[Joint], files: Mapping[str, str]
) -> str:
    """The text of a URDF file.

    Args:
        links: link name -> body, the root first.
        joints: every other link is the child of exactly one.
        files: link name -> stem of its mesh files, `<stem>.glb` and `<stem>_<i>.stl`.
    """
    robot = Element("robot", name=name)
    for link_name, body in links.items():
        link = SubElement(robot, "link", name=link_name)
        if body.visual or body.given:
            _inertial(link, body.inertial())
        if body.visual:
            _mesh(SubElement(link, "visual"), f"{files[link_name]}.glb")
        # One element per convex part: loaders make a single hull of each file.
        for i in range(len(body.collision)):
            _mesh(SubElement(link, "collision"), f"{files[link_name]}_{i}.stl")
    for joint in joints:
        _joint(robot, joint)
    ElementTree.indent(robot, "  ")
    return ElementTree.tostring(robot, encoding="unicode", xml_declaration=True) + "\n"


def stl_bytes(solid: Solid) -> bytes:
    """The binary STL file of a collision part."""
    corners = (np.round(solid.vertices, DECIMALS) + 0.0)[solid.faces]
    record = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("count", "<u2")])
    rows = np.zeros(len(corners), record)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.maximum(np.linalg.norm(normal, axis=1), 1e-15)
    rows["normal"] = np.round(normal / length[:, None], 3) + 0.0
    rows["corners"] = corners
    return b"rtphys".ljust(80, b" ") + np.uint32(len(corners)).tobytes() + rows.tobytes()


def write_meshes(folder: Path, stem: str, glb: bytes | None, collision: Sequence[Solid]) -> None:
    """Write `<stem>.glb` and one STL per collision part."""
    path = folder / stem
    path.parent.mkdir(parents=True, exist_ok=True)
    if glb is not None:
        path.with_name(f"{path.name}.glb").write_bytes(glb)
    for i, part in enumerate(collision):
        path.with_name(f"{path.name}_{i}.stl").write_bytes(stl_bytes(part))


def _joint(robot: Element, joint: Joint) -> None:
    node = SubElement(robot, "joint", name=joint.name, type=joint.kind)
    _origin(node, joint.origin)
    SubElement(node, "parent", link=joint.parent)
    SubElement(node, "child", link=joint.child)
    if joint.kind == "fixed":
        return
    SubElement(node, "axis", xyz=_text(joint.axis))
    low, high = joint.limits
    SubElement(
        node,
        "limit",
        lower=_text([low]),
        upper=_text([high]),
        effort=_text([joint.effort]),
        velocity=_text([joint.speed]),
    )
    SubElement(node, "dynamics", damping=_text([joint.damping]), friction="0")


def _inertial(link: Element, inertial: Inertial) -> None:
    node = SubElement(link, "inertial")
    SubElement(node, "origin", xyz=_text(inertial.com), rpy="0 0 0")
    SubElement(node, "mass", value=f"{inertial.mass:.6g}")
    names = {
        "ixx": (0, 0),
        "ixy": (0, 1),
        "ixz": (0, 2),
        "iyy": (1, 1),
        "iyz": (1, 2),
        "izz": (2, 2),
    }
    SubElement(node, "inertia", {k: f"{inertial.inertia[ij]:.6g}" for k, ij in names.items()})


def _mesh(node: Element, file: str) -> None:
    SubElement(node, "origin", xyz="0 0 0", rpy="0 0 0")
    SubElement(SubElement(node, "geometry"), "mesh", filename=file)


def _origin(node: Element, X: Array) -> None:
    SubElement(node, "origin", xyz=_text(X[:3, 3]), rpy=_text(rpy(X)))


def rpy(X: Array) -> Array:
    """Roll, pitch, yaw (3,) [rad] of a matrix (4, 4), with R = Rz(yaw) Ry(pitch) Rx(roll)."""
    pitch = np.arctan2(-X[2, 0], np.hypot(X[0, 0], X[1, 0]))
    return np.array([np.arctan2(X[2, 1], X[2, 2]), pitch, np.arctan2(X[1, 0], X[0, 0])])


def placed(xyz: ArrayLike, rpy_rad: ArrayLike = (0.0, 0.0, 0.0)) -> Array:
    """Matrix (4, 4) of a URDF origin."""
    (a, b, c), X = np.asarray(rpy_rad, float), np.eye(4)
    (sa, sb, sc), (ca, cb, cc) = np.sin([a, b, c]), np.cos([a, b, c])
    X[:3, :3] = [
        [cc * cb, cc * sb * sa - sc * ca, cc * sb * ca + sc * sa],
        [sc * cb, sc * sb * sa + cc * ca, sc * sb * ca - cc * sa],
        [-sb, cb * sa, cb * ca],
    ]
    X[:3, 3] = xyz
    return X


def root_joint(root: str, link: str) -> Joint:
    """The fixed joint that every official articulated object begins with: it turns y up into z up.

    In `link` x is the user's right and +z faces the user; in `root` the user is at -x. So a root
    turned by 90 degrees about z faces the robot.
    """
    return Joint("upright", "fixed", root, link, placed((0, 0, 0), (np.pi / 2, 0, -np.pi / 2)))


def _text(values: ArrayLike) -> str:
    return " ".join(f"{v:.9g}" for v in np.round(np.asarray(values, float), 9) + 0.0)
