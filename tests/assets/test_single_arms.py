"""Robots of two single arms: one URDF of both from a URDF of one, and what is refused."""

import shutil
import xml.etree.ElementTree as ElementTree
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import yaml

from rtphys.assets.embodiment import canonical, named_pair
from rtphys.assets.embodiment_file import read_embodiment, read_pair
from rtphys.assets.embodiments import EMBODIMENTS
from rtphys.assets.known_robots import PIPER
from rtphys.assets.pack import Pack
from rtphys.core.errors import BadFile, BadValue, MissingAsset, RtphysError, UnknownName
from rtphys.core.library import AmbiguousName

SINGLE = ("franka-panda", "piper")
JOINTS = {"franka-panda": 7, "piper": 6}


@pytest.fixture(scope="module")
def folders(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """The descriptions that the builtin pack writes, by name."""
    root = tmp_path_factory.mktemp("robots") / "embodiments"
    for name in SINGLE:
        EMBODIMENTS[name](root / name)
    return {name: root / name for name in SINGLE}


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))


@pytest.mark.parametrize("name", SINGLE)
def test_two_arms_stand_in_one_file(folders: dict[str, Path], name: str) -> None:
    robot = read_embodiment(folders[name])
    tree = ElementTree.parse(robot.urdf).getroot()
    joints = {j.get("name"): j for j in tree.findall("joint")}
    links = {link.get("name") for link in tree.findall("link")}
    fixed = [j for j, element in joints.items() if element.get("type") == "fixed"]
    assert sorted(map(str, fixed)) == ["left_mount", "right_mount"]  # the rest is folded away
    assert robot.action_layout.size == 2 * (JOINTS[name] + 1)
    for limb in robot.limbs:
        assert len(limb.joints) == JOINTS[name]
        assert {*limb.joints, *limb.finger_joints} <= joints.keys()
        assert {limb.ee.link, limb.camera.link} <= links
        assert (limb.limits[:, 0] <= limb.home).all() and (limb.home <= limb.limits[:, 1]).all()
        assert (limb.limits[:, 0] <= limb.bent).all() and (limb.bent <= limb.limits[:, 1]).all()
        assert limb.hand.tcp == 0.12  # RoboTwin's virtual wrist, of every robot
        assert limb.hand.finger_open == 0.04
    for mesh in tree.iter("mesh"):
        assert Path(mesh.get("filename", "")).is_file()


@pytest.mark.parametrize("name", SINGLE)
def test_folding_keeps_mass_and_its_centre(folders: dict[str, Path], name: str) -> None:
    def moments(urdf: Path) -> tuple[float, int]:
        links = ElementTree.parse(urdf).getroot().findall("link")
        masses = [float(m.get("value", "0")) for link in links for m in link.iter("mass")]
        return sum(masses), len(links)

    single, few = moments(next(folders[name].glob("*.urdf")))
    both, many = moments(read_embodiment(folders[name]).urdf)
    assert both == pytest.approx(2 * single, rel=1e-6)
    assert many < 2 * few


def test_the_distance_is_between_the_feet(folders: dict[str, Path]) -> None:
    def feet(distance: float | None) -> list[float]:
        piper = folders["piper"]
        tree = ElementTree.parse(read_pair(piper, piper, distance).urdf).getroot()
        mounts = [j for j in tree.findall("joint") if j.get("type") == "fixed"]
        origins = [mount.find("origin") for mount in mounts]
        return [float(str(o.get("xyz")).split()[0]) for o in origins if o is not None]

    assert feet(None) == [-0.25, 0.25]
    assert feet(0.7) == [-0.35, 0.35]


def test_names_of_pairs() -> None:
    assert named_pair("piper") == ("piper", "piper", None)
    assert named_pair(" piper, piper ,0.60") == ("piper", "piper", 0.6)
    assert canonical("piper, piper,0.60") == "piper,piper,0.6"
    assert canonical("piper, franka-panda,0.70") == "piper,franka-panda,0.7"
    for wrong in ("", "piper,piper", "a,b,0.6,1", "a,a,9", "a,a,nan", "../x", "a,../x,1", "a,a,b"):
        with pytest.raises(BadValue):
            canonical(wrong)


def test_two_arms_of_two_kinds(folders: dict[str, Path]) -> None:
    pack = Pack(folders["piper"].parents[1])
    mixed, piper, panda = map(pack.embodiment, ("piper,franka-panda,0.7", *reversed(SINGLE)))
    assert mixed.name == "piper,franka-panda,0.7"
    assert mixed.action_layout.size == 15
    assert mixed.action_layout.grippers == (6, 14)
    assert mixed.action_layout.arms == (slice(0, 6), slice(7, 14))
    assert mixed.action_layout.joints_alone == (slice(0, 6), slice(6, 13))
    assert mixed.action_layout.names[5:8] == ("left_joint_6", "left_gripper", "right_joint_1")
    assert str(mixed.action_layout).startswith("left arm 6 [rad]")
    for limb, own in ((mixed.left, piper.left), (mixed.right, panda.right)):
        assert (limb.joints, limb.hand, limb.drive) == (own.joints, own.hand, own.drive)
        np.testing.assert_array_equal(limb.limits, own.limits)
    tree = ElementTree.parse(mixed.urdf).getroot()
    fixed = {str(j.get("name")): j for j in tree.findall("joint") if j.get("type") == "fixed"}
    feet = [fixed[f"{side}_mount"].find("origin") for side in ("left", "right")]
    assert [str(o.get("xyz")).split()[0] for o in feet if o is not None] == ["-0.35", "0.35"]


def change(folder: Path, file: str, old: str, new: str) -> None:
    path = folder / file
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))


def add(folder: Path, line: str) -> None:
    with (folder / "config.yml").open("a") as file:
        file.write(f"\n{line}\n")


def renamed(source: Path, folder: Path) -> Path:
    """A copy of the Piper under a name of which nothing is known beforehand."""
    shutil.copytree(source, folder)
    add(folder, f"hand: {yaml.safe_dump(PIPER['hand'], default_flow_style=True)}")
    return folder


def test_a_name_that_begins_as_a_known_ones_is_another_robot(
    folders: dict[str, Path], tmp_path: Path
) -> None:
    folder = tmp_path / "piper_wide"
    shutil.copytree(folders["piper"], folder)
    with pytest.raises(BadFile, match="hand holds fingertip"):
        read_embodiment(folder)
    known = read_embodiment(folders["piper"]).left
    own = read_embodiment(renamed(folders["piper"], tmp_path / "piper-wide")).left
    assert known.limits[2].tolist() == [-2.697, 0.0]
    assert own.limits[2].tolist() != known.limits[2].tolist()
    assert own.bent.tolist() == own.home.tolist()


def test_an_error_says_which_keys_are_not_the_files(
    folders: dict[str, Path], tmp_path: Path
) -> None:
    folder = tmp_path / "piper"
    shutil.copytree(folders["piper"], folder)
    change(folder, "config.yml", "[[0, 0, 0, 0, 0, 0], [", "[[0, 0, 0, 0, 0], [")
    with pytest.raises(BadFile, match="it lacks bent_posture, hand, joint_limits, pair_distance, "):
        read_embodiment(folder)


def spoil_mesh(folder: Path, name: str) -> None:
    (folder / "meshes" / name).write_bytes(b"version https://git-lfs.github.com/spec/v1\n" * 9)


WIDE = [[-3.0, 3.0]] * 6


def without_limits(folder: Path) -> None:
    tree = ElementTree.parse(folder / "piper.urdf")
    joint = next(j for j in tree.getroot().findall("joint") if j.get("name") == "joint3")
    limit = joint.find("limit")
    assert limit is not None
    joint.remove(limit)
    tree.write(folder / "piper.urdf")


@pytest.mark.parametrize(
    ("spoil", "error", "says"),
    [
        (lambda f: change(f, "config.yml", '"joint6"]', '"joint9"]'), UnknownName, "joint9.*joint"),
        (lambda f: change(f, "config.yml", "link6", "link66"), UnknownName, "link66.*link6"),
        (lambda f: change(f, "config.yml", "joint8", "joint3"), BadFile, "joint3.*prismatic"),
        (without_limits, BadFile, "joint3.*no limits"),
        (lambda f: (f / "meshes" / "link2.glb").unlink(), MissingAsset, "link2.glb"),
        (lambda f: change(f, "config.yml", "palm:", "plam:"), BadFile, "hand holds fingertip"),
        (lambda f: change(f, "config.yml", "palm: 0", "palm: -0"), BadFile, "palm is -0.*0 to 0.3"),
        (lambda f: add(f, f"joint_limit: {WIDE}"), BadFile, "did you mean 'joint_limits'"),
        (
            lambda f: add(f, f"joint_limits: {[*WIDE[1:], [3, -3]]}"),
            BadFile,
            "lower, then an upper",
        ),
        (lambda f: add(f, f"joint_limits: {[[-170, 170]] * 6}"), BadFile, "in rad"),
        (lambda f: add(f, f"joint_limits: {[[0.5, 1]] * 6}"), BadFile, "homestate: joint 1 is 0,"),
        (lambda f: add(f, "bent_posture: [0, 9, 0, 0, 0, 0]"), BadFile, "bent_posture: joint 2"),
        (
            lambda f: change(
                f,
                "config.yml",
                "delta_matrix:",
                "delta_matrix: [[1, 0, 0], [0, 1, 0], [0, 1, 1]]\nold:",
            ),
            BadFile,
            "is no rotation",
        ),
        (lambda f: change(f, "config.yml", "homestate:", "home:"), BadFile, "homestate"),
        (lambda f: change(f, "config.yml", "[[0, 0, 0, 0, 0, 0]", "[[0]"), BadFile, "homestate"),
        (lambda f: change(f, "config.yml", '"./piper', '"./pipr'), MissingAsset, "pipr.urdf"),
        (lambda f: change(f, "piper.urdf", "<robot", "<rob"), BadFile, "is not XML"),
        (lambda f: change(f, "config.yml", "head_camera", "head"), BadValue, "'head'.*head_camera"),
        (
            lambda f: change(f, "config.yml", "static_camera_list", "static_cameras"),
            BadFile,
            "lacks the key 'static_camera_list'",
        ),
        (
            lambda f: change(f, "config.yml", "[0, 0.6, -0.8]", "[0, 0, 0]"),
            BadFile,
            "static_camera_list: forward",
        ),
        (
            lambda f: change(f, "config.yml", "0.707, 0, 0, 0.707", "0, 0, 0, 0"),
            BadValue,
            "config.yml: robot_pose = .*quaternion",
        ),
        (
            lambda f: change(
                f, "config.yml", "gripper_scale: [-0.01, 0.04]", "gripper_scale: [-10, 40]"
            ),
            BadValue,
            "config.yml: gripper_scale = .*up to 0.3 m",
        ),
        (
            lambda f: change(f, "config.yml", "joint_stiffness: 1000", "joint_stiffness: 0"),
            BadValue,
            "config.yml: joint_stiffness = 0 .*above 0",
        ),
        (
            lambda f: change(f, "config.yml", "joint_damping: 200", 'joint_damping: "200"'),
            BadValue,
            "joint_damping = '200'",
        ),
        (
            lambda f: change(f, "config.yml", "gripper_damping: 200", "gripper_damping: -1"),
            BadValue,
            "gripper_damping = -1",
        ),
        (lambda f: add(f, "pair_distance: -0.5"), BadValue, "pair_distance = -0.5 .*0 to 3 m"),
        (lambda f: add(f, "joint_armature: -0.35"), BadValue, "joint_armature = -0.35"),
        (lambda f: add(f, "joint_velocity: [1, 1, 0, 1, 1, 1]"), BadValue, "joint_velocity = "),
        (lambda f: spoil_mesh(f, "link7_0.stl"), BadFile, "link7_0.stl: is no readable mesh"),
        (lambda f: spoil_mesh(f, "link3.glb"), BadFile, "link3.glb: is no readable mesh"),
        (lambda f: change(f, "piper.urdf", 'link="link4"', 'link="link5"'), BadFile, "root links"),
    ],
)
def test_what_cannot_be_a_robot_is_refused_by_name(
    folders: dict[str, Path],
    tmp_path: Path,
    spoil: Callable[[Path], object],
    error: type[RtphysError],
    says: str,
) -> None:
    folder = renamed(folders["piper"], tmp_path / "embodiments" / "my-arm")
    read_embodiment(folder)
    spoil(folder)
    with pytest.raises(error, match=says):
        Pack(tmp_path).embodiment("my-arm")


def test_a_library_holds_robots(
    folders: dict[str, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pack = Pack(folders["piper"].parents[1])
    renamed(folders["piper"], tmp_path / "robots" / "piper-of-mine")
    monkeypatch.setenv("RTPHYS_LIBRARY", str(tmp_path))
    assert pack.embodiments == ("franka-panda", "piper", "piper-of-mine")
    assert pack.embodiment("piper-of-mine").action_layout.size == 14
    assert pack.embodiment("piper-of-mine,franka-panda,0.7").action_layout.size == 15
    with pytest.raises(UnknownName, match=r"'piper-of-me'.*did you mean 'piper-of-mine'"):
        pack.embodiment("piper-of-me")
    shutil.copytree(folders["piper"], tmp_path / "robots" / "piper")
    with pytest.raises(AmbiguousName, match="robot 'piper' exists twice"):
        pack.embodiment("piper")


def test_fingers_may_open_towards_smaller_numbers(folders: dict[str, Path], tmp_path: Path) -> None:
    folder = tmp_path / "piper"
    shutil.copytree(folders["piper"], folder)
    for joint in ("joint7", "joint8"):
        tree = ElementTree.parse(folder / "piper.urdf")
        element = next(j for j in tree.getroot().findall("joint") if j.get("name") == joint)
        axis, limit = element.find("axis"), element.find("limit")
        assert axis is not None and limit is not None
        axis.set("xyz", "0 0 1")
        limit.set("lower", "-0.04")
        limit.set("upper", "0")
        tree.write(folder / "piper.urdf")
    change(folder, "config.yml", "gripper_scale: [-0.01, 0.04]", "gripper_scale: [0.01, -0.04]")
    robot = read_embodiment(folder)
    assert robot.left.finger_signs == (-1.0, -1.0)
    hand = robot.left.hand
    assert (hand.finger_open, hand.finger_travel) == (0.04, 0.04)
    np.testing.assert_allclose(robot.left.finger_target(1.0), -0.04)
