"""A robot as the official `config.yml` describes it, with names turned into types."""

import xml.etree.ElementTree as ElementTree
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import cast

import numpy as np
from numpy.typing import NDArray

from rtphys.assets.action_layout import SIDES, ActionLayout
from rtphys.core.errors import BadFile, MissingAsset
from rtphys.core.library import read_yaml
from rtphys.core.poses import Pose

Array = NDArray[np.float64]

# What the official config of the aloha does not say. The config of another robot says it itself,
# under the same keys; without `joint_limits` those of its URDF hold.
# The official aloha URDF allows +-10 rad, which invites IK answers wound round by 2 pi.
# These are the ranges the arm really has and that its workspace was measured with [rad].
ALOHA_LIMITS = ((-2.6, 2.6), (0.0, 3.5), (0.0, 3.2), (-1.6, 1.6), (-1.6, 1.6), (-3.1, 3.1))
ALOHA_OPENING = (-0.01, 0.045)  # [m] finger joint at opening 0 and 1, for readers without a pack
ALOHA = {
    "joint_limits": [list(pair) for pair in ALOHA_LIMITS],
    "bent_posture": [0.0, 1.2, 1.0, -0.8, 0.0, 0.0],
    "joint_weights": [1.5, 1.5, 1.25, 1.0, 0.75, 0.5],
    # The arm's real servos reach about 3 rad/s; accelerations keep finger loads near 1 g.
    "joint_velocity": [2.5, 2.5, 2.5, 3.0, 3.0, 3.0],
    "joint_acceleration": [10.0, 10.0, 10.0, 12.0, 12.0, 14.0],
    # Inertia of the motors' rotors behind their gears, such as 3.5e-5 kg m^2 times 100 squared.
    # Without it a servo at rest presses with less than k * error, by 40 % at thrice the damping:
    # PhysX does not converge on a stiff drive of a light link. Less than 0.3 in the arm lets it
    # droop by over 1.1 JᵀF/k there; more than 0.4 moves its time constant by over 5 %.
    "joint_armature": 0.35,
    "gripper_armature": 0.1,
    "hand": {
        "fingertip": 0.0356,
        "pad_half_width": 0.0305,
        "pad_half_thickness": 0.01,
        "finger_travel": 0.0475,
    },
}


@dataclass(frozen=True)
class Hand:
    """Measures of a gripper with two fingers, in its ee frame [m].

    x is the approach direction, y the direction in which the fingers close.
    """

    tcp: float  # ee origin to the tool centre point (TCP), along x
    fingertip: float  # TCP to the fingertips, along x
    pad_half_width: float  # of a finger, along z
    pad_half_thickness: float  # of both closed fingers together, along y
    finger_open: float  # distance of each finger from closed when the gripper is open
    finger_travel: float  # greatest distance of a finger from closed

    @property
    def tip(self) -> float:
        """ee origin to the fingertips, along x."""
        return self.tcp + self.fingertip


@dataclass(frozen=True)
class Mimic:
    """A finger joint that follows the base finger: q = multiplier * q_base + offset."""

    joint: str
    multiplier: float
    offset: float


@dataclass(frozen=True, eq=False)
class Limb:
    """One arm with its gripper."""

    side: str  # "left" or "right"
    joints: tuple[str, ...]  # n, base to wrist
    ee_link: str
    ee_joint: str
    camera_link: str  # wrist camera
    gripper_joint: str  # base finger
    mimics: tuple[Mimic, ...]
    home: Array  # (n,) posture at the start of an episode [rad]
    limits: Array  # (n, 2) lower and upper angle [rad]
    # With the elbow up and the tool pitched down: most of the table is reached from there.
    bent: Array  # (n,) posture [rad]
    # Radians of one joint are not worth the same: the base swings the whole arm, the last joint
    # only turns the fingers. Used to say which of two postures is nearer.
    weights: Array  # (n,)
    velocity: Array  # (n,) largest in a planned motion [rad/s]
    acceleration: Array  # (n,) largest in a planned motion [rad/s^2]

    @property
    def finger_joints(self) -> tuple[str, ...]:
        """Base finger first, then those that follow it."""
        return (self.gripper_joint, *(m.joint for m in self.mimics))


@dataclass(frozen=True, eq=False)
class StaticCamera:
    """A camera fixed in the world: position [m], viewing and left directions."""

    name: str
    kind: str  # "D435" and the like
    position: Array
    forward: Array
    left: Array


@dataclass(frozen=True, eq=False)
class Embodiment:
    """A dual-arm robot: where its files are and how its joints are used."""

    name: str
    urdf: Path
    left: Limb
    right: Limb
    joint_stiffness: float  # [N m/rad]
    joint_damping: float  # [N m s/rad]
    gripper_stiffness: float  # [N/m]
    gripper_damping: float  # [N s/m]
    joint_armature: float  # [kg m^2] reflected rotor inertia of an arm joint
    gripper_armature: float  # [kg] the same of a finger joint
    hand: Hand  # the same on both arms
    gripper_scale: tuple[float, float]  # [m] finger joint target at g = 0 (closed) and g = 1 (open)
    bases: tuple[Pose, ...]  # world <- root link; one, or one an arm
    delta_matrix: Array  # (3, 3)
    global_trans_matrix: Array  # (3, 3)
    rotate_limits: tuple[float, float]  # [rad] range of tilted grasp candidates
    grasp_directions: tuple[str, str]  # preferred side approach of the left and right arm
    cameras: tuple[StaticCamera, ...]

    @property
    def limbs(self) -> tuple[Limb, Limb]:
        return self.left, self.right

    @property
    def action_layout(self) -> ActionLayout:
        """Where the commands of both arms stand in one vector."""
        return ActionLayout(len(self.left.joints))

    def finger_target(self, g: float) -> float:
        """Finger joint target [m] of a gripper command g in [0, 1]; 0 is closed."""
        closed, opened = self.gripper_scale
        return closed + g * (opened - closed)


def read_embodiment(folder: Path) -> Embodiment:
    """`<folder>/config.yml` and the URDF it names.

    Raises:
        MissingAsset: config or URDF is not there.
        BadFile: a key is missing or has the wrong form.
    """
    path = folder / "config.yml"
    if not path.is_file():
        raise MissingAsset(f"embodiment {folder.name!r}", path)
    config = read_yaml(path)
    if folder.name.startswith("aloha-agilex"):
        config = {**config, **ALOHA}
    try:
        urdf = folder / str(config["urdf_path"])
        if not urdf.is_file():
            raise MissingAsset(f"URDF of embodiment {folder.name!r}", urdf)
        return _embodiment(folder.name, urdf.resolve(), config)
    except (KeyError, IndexError, ValueError, TypeError) as problem:
        raise BadFile(path, f"not an embodiment description ({problem!r})") from problem


def _embodiment(name: str, urdf: Path, config: Mapping[str, object]) -> Embodiment:
    limits = _limits_of(urdf)
    limbs = [_limb(i, config, limits) for i in (0, 1)]
    if len(limbs[0].joints) != len(limbs[1].joints):
        raise ValueError("both arms need as many joints")
    closed, opened = _numbers(config["gripper_scale"])
    first, last = _numbers(config.get("rotate_lim", [0, 1]))
    near, far = [str(d) for d in _list(config["grasp_perfect_direction"])]
    poses = [_numbers(p) for p in _list(config["robot_pose"])]
    return Embodiment(
        name=name,
        urdf=urdf,
        left=limbs[0],
        right=limbs[1],
        joint_stiffness=_number(config["joint_stiffness"]),
        joint_damping=_number(config["joint_damping"]),
        gripper_stiffness=_number(config["gripper_stiffness"]),
        gripper_damping=_number(config["gripper_damping"]),
        joint_armature=_number(config["joint_armature"]),
        gripper_armature=_number(config["gripper_armature"]),
        hand=_hand(config),
        gripper_scale=(closed, opened),
        bases=tuple(Pose(p[:3], p[3:7]) for p in poses),
        delta_matrix=np.array(config["delta_matrix"], float),
        global_trans_matrix=np.array(config["global_trans_matrix"], float),
        rotate_limits=(first, last),
        grasp_directions=(near, far),
        cameras=tuple(_camera(c) for c in _list(config.get("static_camera_list", []))),
    )


_PER_JOINT = {  # field of `Limb` -> key of the config, a number a joint; both arms are alike
    "bent": "bent_posture",
    "weights": "joint_weights",
    "velocity": "joint_velocity",
    "acceleration": "joint_acceleration",
}


def _hand(config: Mapping[str, object]) -> Hand:
    measures = cast(Mapping[str, object], config["hand"])
    return Hand(
        tcp=_number(config["gripper_bias"]),
        fingertip=_number(measures["fingertip"]),
        pad_half_width=_number(measures["pad_half_width"]),
        pad_half_thickness=_number(measures["pad_half_thickness"]),
        finger_open=_numbers(config["gripper_scale"])[1],
        finger_travel=_number(measures["finger_travel"]),
    )


def _limb(i: int, config: Mapping[str, object], urdf_limits: dict[str, Array]) -> Limb:
    joints = tuple(str(j) for j in _list(_list(config["arm_joints_name"])[i]))
    gripper = cast(Mapping[str, object], _list(config["gripper_name"])[i])
    mimics = [_list(m) for m in _list(gripper["mimic"])]
    side, n = SIDES[i], len(joints)
    limits = config.get("joint_limits", [urdf_limits[joint].tolist() for joint in joints])
    return Limb(
        side=side,
        joints=joints,
        ee_link=str(_list(config["move_group"])[i]),
        ee_joint=str(_list(config["ee_joints"])[i]),
        camera_link=f"{side}_camera",
        gripper_joint=str(gripper["base"]),
        mimics=tuple(Mimic(str(m[0]), _number(m[1]), _number(m[2])) for m in mimics),
        home=np.array(_list(config["homestate"])[i], float).reshape(n),
        limits=np.array(limits, float).reshape(n, 2),
        **{
            field: np.array(_list(config[key]), float).reshape(n)
            for field, key in _PER_JOINT.items()
        },
    )


def _camera(entry: object) -> StaticCamera:
    c = cast(Mapping[str, object], entry)
    return StaticCamera(
        str(c["name"]),
        str(c.get("type", "D435")),
        *(np.array(c[key], float) for key in ("position", "forward", "left")),
    )


def _limits_of(urdf: Path) -> dict[str, Array]:
    """Joint name -> (lower, upper) as the URDF states them; unlimited is +-pi."""
    limits = {}
    for joint in ElementTree.parse(urdf).getroot().iter("joint"):
        limit = joint.find("limit")
        bounds = (-np.pi, np.pi)
        if limit is not None and joint.get("type") != "continuous":
            bounds = (float(limit.get("lower", "0")), float(limit.get("upper", "0")))
        limits[joint.get("name", "")] = np.array(bounds)
    return limits


def _list(value: object) -> Sequence[object]:
    if not isinstance(value, list):
        raise TypeError(f"expected a list, got {value!r}")
    return value


def _numbers(value: object) -> list[float]:
    return [_number(v) for v in _list(value)]


def _number(value: object) -> float:
    if not isinstance(value, int | float):
        raise TypeError(f"expected a number, got {value!r}")
    return float(value)
