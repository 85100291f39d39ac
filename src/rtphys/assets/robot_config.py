"""A robot's `config.yml`: what it says of each arm, and of the feet and cameras."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rtphys.assets.action_layout import SIDES
from rtphys.assets.embodiment import Drive, Hand, Limb, Mimic, Mount, StaticCamera
from rtphys.assets.known_robots import KNOWN
from rtphys.assets.pair_urdf import JointRange
from rtphys.core.errors import BadFile, BadValue, MissingAsset
from rtphys.core.library import read_yaml
from rtphys.core.poses import Pose

Array = NDArray[np.float64]

# Inertia of the motors' rotors behind their gears, such as 3.5e-5 kg m^2 times 100 squared.
# Without it a servo at rest presses with less than k * error, by 40 % at thrice the damping:
# PhysX does not converge on a stiff drive of a light link. Less than 0.3 in the arm lets it
# droop by over 1.1 JᵀF/k there; more than 0.4 moves its time constant by over 5 %.
JOINT_ARMATURE, GRIPPER_ARMATURE = 0.35, 0.1
VELOCITY, ACCELERATION = 2.5, 10.0  # [rad/s], [rad/s^2] of arms whose config states none
DISTANCE = 0.6  # [m] between the bases of two arms whose config states none (RoboTwin)
MEASURES = ("fingertip", "palm", "pad_half_width", "pad_half_thickness")
VIRTUAL_TCP = 0.12  # [m] from the ee frame to the TCP, of every robot of two arms (RoboTwin)
HEAD_CAMERA = "head_camera"  # that the fixed cameras need: episodes draw and move it
SLACK = 1e-3  # [rad] by which a posture may be beyond a limit, which has few digits
WIDEST = 3.0  # [m] between two arms
FURTHEST = 0.3  # [m] of a hand's measures; more is most likely in millimetres
OWN_KEYS = (  # beyond RoboTwin's
    "bent_posture", "camera_link", "gripper_armature", "hand", "joint_acceleration",
    "joint_armature", "joint_limits", "joint_velocity", "joint_weights", "pair_distance",
)  # fmt: skip
_PER_JOINT = {  # field of `Limb` -> key of the config, a number a joint; both arms are alike
    "bent": "bent_posture",
    "weights": "joint_weights",
    "velocity": "joint_velocity",
    "acceleration": "joint_acceleration",
}


@dataclass(frozen=True, eq=False)
class ArmNames:
    """Where one arm's joints and frames are."""

    prefix: str  # before the names of its joints
    ranges: Mapping[str, JointRange]  # by the joint's name in the config
    ee: Mount
    camera: Mount


@dataclass(frozen=True, eq=False)
class RobotConfig:
    """The keys of `<folder>/config.yml`, and those that are known of such a robot beforehand.

    Its methods raise `BadValue`, and `KeyError`, `IndexError`, `TypeError` and `ValueError`, of
    which `described` makes a `BadFile`.
    """

    folder: Path
    keys: Mapping[str, object]
    assumed: tuple[str, ...] = ()  # those of `keys` that the file lacks, known by its folder's name

    @classmethod
    def read(cls, folder: Path) -> "RobotConfig":
        """Raises `MissingAsset`, `BadFile`."""
        path = folder / "config.yml"
        if not path.is_file():
            raise MissingAsset(f"embodiment {folder.name!r}", path)
        keys = read_yaml(path)
        for key in {*keys} - {*OWN_KEYS}:  # RoboTwin's are none of ours, nor like them
            if near := get_close_matches(key, OWN_KEYS, 1, 0.85):
                raise BadFile(path, f"has the unknown key {key!r}; did you mean {near[0]!r}?")
        known = KNOWN.get(folder.name, {})
        return cls(folder, {**known, **keys}, tuple(sorted({*known} - {*keys})))

    @contextmanager
    def described(self) -> Iterator[None]:
        """Raises `BadFile` in place of what a wrong or missing key raises."""
        path = self.path
        try:
            yield
        except KeyError as problem:
            raise BadFile(path, f"lacks the key {problem}") from problem
        except (IndexError, ValueError, TypeError) as problem:
            text = f"not an embodiment description ({problem})"
            if self.assumed:
                keys = ", ".join(self.assumed)
                text += f"; it lacks {keys}, taken from RoboTwin's robot of this folder's name"
            raise BadFile(path, text) from problem

    @property
    def path(self) -> Path:
        """The file."""
        return self.folder / "config.yml"

    @property
    def has_both_arms(self) -> bool:
        """Whether its URDF is of two arms."""
        return bool(self.keys.get("dual_arm", False))

    @property
    def urdf(self) -> Path:
        """The URDF that it names. Raises `MissingAsset`."""
        urdf = self.folder / str(self.keys["urdf_path"])
        if not urdf.is_file():
            raise MissingAsset(f"URDF of embodiment {self.folder.name!r}", urdf)
        return urdf.resolve()

    @property
    def distance(self) -> float:
        """Between the bases of two single arms [m]. Raises `BadValue`."""
        number = _number(self.keys.get("pair_distance", DISTANCE))
        if not 0 <= number <= WIDEST:
            raise BadValue("pair_distance", number, f"it is 0 to {WIDEST:g} m", self.path)
        return number

    @property
    def gripper_scale(self) -> tuple[float, float]:
        """Targets of a finger joint at 0 (closed) and at 1 (open) [m]. Raises `BadValue`."""
        closed, opened = _numbers(self.keys["gripper_scale"])
        if max(abs(closed), abs(opened)) > FURTHEST or closed == opened:
            allowed = f"closed and open, up to {FURTHEST} m from 0, not the same"
            raise BadValue("gripper_scale", [closed, opened], allowed, self.path)
        return closed, opened

    @property
    def camera_link(self) -> str:
        """The link that carries the wrist camera of a single arm."""
        return str(self.keys.get("camera_link", "camera"))

    @property
    def cameras(self) -> tuple[StaticCamera, ...]:
        """The cameras fixed in the world."""
        key = "static_camera_list"
        found = tuple(_camera(c) for c in _list(self.keys[key]))
        if HEAD_CAMERA not in (names := [camera.name for camera in found]):
            raise BadValue(key, names, f"one of them is the {HEAD_CAMERA}", self.path)
        return found

    def pose(self, i: int) -> Pose:
        """Where arm i stands, 0 the left, before both are moved apart; or the robot of both."""
        poses = _list(self.keys["robot_pose"])
        numbers = _array(poses[min(i, len(poses) - 1)], (7,), "robot_pose")
        if np.linalg.norm(numbers[3:]) < 0.1:
            allowed = "its last four are a quaternion wxyz, of length 1"
            raise BadValue("robot_pose", numbers.tolist(), allowed, self.path)
        return Pose(numbers[:3], numbers[3:])

    def move_group(self, i: int) -> str:
        """The last link of arm i."""
        return str(_list(self.keys["move_group"])[i])

    def virtual_ee(self) -> Array:
        """ee frame (4, 4) of a single arm in the link of its `move_group`."""
        X = np.eye(4)
        X[:3, :3] = R = np.array(self.keys["delta_matrix"], float).reshape(3, 3)
        if not np.allclose(R @ R.T, np.eye(3), atol=1e-3) or np.linalg.det(R) < 0:
            raise ValueError(f"delta_matrix {R.tolist()} is no rotation")
        X[:3, 3] = (_number(self.keys["gripper_bias"]) - VIRTUAL_TCP) * X[:3, 0]
        return X

    def joint_names(self, i: int) -> tuple[tuple[str, ...], tuple[str, ...]]:
        """The joints of arm i, and those of its fingers, as the config names them."""
        arm = tuple(str(joint) for joint in _list(_list(self.keys["arm_joints_name"])[i]))
        gripper = self._gripper(i)
        mimics = [str(_list(mimic)[0]) for mimic in _list(gripper["mimic"])]
        return arm, (str(gripper["base"]), *mimics)

    def limb(self, i: int, names: ArmNames) -> Limb:
        """Arm i, 0 the left."""
        joints, fingers = self.joint_names(i)
        n, prefix = len(joints), names.prefix
        mimics = [_list(mimic) for mimic in _list(self._gripper(i)["mimic"])]
        closed, opened = self.gripper_scale
        factors = [1.0, *(_number(mimic[1]) for mimic in mimics)]
        # Some official URDFs allow +-10 rad, which invites IK answers wound round by 2 pi.
        limits = np.clip([names.ranges[joint][:2] for joint in joints], -np.pi, np.pi)
        home = _array(_list(self.keys["homestate"])[i], (n,), "homestate")
        limits = _array(self.keys.get("joint_limits", limits), (n, 2), "joint_limits")
        postures = self._per_joint(home)
        self._check_limits(limits, home, postures["bent"])
        drive, gripper_drive = self._drives()
        return Limb(
            side=SIDES[i],
            joints=tuple(prefix + joint for joint in joints),
            ee=names.ee,
            camera=names.camera,
            gripper_joint=prefix + fingers[0],
            mimics=tuple(Mimic(prefix + str(m[0]), _number(m[1]), _number(m[2])) for m in mimics),
            finger_signs=tuple(float(np.sign((opened - closed) * factor)) for factor in factors),
            home=home,
            limits=limits,
            drive=drive,
            gripper_drive=gripper_drive,
            gripper_scale=(closed, opened),
            effort=np.array([names.ranges[joint].effort for joint in joints]),
            finger_effort=min(names.ranges[finger].effort for finger in fingers),
            hand=self._hand(
                max(abs(end) for finger in fingers for end in names.ranges[finger][:2])
            ),
            **postures,
        )

    def _check_limits(self, limits: Array, home: Array, bent: Array) -> None:
        """Limits that are stated, and postures beside those of the URDF. Raises `ValueError`."""
        low, high = limits.T
        if "joint_limits" in self.keys:
            if (low >= high).any() or np.abs(limits).max() > 2 * np.pi:
                rule = "each is a lower, then an upper bound, in rad and at most 2 pi"
                raise ValueError(f"joint_limits {limits.tolist()}: {rule}")
            _check_within(home, limits, "homestate")
        if "bent_posture" in self.keys:
            _check_within(bent, limits, "bent_posture")

    def _gripper(self, i: int) -> Mapping[str, object]:
        return cast(Mapping[str, object], _list(self.keys["gripper_name"])[i])

    def _per_joint(self, home: Array) -> dict[str, Array]:
        n = len(home)
        preset = {
            "bent_posture": home,
            "joint_weights": np.linspace(1.5, 0.5, n),
            "joint_velocity": np.full(n, VELOCITY),
            "joint_acceleration": np.full(n, ACCELERATION),
        }
        found = {key: _array(self.keys.get(key, preset[key]), (n,), key) for key in preset}
        for key in ("joint_velocity", "joint_acceleration"):
            if not (found[key] > 0).all():
                raise BadValue(key, found[key].tolist(), "each is above 0", self.path)
        return {field: found[key] for field, key in _PER_JOINT.items()}

    def _drives(self) -> tuple[Drive, Drive]:
        """Of the arm's joints and of its fingers."""
        # Official configs of single arms spell it without the last s.
        spelt = "gripper_stiffness", "gripper_stiffnes"
        stiffness = next((key for key in spelt if key in self.keys), spelt[0])
        arm = Drive(
            self._gain("joint_stiffness", positive=True),
            self._gain("joint_damping"),
            self._gain("joint_armature", JOINT_ARMATURE),
        )
        fingers = Drive(
            self._gain(stiffness, positive=True),
            self._gain("gripper_damping"),
            self._gain("gripper_armature", GRIPPER_ARMATURE),
        )
        return arm, fingers

    def _gain(self, key: str, default: float | None = None, *, positive: bool = False) -> float:
        value = self.keys[key] if default is None else self.keys.get(key, default)
        number = _number(value) if isinstance(value, int | float) else np.nan
        if not (0 < number < np.inf or (number == 0 and not positive)):
            allowed = "it is a number above 0" if positive else "it is a number, 0 or above"
            raise BadValue(key, value, allowed, self.path)
        return number

    def _hand(self, travel: float) -> Hand:
        measures = self.keys.get("hand")
        if not isinstance(measures, Mapping) or not {*MEASURES} <= {*measures}:
            raise ValueError(f"hand holds {', '.join(MEASURES)} [m]; see docs/robots.md")
        tcp = _number(self.keys["gripper_bias"]) if self.has_both_arms else VIRTUAL_TCP
        travel = _number(measures.get("finger_travel", travel))
        opened = abs(self.gripper_scale[1])
        lengths = {name: _number(measures[name]) for name in MEASURES}
        for name, length in lengths.items():
            if not 0 <= length <= FURTHEST:
                raise ValueError(f"hand: {name} is {length:g} m; it is 0 to {FURTHEST} m")
        return Hand(
            tcp=tcp,
            finger_open=min(opened, travel),
            finger_travel=travel,
            **lengths,
        )


def _camera(entry: object) -> StaticCamera:
    c = cast(Mapping[str, object], entry)
    position, forward, left = (
        _array(c[key], (3,), f"static_camera_list: {key}")
        for key in ("position", "forward", "left")
    )
    if not np.cross(forward, left).any():
        raise ValueError("static_camera_list: forward and left are not two directions")
    return StaticCamera(str(c["name"]), str(c.get("type", "D435")), position, forward, left)


def _array(value: object, shape: tuple[int, ...], key: str) -> Array:
    numbers = np.array(cast(ArrayLike, value), float)
    if numbers.shape != shape or not np.isfinite(numbers).all():
        raise ValueError(f"{key} is no array of shape {shape}")
    return numbers


def _check_within(posture: Array, limits: Array, key: str) -> None:
    low, high = limits.T
    outside = np.flatnonzero((posture < low - SLACK) | (posture > high + SLACK))
    for k in outside:
        bounds = f"{low[k]:.4g} to {high[k]:.4g} rad"
        raise ValueError(f"{key}: joint {k + 1} is {posture[k]:.4g}, its limits are {bounds}")


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
