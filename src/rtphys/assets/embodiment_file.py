"""Reads a robot from the official `config.yml` and the URDF that it names.

A config with `dual_arm: true` names one URDF of both arms. Any other names the URDF of one arm,
of which two stand side by side: this writes the URDF of both into the cache.
"""

import hashlib
import tempfile
from pathlib import Path

import numpy as np

from rtphys.assets.action_layout import SIDES
from rtphys.assets.embodiment import Embodiment, Limb, Mount, NamedPair
from rtphys.assets.identity import cache_folder
from rtphys.assets.pair_urdf import ArmUrdf, check_meshes, joint_limits, pair_urdf, parsed_urdf
from rtphys.assets.robot_config import ArmNames, Array, RobotConfig
from rtphys.core.cache import reading_cache, writing_cache
from rtphys.core.errors import BadValue
from rtphys.core.poses import Pose


def read_embodiment(folder: Path) -> Embodiment:
    """`<folder>/config.yml` and the URDF it names.

    Raises:
        MissingAsset: config, URDF or a mesh is not there.
        BadFile: a key is missing or has the wrong form, or a mesh is none.
        BadValue: a number that no robot has, or no head camera.
        UnknownName: a joint or link that the URDF lacks.
    """
    config = RobotConfig.read(folder)
    if config.has_both_arms:
        with config.described():
            return _dual(config)
    return read_pair(folder, folder)


def read_pair(left: Path, right: Path, distance: float | None = None) -> Embodiment:
    """Two single arms side by side, each of a folder as in `read_embodiment`.

    The cameras that are fixed in the world are those that the left one's config states.

    Args:
        distance: between their bases [m]; None: as the left one's config says.

    Raises:
        BadValue: as `read_embodiment`; one of them has both arms in one URDF.
        MissingAsset, BadFile, UnknownName: as `read_embodiment`.
    """
    folders = (left, right)
    configs = {folder: RobotConfig.read(folder) for folder in folders}
    for folder, config in configs.items():
        if config.has_both_arms:
            raise BadValue("embodiment", folder.name, "it has both arms, and no distance")
    arms, apart = list[Limb](), distance
    parsed: dict[Path, ArmUrdf] = {}
    placed: list[tuple[str, ArmUrdf, Array]] = []
    for i, (side, folder) in enumerate(zip(SIDES, folders, strict=True)):
        with (config := configs[folder]).described():
            apart = config.distance if apart is None else apart
            if folder not in parsed:
                parsed[folder] = ArmUrdf(config.urdf)
            arms.append(_single(config, parsed[folder], i))
            base = config.pose(i)
            shift = np.array([(i - 0.5) * apart, 0.0, 0.0])
            placed.append((side, parsed[folder], Pose(base.p + shift, base.q).matrix))
    with configs[left].described():
        cameras = configs[left].cameras
    urdf = _cached("-".join(folder.name for folder in configs), pair_urdf(placed))
    name = str(NamedPair(left.name, right.name, distance))
    return Embodiment(name, urdf, Pose(), arms[0], arms[1], cameras)


def _dual(config: RobotConfig) -> Embodiment:
    urdf = config.urdf
    tree = parsed_urdf(urdf)
    check_meshes(urdf, tree)
    joints = {joint.get("name", ""): joint for joint in tree.findall("joint")}
    arms = list[Limb]()
    for i, side in enumerate(SIDES):
        own, fingers = config.joint_names(i)
        limits = {joint: joint_limits(urdf, joints, joint) for joint in own}
        limits |= {joint: joint_limits(urdf, joints, joint, "prismatic") for joint in fingers}
        names = ArmNames("", limits, Mount(config.move_group(i)), Mount(f"{side}_camera"))
        arms.append(config.limb(i, names))
    return Embodiment(config.folder.name, urdf, config.pose(0), arms[0], arms[1], config.cameras)


def _single(config: RobotConfig, arm: ArmUrdf, i: int) -> Limb:
    """Arm i of a pair, 0 the left."""
    joints, fingers = config.joint_names(i)
    limits = {joint: arm.limits(joint) for joint in joints}
    limits |= {joint: arm.limits(joint, "prismatic") for joint in fingers}
    prefix = f"{SIDES[i]}_"
    link, X = arm.mount(config.move_group(i))
    ee = Mount(prefix + link, Pose.from_matrix(X @ config.virtual_ee()))
    link, X = arm.mount(config.camera_link)
    camera = Mount(prefix + link, Pose.from_matrix(X))
    return config.limb(i, ArmNames(prefix, limits, ee, camera))


def _cached(name: str, text: str) -> Path:
    """A file of this text in the cache; its name is its content's."""
    folder = cache_folder() / "pairs"
    path = folder / f"{name}-{hashlib.sha256(text.encode()).hexdigest()[:16]}.urdf"
    with reading_cache():
        if path.is_file():
            return path
    with writing_cache():
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=folder) as scratch:
            new = Path(scratch) / path.name
            new.write_text(text, encoding="utf-8")
            new.replace(path)
    return path
