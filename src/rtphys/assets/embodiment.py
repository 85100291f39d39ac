"""A robot of two arms: where its files are, how its joints are used, what its hands measure."""

from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rtphys.assets.action_layout import ActionLayout
from rtphys.core.errors import BadValue
from rtphys.core.poses import Pose
from rtphys.core.untrusted import plain_name

Array = NDArray[np.float64]

DEFAULT = "aloha-agilex"

# The official aloha URDF allows +-10 rad, which invites IK answers wound round by 2 pi.
# These are the ranges the arm really has and that its workspace was measured with [rad].
ALOHA_LIMITS = ((-2.6, 2.6), (0.0, 3.5), (0.0, 3.2), (-1.6, 1.6), (-1.6, 1.6), (-3.1, 3.1))
ALOHA_OPENING = (-0.01, 0.045)  # [m] finger joint at opening 0 and 1, for readers without a pack


@dataclass(frozen=True)
class Hand:
    """Measures of a gripper with two fingers, in its ee frame [m].

    x is the approach direction, y the direction in which the fingers close.

    Attributes:
        tcp: from the ee origin to the tool centre point (TCP), along x.
        fingertip: from the TCP to the fingertips, along x.
        pad_half_width: half a finger's extent along z.
        pad_half_thickness: half that of both closed fingers together, along y.
        finger_open: distance of each finger from closed when the gripper is open.
        finger_travel: greatest distance of a finger from closed.
        palm: from the TCP back to the palm, along x: a thing between the fingers reaches no deeper.
    """

    tcp: float
    fingertip: float
    pad_half_width: float
    pad_half_thickness: float
    finger_open: float
    finger_travel: float
    palm: float

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


@dataclass(frozen=True)
class Drive:
    """Nominal gains of the servos of a kind of joint."""

    stiffness: float  # [N m/rad], of a finger [N/m]
    damping: float  # [N m s/rad], of a finger [N s/m]
    armature: float  # [kg m^2] reflected rotor inertia, of a finger [kg]


@dataclass(frozen=True, eq=False)
class Mount:
    """A frame that a link carries."""

    link: str
    offset: Pose | None = None  # link <- frame; None: the link's own frame


@dataclass(frozen=True, eq=False)
class Limb:
    """One arm with its gripper."""

    side: str  # "left" or "right"
    joints: tuple[str, ...]  # n, base to wrist
    ee: Mount  # the end-effector frame: x is the approach, y the closing direction
    camera: Mount  # wrist camera: x looks forward, y points left
    gripper_joint: str  # base finger
    mimics: tuple[Mimic, ...]
    finger_signs: tuple[float, ...]  # of each finger joint: +1 where a larger number opens
    home: Array  # (n,) posture at the start of an episode [rad]
    limits: Array  # (n, 2) lower and upper angle [rad]
    # With the elbow up and the tool pitched down: most of the table is reached from there.
    bent: Array  # (n,) posture [rad]
    # Radians of one joint are not worth the same: the base swings the whole arm, the last joint
    # only turns the fingers. Used to say which of two postures is nearer.
    weights: Array  # (n,)
    velocity: Array  # (n,) largest in a planned motion [rad/s]
    acceleration: Array  # (n,) largest in a planned motion [rad/s^2]
    drive: Drive  # of the arm's joints
    gripper_drive: Drive  # of the fingers
    effort: Array  # (n,) largest torque of each motor [N m]
    finger_effort: float  # largest force of a finger's motor [N]
    gripper_scale: tuple[float, float]  # [m] finger joint target at g = 0 (closed) and g = 1 (open)
    hand: Hand

    @property
    def finger_joints(self) -> tuple[str, ...]:
        """Base finger first, then those that follow it."""
        return (self.gripper_joint, *(m.joint for m in self.mimics))

    def finger_target(self, g: float) -> float:
        """Finger joint target [m] of a gripper command g in [0, 1]; 0 is closed."""
        closed, opened = self.gripper_scale
        return closed + g * (opened - closed)


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
    urdf: Path  # of both arms
    base: Pose  # world <- root link of the URDF
    left: Limb
    right: Limb
    cameras: tuple[StaticCamera, ...]

    @property
    def limbs(self) -> tuple[Limb, Limb]:
        return self.left, self.right

    @property
    def action_layout(self) -> ActionLayout:
        """Where the commands of both arms stand in one vector."""
        return ActionLayout(len(self.left.joints), len(self.right.joints))


class NamedPair(NamedTuple):
    """What an embodiment's name states."""

    left: str  # the robot whose left arm it has
    right: str
    distance: float | None = None  # of the bases [m]; None: as the description says

    def __str__(self) -> str:
        return self.left if self.distance is None else ",".join((*self[:2], f"{self.distance:g}"))


def canonical(name: str) -> str:
    """The name as it is stored: without spaces, the distance in its shortest form.

    Raises:
        BadValue: it cannot be a robot's name.
    """
    return str(named_pair(name))


def named_pair(name: str) -> NamedPair:
    """The robots that an embodiment's name states, and how far apart they stand.

    RoboTwin writes two single arms as "LEFT,RIGHT,DISTANCE".

    Raises:
        BadValue: neither one name nor two with a distance.
    """
    words = [word.strip() for word in name.split(",")]
    if len(words) == 1 and words[0]:
        return NamedPair(model := _plain(name, words[0]), model)
    allowed = "it is one name, or LEFT,RIGHT,DISTANCE such as piper,piper,0.6"
    try:
        left, right, distance = words[0], words[1], float(words[2])
    except (IndexError, ValueError):
        raise BadValue("embodiment", name, allowed) from None
    if len(words) != 3 or not 0.1 <= distance <= 2.0:
        raise BadValue("embodiment", name, f"{allowed}; the distance is 0.1 to 2 m")
    return NamedPair(_plain(name, left), _plain(name, right), distance)


def _plain(name: str, model: str) -> str:
    """The model's name. Raises `BadValue`: it is no plain component of a path."""
    try:
        return plain_name(model)
    except ValueError as problem:
        raise BadValue("embodiment", name, str(problem)) from problem
