"""Two arms, each described by a URDF of its own, as one URDF of a robot that stands fast.

Names get the prefix `left_` or `right_`. Links that are fixed to another become part of it, since
the simulator spends as much on a link that cannot move as on one that can.
"""

import copy
import xml.etree.ElementTree as ElementTree
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple
from xml.etree.ElementTree import Element, SubElement

import numpy as np
from numpy.typing import NDArray

from rtphys.assets.mesh_header import check_mesh
from rtphys.assets.urdf import placed, rpy
from rtphys.core.arithmetic import total
from rtphys.core.errors import BadFile, MissingAsset, UnknownName
from rtphys.core.untrusted import read_file

Array = NDArray[np.float64]

ROOT = "robot_pair"
_TENSOR = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
_ROWS, _COLUMNS = (0, 0, 0, 1, 1, 2), (0, 1, 2, 1, 2, 2)


@dataclass(eq=False)
class ArmUrdf:
    """The URDF of one arm, with every link that cannot move of itself as part of another.

    Raises:
        BadFile: not a URDF, not a tree of links with one root, or a mesh that is none.
        MissingAsset: a mesh is not there.
    """

    path: Path
    links: dict[str, Element] = field(init=False)
    joints: dict[str, Element] = field(init=False)
    root: str = field(init=False)
    hosts: dict[str, tuple[str, Array]] = field(init=False)  # link -> moving link, X (4, 4) in it

    def __post_init__(self) -> None:
        tree = parsed_urdf(self.path)
        self.links = {link.get("name", ""): link for link in tree.findall("link")}
        self.joints = {joint.get("name", ""): joint for joint in tree.findall("joint")}
        check_meshes(self.path, tree)
        children = {_end(joint, "child") for joint in self.joints.values()}
        roots = [name for name in self.links if name not in children]
        if len(roots) != 1:
            raise BadFile(self.path, f"has {len(roots)} root links, expected one")
        self.root = roots[0]
        self.hosts = {self.root: (self.root, np.eye(4))}
        self._find_hosts()

    def _find_hosts(self) -> None:
        waiting = list(self.joints.values())
        while waiting:
            ready = [joint for joint in waiting if _end(joint, "parent") in self.hosts]
            if not ready:
                lost = sorted(_end(joint, "child") for joint in waiting)
                raise BadFile(self.path, f"links {lost} do not hang on the root {self.root!r}")
            for joint in ready:
                child, (host, X) = _end(joint, "child"), self.hosts[_end(joint, "parent")]
                if joint.get("type") == "fixed":
                    self.hosts[child] = host, X @ _origin(joint)
                else:
                    self.hosts[child] = child, np.eye(4)
            waiting = [joint for joint in waiting if joint not in ready]

    def mount(self, link: str) -> tuple[str, Array]:
        """The moving link that carries a link, and the link's frame (4, 4) in it.

        Raises:
            UnknownName: no such link.
        """
        if link not in self.hosts:
            raise UnknownName("link", link, self.hosts, self.path)
        return self.hosts[link]

    def limits(self, joint: str, kind: str = "") -> "JointRange":
        """What the URDF allows a joint; a continuous one turns by +-pi.

        Args:
            kind: the type that it must have; empty: any that moves.

        Raises:
            UnknownName: no such joint.
            BadFile: it has no limits, or another type.
        """
        return joint_limits(self.path, self.joints, joint, kind)

    def put_into(self, robot: Element, side: str, base: Array) -> None:
        """Append this arm's links and joints to a URDF, its root at `base` (4, 4)."""
        for name in self.links:
            if self.hosts[name][0] == name:
                robot.append(self._link(name, side))
        for name, joint in self.joints.items():
            if joint.get("type") == "fixed":
                continue
            host, X = self.hosts[_end(joint, "parent")]
            moved = copy.deepcopy(joint)
            for mimic in moved.findall("mimic"):  # each finger has a servo of its own
                moved.remove(mimic)
            moved.set("name", f"{side}_{name}")
            moved.find("parent").set("link", f"{side}_{host}")  # pyright: ignore[reportOptionalMemberAccess]
            moved.find("child").set("link", f"{side}_{_end(joint, 'child')}")  # pyright: ignore[reportOptionalMemberAccess]
            _set_origin(moved, X @ _origin(joint))
            robot.append(moved)
        mount = SubElement(robot, "joint", name=f"{side}_mount", type="fixed")
        _set_origin(mount, base)
        SubElement(mount, "parent", link=ROOT)
        SubElement(mount, "child", link=f"{side}_{self.root}")

    def _link(self, name: str, side: str) -> Element:
        link = Element("link", name=f"{side}_{name}")
        parts = [(part, X) for part, (host, X) in self.hosts.items() if host == name]
        if (inertial := _sum([_inertial(self.links[part], X) for part, X in parts])) is not None:
            link.append(inertial)
        for part, X in parts:
            for shape in (
                *self.links[part].findall("visual"),
                *self.links[part].findall("collision"),
            ):
                own = copy.deepcopy(shape)
                _set_origin(own, X @ _origin(shape))
                for mesh in own.iter("mesh"):
                    mesh.set("filename", str(mesh_file(self.path, mesh)))
                link.append(own)
        return link


def pair_urdf(arms: Sequence[tuple[str, ArmUrdf, Array]]) -> str:
    """The text of a URDF that holds all arms; meshes have absolute paths.

    Args:
        arms: side, description, and pose (4, 4) of its root in the world.
    """
    robot = Element("robot", name=ROOT)
    SubElement(robot, "link", name=ROOT)
    for side, arm, base in arms:
        arm.put_into(robot, side, base)
    ElementTree.indent(robot, " ")
    return ElementTree.tostring(robot, encoding="unicode") + "\n"


def parsed_urdf(path: Path) -> Element:
    """The root element of a URDF. Raises `BadFile`."""
    try:
        return ElementTree.fromstring(read_file(path, links=True))
    except ElementTree.ParseError as error:
        raise BadFile(path, f"is not XML: {error}") from error


class JointRange(NamedTuple):
    """What a URDF allows a joint."""

    low: float  # [rad or m]
    high: float  # [rad or m]
    effort: float  # [N m or N] largest of its motor; infinite where the file states none, or zero


def joint_limits(path: Path, joints: dict[str, Element], joint: str, kind: str = "") -> JointRange:
    """See `ArmUrdf.limits`."""
    if joint not in joints:
        raise UnknownName("joint", joint, joints, path)
    element = joints[joint]
    found = element.get("type", "")
    if found == "continuous" and kind != "prismatic":
        return JointRange(-np.pi, np.pi, _effort(path, joint, element.find("limit")))
    if found not in ({kind} if kind else {"revolute", "prismatic"}):
        raise BadFile(path, f"joint {joint!r} is {found}, not {kind or 'one that moves'}")
    low, high = _stated(path, joint, element.find("limit"))
    if not low < high or not np.isfinite([low, high]).all():
        raise BadFile(path, f"joint {joint!r} has no room between its limits {low:g} and {high:g}")
    return JointRange(low, high, _effort(path, joint, element.find("limit")))


def _effort(path: Path, joint: str, limit: Element | None) -> float:
    text = "0" if limit is None else limit.get("effort", "0")
    try:
        effort = float(text)
    except ValueError as problem:
        raise BadFile(path, f"joint {joint!r}: effort {text!r} is no number") from problem
    if not effort >= 0:
        raise BadFile(path, f"joint {joint!r}: effort {effort:g} is below zero")
    return effort or np.inf


def _stated(path: Path, joint: str, limit: Element | None) -> tuple[float, float]:
    stated = {} if limit is None else limit.attrib
    try:
        return float(stated["lower"]), float(stated["upper"])
    except (KeyError, ValueError) as problem:
        raise BadFile(
            path, f"joint {joint!r} has no limits: write <limit lower=... upper=.../>"
        ) from problem


def check_meshes(path: Path, urdf: Element) -> None:
    """Look at each mesh that a URDF names.

    Raises:
        MissingAsset: meshes are not there; it names them all.
        BadFile: one is no mesh.
    """
    names = [mesh.get("filename", "") for mesh in urdf.iter("mesh")]
    meshes = {name: _mesh_path(path, name) for name in names}
    if missing := [name for name, file in meshes.items() if not file.is_file()]:
        raise MissingAsset(f"mesh {', '.join(missing)}", path.parent, path.name)
    for file in meshes.values():
        check_mesh(file)


def mesh_file(urdf: Path, mesh: Element) -> Path:
    """The file that a <mesh> names."""
    return _mesh_path(urdf, mesh.get("filename", ""))


def _mesh_path(urdf: Path, name: str) -> Path:
    return (urdf.parent / name.removeprefix("package://").removeprefix("file://")).resolve()


def _end(joint: Element, which: str) -> str:
    end = joint.find(which)
    return "" if end is None else end.get("link", "")


def _numbers(text: str) -> list[float]:
    return [float(word) for word in text.split()]


def _origin(element: Element) -> Array:
    origin = element.find("origin")
    if origin is None:
        return np.eye(4)
    return placed(_numbers(origin.get("xyz", "0 0 0")), _numbers(origin.get("rpy", "0 0 0")))


def _set_origin(element: Element, X: Array) -> None:
    origin = element.find("origin")
    if origin is None:
        origin = Element("origin")
        element.insert(0, origin)
    origin.set("xyz", _text(X[:3, 3]))
    origin.set("rpy", _text(rpy(X)))


def _text(values: Array) -> str:
    return " ".join(f"{v:.12g}" for v in np.round(values, 12) + 0.0)


def _inertial(link: Element, X: Array) -> tuple[float, Array, Array] | None:
    """Mass, first moment (3,) and second moment (3, 3) about the origin of the moving link."""
    stated = link.find("inertial")
    mass_of = None if stated is None else stated.find("mass")
    tensor_of = None if stated is None else stated.find("inertia")
    if stated is None or mass_of is None or tensor_of is None:
        return None
    mass, inertia = float(mass_of.get("value", "0")), np.zeros((3, 3))
    inertia[_ROWS, _COLUMNS] = [float(tensor_of.get(key, "0")) for key in _TENSOR]
    inertia[_COLUMNS, _ROWS] = inertia[_ROWS, _COLUMNS]
    at = X @ _origin(stated)
    inertia, com = at[:3, :3] @ inertia @ at[:3, :3].T, at[:3, 3]
    second = np.trace(inertia) / 2 * np.eye(3) - inertia
    return mass, mass * com, second + mass * np.outer(com, com)


def _sum(moments: Sequence[tuple[float, Array, Array] | None]) -> Element | None:
    known = [each for each in moments if each is not None]
    mass = total(each[0] for each in known)
    if mass <= 0:
        return None
    com = sum((each[1] for each in known), start=np.zeros(3)) / mass
    second = sum((each[2] for each in known), start=np.zeros((3, 3))) - mass * np.outer(com, com)
    inertia = np.trace(second) * np.eye(3) - second
    element = Element("inertial")
    SubElement(element, "origin", xyz=_text(com), rpy="0 0 0")
    SubElement(element, "mass", value=f"{mass:.9g}")
    tensor = inertia[_ROWS, _COLUMNS]
    SubElement(element, "inertia", {k: f"{v:.9g}" for k, v in zip(_TENSOR, tensor, strict=True)})
    return element
