"""One AgileX Piper arm of 6 joints: joints, frames, limits and masses of the official model.

Joint and link names are the official ones. Two stand side by side (`rtphys.assets.pair_urdf`).
Figures: the maker's published URDF, as RoboTwin uses it. Its config differs in where the feet
stand, 10 cm lower and, by default, 10 cm farther apart: the wrist pitches by 70 degrees only, and
from here the hand can point down on most of the table. The elbow bends one way, as the real one
does; RoboTwin's URDF lets it bend both ways, which invites postures that face away from the table.
"""

from pathlib import Path

import numpy as np

from rtphys.assets.asset_model import ArticulatedModel, Body, Joint, Part
from rtphys.assets.embodiments import aloha_arm
from rtphys.assets.embodiments.aloha_arm import STEEL, Shape, drum
from rtphys.assets.embodiments.single_arm import by_name, moved, prism, stand, turning, write_arm
from rtphys.assets.geometry import box, rounded_box
from rtphys.assets.material import plastic
from rtphys.assets.solid import hull, together
from rtphys.assets.urdf import placed

# As the official URDF writes them: the frames agree to the digit.
TURN, HALF = 1.5708, 3.1415926
FRAMES = (  # origin xyz [m], rpy [rad] of each joint, which turns about z
    ((0, 0, 0.123), (0, 0, -TURN)),
    ((0, 0, 0), (TURN, 0, -TURN)),
    ((0.28358, 0.028726, 0), (0, 0, 0.10095)),
    ((-0.24221, 0.068514, 0), (-TURN, 0, 1.3826)),
    ((0, 0, 0), (TURN, 0, 0)),
    ((0, 0.091, 0.0014165), (-TURN, -HALF, 0)),
)
LIMITS = (
    (-2.618, 2.618), (0.0, 3.14), (-2.697, 2.697), (-1.832, 1.832), (-1.22, 1.22), (-3.14, 3.14),
)  # fmt: skip
FINGERS = {
    "7": placed((0, 0, 0.13503), (TURN, 0, HALF)),
    "8": placed((0, 0, 0.13503), (-TURN, 0, HALF)),
}
STROKE = 0.04  # [m]
EFFORT = (100,) * 6  # [N m] its official URDF
FINGER_EFFORT = 50.0  # [N] largest of the Piper's gripper, data sheet; its URDF says 10
# The camera in link 6: RoboTwin's mount, and what hangs on it.
CAMERA = placed((0, 0, -0.077), (0, 0, TURN)) @ placed((0.032, 0.055, 0.115), (0, -1.11169, -TURN))
LINKS = ("base_link", "link1", "link2", "link3", "link4", "link5", "link6")

FIGURES = {
    "base_link": (
        0.162549,
        (-0.0098, 0, 0.0410),
        (226.6e-6, 269.4e-6, 222.3e-6, -0.1e-6, 2.1e-6, 0),
    ),
    "link1": (
        0.097868,
        (0.0013, 0.0003, -0.0092),
        (77.7e-6, 92.5e-6, 82.5e-6, 0.1e-6, -2.0e-6, 1.0e-6),
    ),
    "link2": (
        0.290889,
        (0.1488, -0.0024, 0.0018),
        (149.0e-6, 1728.0e-6, 1775.5e-6, -73.8e-6, -1.0e-6, -1.1e-6),
    ),
    "link3": (
        0.290848,
        (-0.0997, 0.0349, 0.0005),
        (107.9e-6, 214.8e-6, 241.9e-6, 29.3e-6, 0.7e-6, -0.8e-6),
    ),
    "link4": (0.127087, (0.0003, -0.0010, -0.0047), (38.2e-6, 48.7e-6, 41.1e-6, 0, 0, 0.1e-6)),
    "link5": (0.144711, (0.0001, 0.0567, -0.0020), (44.0e-6, 56.3e-6, 48.9e-6, 0, 0, -0.2e-6)),
    "link6": (
        0.195187,
        (0.0010, 0.0122, 0.0315),
        (64.4e-6, 126.1e-6, 154.1e-6, -1.2e-6, 0.2e-6, 2.4e-6),
    ),
    "link7": (
        0.026482,
        (-0.0003, -0.0468, -0.0092),
        (10.0e-6, 6.2e-6, 14.2e-6, -0.2e-6, 0, -1.6e-6),
    ),
    "link8": (0.026482, (0.0003, 0.0468, -0.0092), (10.0e-6, 6.2e-6, 14.2e-6, -0.2e-6, 0, 1.6e-6)),
}

SHELL = plastic((0.16, 0.17, 0.19), 0.35)  # covers
CAP = plastic((0.72, 0.74, 0.77), 0.4)  # joint caps
RING = plastic((0.10, 0.45, 0.85), 0.4)


def write_piper(folder: Path) -> None:
    """`<folder>/{config.yml,piper.urdf,meshes/}`."""
    write_arm(folder, piper(), CONFIG)


def piper() -> ArticulatedModel:
    """The arm on its stand, root `base_link` at the arm's foot, x forward, z up."""
    shapes = {
        "base_link": _base(),
        "link1": _shoulder(),
        "link2": _upper_arm(),
        "link3": _forearm(),
        "link4": _wrist_roll(),
        "link5": _wrist_pitch(),
        "link6": _hand(),
        "link7": _finger("7"),
        "link8": _finger("8"),
    }
    links: dict[str, Body] = by_name((*LINKS, "link7", "link8"), shapes, FIGURES)
    links["camera"] = Body(*aloha_arm.camera())
    frames = [placed(*frame) for frame in FRAMES]
    joints = turning([f"joint{i}" for i in range(1, 7)], LINKS, frames, LIMITS, EFFORT)
    joints += [
        Joint(
            f"joint{k}",
            "prismatic",
            "link6",
            f"link{k}",
            X,
            (0, 0, -1),
            (0.0, STROKE),
            effort=FINGER_EFFORT,
            speed=1,
        )
        for k, X in FINGERS.items()
    ]
    joints.append(Joint("camera_joint", "fixed", "link6", "camera", CAMERA))
    return ArticulatedModel(links, tuple(joints), "aluminium", ("arm of six joints",))


def _base() -> Shape:
    """z up, x forward; the foot is at z = 0."""
    foot = rounded_box(0.13, 0.12, 0.02, 0.004, 1).at(-0.005, 0, 0.01)
    column = drum("z", 0.042, 0.088).at(0, 0, 0.064)
    pillar, solid = stand(0.85, 0.12, 0.13)
    parts = (Part(foot, STEEL, "aluminium"), Part(column, SHELL), pillar)
    return parts, (drum("z", 0.045, 0.108, 10).at(0, 0, 0.056), solid)


def _shoulder() -> Shape:
    """y forward, z up; the shoulder axis is x."""
    turret = drum("z", 0.040, 0.045).at(0, 0, -0.004)
    motor = drum("x", 0.036, 0.072)
    return (Part(turret, SHELL), Part(motor, CAP)), (hull([*turret.vertices, *motor.vertices]),)


def _upper_arm() -> Shape:
    """x to the elbow at (0.284, 0.029, 0), z is the axis of both; it sags below the line."""
    beam = [
        (-0.02, -0.024),
        (0.10, -0.033),
        (0.22, -0.045),
        (0.24, 0.0),
        (0.10, 0.016),
        (-0.02, 0.024),
    ]
    bend = [
        (0.20, -0.043),
        (0.25, -0.026),
        (0.306, 0.012),
        (0.300, 0.050),
        (0.264, 0.050),
        (0.20, 0.0),
    ]
    caps = [drum("z", 0.037, 0.010).at(0, 0, dz) for dz in (-0.042, 0.042)]
    elbow = drum("z", 0.030, 0.074).at(0.28358, 0.028726, 0)
    solids = prism(beam, 0.058), prism(bend, 0.058)
    parts = (Part(together(*solids), SHELL), Part(together(*caps, elbow), CAP))
    return parts, (*solids, elbow)


def _forearm() -> Shape:
    """From the elbow (origin) to the wrist at (-0.242, 0.069, 0), z the elbow's axis."""
    beam = [
        (0.0, 0.028),
        (-0.01, 0.004),
        (-0.05, 0.012),
        (-0.20, 0.040),
        (-0.21, 0.080),
        (-0.06, 0.052),
    ]
    ring = drum("x", 0.031, 0.008).turned("z", -10.8).at(-0.205, 0.0615, 0)
    solid = prism(beam, 0.050)
    return (Part(solid, SHELL), Part(ring, RING)), (solid,)


def _wrist_roll() -> Shape:
    """z along the forearm, towards the hand; the pitch axis passes through the origin."""
    body = drum("z", 0.028, 0.030).at(0, 0, -0.026)
    fork = [rounded_box(0.044, 0.008, 0.05, 0.003, 1).at(0, dy, -0.004) for dy in (-0.031, 0.031)]
    solid = hull([*body.vertices, *together(*fork).vertices])
    return (Part(body, CAP), Part(together(*fork), SHELL)), (solid,)


def _wrist_pitch() -> Shape:
    """y towards the hand at (0, 0.091, 0), z the pitch axis."""
    body = drum("z", 0.025, 0.052)
    neck = rounded_box(0.042, 0.062, 0.046, 0.006, 1).at(0, 0.046, 0)
    return (Part(body, CAP), Part(neck, SHELL)), (neck, body)


def _hand() -> Shape:
    """z is the approach, y the closing direction; x points away from the camera."""
    motor = drum("z", 0.028, 0.046).at(0, 0, 0.025)
    palm = rounded_box(0.046, 0.062, 0.018, 0.004, 1).at(0, 0, 0.053)
    rail = rounded_box(0.024, 0.160, 0.018, 0.003, 1).at(0, 0, 0.0655)
    ring = drum("z", 0.0295, 0.006).at(0, 0, 0.012)
    neck = box(0.040, 0.030, 0.010).at(-0.043, 0.016, 0.034)
    parts = (
        Part(together(motor, neck), SHELL),
        Part(together(palm), CAP),
        Part(rail, STEEL, "aluminium"),
        Part(ring, RING),
    )
    return parts, (drum("z", 0.028, 0.05, 10).at(0, 0, 0.027), rail, neck)


def _finger(key: str) -> Shape:
    """As the aloha's, which grips as far in front of its wrist; link 8 opens along +y."""
    origin, left = np.array([0.08457, 0.0, 0.0]), key == "8"
    origin[1] = 0.024493 if left else -0.024493
    X_6E = np.eye(4)
    X_6E[:3, :3] = [[0, 0, -1], [0, 1, 0], [1, 0, 0]]
    X_EF = np.eye(4)
    X_EF[:3, 3] = origin
    return moved(aloha_arm.finger(left), np.linalg.inv(FINGERS[key]) @ X_6E @ X_EF)


CONFIG = """\
urdf_path: "./piper.urdf"
dual_arm: false
joint_stiffness: 1000
joint_damping: 200
gripper_stiffness: 1000
gripper_damping: 200
move_group: ["link6", "link6"]
arm_joints_name:
  - ["joint1", "joint2", "joint3", "joint4", "joint5", "joint6"]
  - ["joint1", "joint2", "joint3", "joint4", "joint5", "joint6"]
gripper_name:
  - base: "joint7"
    mimic: [["joint8", 1.0, 0.0]]
  - base: "joint7"
    mimic: [["joint8", 1.0, 0.0]]
gripper_bias: 0.12
gripper_scale: [-0.01, 0.04]
homestate: [[0, 0, 0, 0, 0, 0], [0, 0, 0, 0, 0, 0]]
delta_matrix: [[0, 0, -1], [0, 1, 0], [1, 0, 0]]
robot_pose: [[0, -0.45, 0.85, 0.707, 0, 0, 0.707]]
static_camera_list:
  - name: head_camera
    type: D435
    position: [-0.032, -0.45, 1.35]
    forward: [0, 0.6, -0.8]
    left: [-1, 0, 0]
"""
