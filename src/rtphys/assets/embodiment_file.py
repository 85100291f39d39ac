"""Reads a robot from the official `config.yml` and the URDF that it names.

A config with `dual_arm: true` names one URDF of both arms. Any other names the URDF of one arm,
of which two stand side by side: this writes the URDF of both into the cache.
"""

import hashlib
import os
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rtphys.assets.action_layout import SIDES
from rtphys.assets.embodiment import (
    Embodiment,
    Hand,
    Limb,
    Mimic,
    Mount,
    StaticCamera,
    canonical,
)
from rtphys.assets.identity import cache_folder
from rtphys.assets.known_robots import KNOWN
from rtphys.assets.pair_urdf import ArmUrdf, check_meshes, joint_limits, pair_urdf, parsed_urdf
from rtphys.core.errors import BadFile, BadValue, MissingAsset
from rtphys.core.library import read_yaml
from rtphys.core.poses import Pose

Array = NDArray[np.float64]
Config = Mapping[str, object]

# Inertia of the motors' rotors behind their gears, such as 3.5e-5 kg m^2 times 100 squared.
# Without it a servo at rest presses with less than k * error, by 40 % at thrice the damping:
# PhysX does not converge on a stiff drive of a light link. Less than 0.3 in the arm lets it
# droop by over 1.1 JᵀF/k there; more than 0.4 moves its time constant by over 5 %.
JOINT_ARMATURE, GRIPPER_ARMATURE = 0.35, 0.1
VELOCITY, ACCELERATION = 2.5, 10.0  # [rad/s], [rad/s^2] of arms whose config states none
DISTANCE = 0.6  # [m] between the bases of two arms whose config states none (RoboTwin)
MEASURES = ("fingertip", "palm", "pad_half_width", "pad_half_thickness")
VIRTUAL_TCP = 0.12  # [m] from the ee frame to the TCP, of every robot of two arms (RoboTwin)


def read_embodiment(folder: Path, distance: float | None = None) -> Embodiment:
    """`<folder>/config.yml` and the URDF it names.

    Args:
        distance: between the bases of two arms [m]; None: as the config says.

    Raises:
        MissingAsset: config, URDF or a mesh is not there.
        BadFile: a key is missing or has the wrong form.
        UnknownName: a joint or link that the URDF lacks.
        BadValue: a distance for a robot that has both arms in one URDF.
    """
    path = folder / "config.yml"
    if not path.is_file():
        raise MissingAsset(f"embodiment {folder.name!r}", path)
    config = cast(Config, read_yaml(path))
    for name, unsaid in KNOWN.items():
        if folder.name.startswith(name):
            config = {**unsaid, **config}
    try:
        urdf = folder / str(config["urdf_path"])
        if not urdf.is_file():
            raise MissingAsset(f"URDF of embodiment {folder.name!r}", urdf)
        if config.get("dual_arm", False):
            if distance is not None:
                raise BadValue("embodiment", f"{folder.name}, {distance:g} m", "it has both arms")
            return _dual(folder.name, urdf.resolve(), config)
        return _pair(folder.name, ArmUrdf(urdf.resolve()), config, distance)
    except KeyError as problem:
        raise BadFile(path, f"lacks the key {problem}") from problem
    except (IndexError, ValueError, TypeError) as problem:
        raise BadFile(path, f"not an embodiment description ({problem})") from problem


@dataclass(frozen=True, eq=False)
class _Names:
    """Where one arm's joints and frames are."""

    prefix: str
    limits: Mapping[str, tuple[float, float]]  # by the joint's name in the config
    ee: Mount
    camera: Mount


def _dual(name: str, urdf: Path, config: Config) -> Embodiment:
    tree = parsed_urdf(urdf)
    check_meshes(urdf, tree)
    joints = {joint.get("name", ""): joint for joint in tree.findall("joint")}
    arms = []
    for i, side in enumerate(SIDES):
        own, fingers = _joint_names(config, i)
        limits = {joint: joint_limits(urdf, joints, joint) for joint in own}
        limits |= {joint: joint_limits(urdf, joints, joint, "prismatic") for joint in fingers}
        ee = Mount(str(_list(config["move_group"])[i]))
        arms.append(_limb(i, config, _Names("", limits, ee, Mount(f"{side}_camera"))))
    (base,) = [_numbers(pose) for pose in _list(config["robot_pose"])]
    return _embodiment(name, (urdf, Pose(base[:3], base[3:7])), config, arms)


def _pair(name: str, arm: ArmUrdf, config: Config, distance: float | None) -> Embodiment:
    apart = _number(config.get("pair_distance", DISTANCE)) if distance is None else distance
    poses = [_numbers(pose) for pose in _list(config["robot_pose"])]
    arms, placed = [], []
    for i, side in enumerate(SIDES):
        joints, fingers = _joint_names(config, i)
        limits = {joint: arm.limits(joint) for joint in joints}
        limits |= {joint: arm.limits(joint, "prismatic") for joint in fingers}
        link, X = arm.mount(str(_list(config["move_group"])[i]))
        ee = Mount(f"{side}_{link}", Pose.from_matrix(X @ _virtual(config)))
        link, X = arm.mount(str(config.get("camera_link", "camera")))
        names = _Names(f"{side}_", limits, ee, Mount(f"{side}_{link}", Pose.from_matrix(X)))
        arms.append(_limb(i, config, names))
        base = poses[min(i, len(poses) - 1)]
        shift = np.array([(i - 0.5) * apart, 0.0, 0.0])
        placed.append((side, arm, Pose(base[:3] + shift, base[3:7]).matrix))
    text = pair_urdf(placed)
    full = name if distance is None else canonical(f"{name},{name},{distance}")
    return _embodiment(full, (_cached(name, text), Pose()), config, arms)


def _virtual(config: Config) -> Array:
    """ee frame (4, 4) in the link of the config's `move_group`."""
    X = np.eye(4)
    X[:3, :3] = np.array(config["delta_matrix"], float).reshape(3, 3)
    X[:3, 3] = (_number(config["gripper_bias"]) - VIRTUAL_TCP) * X[:3, 0]
    return X


def _cached(name: str, text: str) -> Path:
    """A file of this text in the cache; its name is its content's."""
    folder = cache_folder() / "pairs"
    path = folder / f"{name}-{hashlib.sha256(text.encode()).hexdigest()[:16]}.urdf"
    if not path.is_file():
        folder.mkdir(parents=True, exist_ok=True)
        handle, scratch = tempfile.mkstemp(dir=folder, suffix=".tmp")
        with os.fdopen(handle, "w", encoding="utf-8") as file:
            file.write(text)
        Path(scratch).replace(path)
    return path


def _embodiment(
    name: str, model: tuple[Path, Pose], config: Config, arms: Sequence[tuple[Limb, float]]
) -> Embodiment:
    """The robot of a URDF and its root's pose, and of each arm and how far its fingers open."""
    (left, travel), (right, _) = arms
    if len(left.joints) != len(right.joints):
        raise ValueError("both arms need as many joints")
    closed, opened = _numbers(config["gripper_scale"])
    # Official configs of single arms spell it without the last s.
    stiffness = config.get("gripper_stiffness", config.get("gripper_stiffnes"))
    return Embodiment(
        name=name,
        urdf=model[0],
        base=model[1],
        left=left,
        right=right,
        joint_stiffness=_number(config["joint_stiffness"]),
        joint_damping=_number(config["joint_damping"]),
        gripper_stiffness=_number(stiffness, "gripper_stiffness"),
        gripper_damping=_number(config["gripper_damping"]),
        joint_armature=_number(config.get("joint_armature", JOINT_ARMATURE)),
        gripper_armature=_number(config.get("gripper_armature", GRIPPER_ARMATURE)),
        hand=_hand(config, travel),
        gripper_scale=(closed, opened),
        cameras=tuple(_camera(c) for c in _list(config.get("static_camera_list", []))),
    )


def _joint_names(config: Config, i: int) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The joints of an arm, and those of its fingers, as the config names them."""
    arm = tuple(str(joint) for joint in _list(_list(config["arm_joints_name"])[i]))
    gripper = cast(Config, _list(config["gripper_name"])[i])
    mimics = [str(_list(mimic)[0]) for mimic in _list(gripper["mimic"])]
    return arm, (str(gripper["base"]), *mimics)


_PER_JOINT = {  # field of `Limb` -> key of the config, a number a joint; both arms are alike
    "bent": "bent_posture",
    "weights": "joint_weights",
    "velocity": "joint_velocity",
    "acceleration": "joint_acceleration",
}


def _limb(i: int, config: Config, names: _Names) -> tuple[Limb, float]:
    """One arm, and how far from closed its fingers can go [m]."""
    joints, fingers = _joint_names(config, i)
    n, prefix = len(joints), names.prefix
    gripper = cast(Config, _list(config["gripper_name"])[i])
    mimics = [_list(mimic) for mimic in _list(gripper["mimic"])]
    closed, opened = _numbers(config["gripper_scale"])
    factors = [1.0, *(_number(mimic[1]) for mimic in mimics)]
    signs = tuple(float(np.sign((opened - closed) * factor)) for factor in factors)
    ends = [abs(limit) for finger in fingers for limit in names.limits[finger]]
    # Some official URDFs allow +-10 rad, which invites IK answers wound round by 2 pi.
    limits = np.clip([names.limits[joint] for joint in joints], -np.pi, np.pi)
    limits = _per_joint(config.get("joint_limits", limits), (n, 2), "joint_limits")
    home = _per_joint(_list(config["homestate"])[i], (n,), "homestate")
    preset: Config = {
        "bent_posture": home,
        "joint_weights": np.linspace(1.5, 0.5, n),
        "joint_velocity": np.full(n, VELOCITY),
        "joint_acceleration": np.full(n, ACCELERATION),
    }
    limb = Limb(
        side=SIDES[i],
        joints=tuple(prefix + joint for joint in joints),
        ee=names.ee,
        camera=names.camera,
        gripper_joint=prefix + fingers[0],
        mimics=tuple(Mimic(prefix + str(m[0]), _number(m[1]), _number(m[2])) for m in mimics),
        finger_signs=signs,
        home=home,
        limits=limits,
        **{
            field: _per_joint(config.get(key, preset[key]), (n,), key)
            for field, key in _PER_JOINT.items()
        },
    )
    return limb, max(ends)


def _hand(config: Config, travel: float) -> Hand:
    measures = config.get("hand")
    if not isinstance(measures, Mapping) or not {*MEASURES} <= {*measures}:
        raise ValueError(f"hand holds {', '.join(MEASURES)} [m]; see docs/robots.md")
    tcp = _number(config["gripper_bias"]) if config.get("dual_arm", False) else VIRTUAL_TCP
    travel = _number(measures.get("finger_travel", travel))
    opened = abs(_numbers(config["gripper_scale"])[1])
    return Hand(
        tcp=tcp,
        fingertip=_number(measures["fingertip"]),
        pad_half_width=_number(measures["pad_half_width"]),
        pad_half_thickness=_number(measures["pad_half_thickness"]),
        finger_open=min(opened, travel),
        finger_travel=travel,
        palm=_number(measures["palm"]),
    )


def _camera(entry: object) -> StaticCamera:
    c = cast(Config, entry)
    return StaticCamera(
        str(c["name"]),
        str(c.get("type", "D435")),
        *(np.array(c[key], float) for key in ("position", "forward", "left")),
    )


def _per_joint(value: object, shape: tuple[int, ...], key: str) -> Array:
    numbers = np.array(cast(ArrayLike, value), float)
    if numbers.shape != shape or not np.isfinite(numbers).all():
        raise ValueError(f"{key} is no array of shape {shape}")
    return numbers


def _list(value: object) -> Sequence[object]:
    if not isinstance(value, list):
        raise TypeError(f"expected a list, got {value!r}")
    return value


def _numbers(value: object) -> list[float]:
    return [_number(v) for v in _list(value)]


def _number(value: object, key: str = "") -> float:
    if value is None and key:
        raise KeyError(key)
    if not isinstance(value, int | float):
        raise TypeError(f"expected a number, got {value!r}")
    return float(value)
