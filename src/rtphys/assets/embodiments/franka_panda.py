"""One Franka Panda arm of 7 joints with its hand: joints, frames and limits of the official model.

Joint and link names are the official ones. Two stand side by side (`rtphys.assets.pair_urdf`).
Figures: the maker's published URDF, which states no masses; those are as identified by Gaz et al.,
"Dynamic Identification of the Franka Emika Panda Robot", 2019, in the maker's ROS package.
"""

from pathlib import Path

import numpy as np

from rtphys.assets.asset_model import ArticulatedModel, Body, Joint, Part
from rtphys.assets.embodiments import aloha_arm
from rtphys.assets.embodiments.aloha_arm import MOTOR, PAD, STEEL, Shape, drum
from rtphys.assets.embodiments.single_arm import by_name, moved, prism, stand, turning, write_arm
from rtphys.assets.geometry import box, rounded_box
from rtphys.assets.material import plastic
from rtphys.assets.solid import hull, together
from rtphys.assets.urdf import placed

TURN = np.pi / 2
FRAMES = (  # origin xyz [m], rpy [rad] of each joint, which turns about z
    ((0, 0, 0.333), (0, 0, 0)),
    ((0, 0, 0), (-TURN, 0, 0)),
    ((0, -0.316, 0), (TURN, 0, 0)),
    ((0.0825, 0, 0), (TURN, 0, 0)),
    ((-0.0825, 0.384, 0), (-TURN, 0, 0)),
    ((0, 0, 0), (TURN, 0, 0)),
    ((0.088, 0, 0), (TURN, 0, 0)),
)
LIMITS = (
    (-2.8973, 2.8973), (-1.7628, 1.7628), (-2.8973, 2.8973), (-3.0718, -0.0698),
    (-2.8973, 2.8973), (-0.0175, 3.7525), (-2.8973, 2.8973),
)  # fmt: skip
LINKS = tuple(f"panda_link{i}" for i in range(8))
HAND = placed((0, 0, 0.107), (0, 0, -np.pi / 4))  # in link 7
FINGER_ROOT = placed((0, 0, 0.0584))  # in the hand
STROKE = 0.04  # [m]
EFFORT = (87, 87, 87, 87, 12, 12, 12)  # [N m] data sheet of the Panda
FINGER_EFFORT = 70.0  # [N] continuous, data sheet of the Franka Hand; its URDF says 20
CAMERA = placed((0.062, 0.019, 0.020), (0.0, -1.35, 3.14159265))  # in the hand

FIGURES = {
    "panda_link0": (
        0.629769,
        (-0.041018, -0.00014, 0.049974),
        (3.15e-3, 3.88e-3, 4.285e-3, 0, 1.5e-4, 0),
    ),
    "panda_link1": (
        4.970684,
        (0.003875, 0.002081, -0.04762),
        (0.70337, 0.70661, 9.117e-3, -1.39e-4, 6.772e-3, 1.9169e-2),
    ),
    "panda_link2": (
        0.646926,
        (-0.003141, -0.02872, 0.003495),
        (7.962e-3, 2.811e-2, 2.5995e-2, -3.925e-3, 1.0254e-2, 7.04e-4),
    ),
    "panda_link3": (
        3.228604,
        (0.027518, 0.039252, -0.066502),
        (3.7242e-2, 3.6155e-2, 1.083e-2, -4.761e-3, -1.1396e-2, -1.2805e-2),
    ),
    "panda_link4": (
        3.587895,
        (-0.05317, 0.104419, 0.027454),
        (2.5853e-2, 1.9552e-2, 2.8323e-2, 7.796e-3, -1.332e-3, 8.641e-3),
    ),
    "panda_link5": (
        1.225946,
        (-0.011953, 0.041065, -0.038437),
        (3.5549e-2, 2.9474e-2, 8.627e-3, -2.117e-3, -4.037e-3, 2.29e-4),
    ),
    "panda_link6": (
        1.666555,
        (0.060149, -0.014117, -0.010517),
        (1.964e-3, 4.354e-3, 5.433e-3, 1.09e-4, -1.158e-3, 3.41e-4),
    ),
    "panda_link7": (
        0.735522,
        (0.010517, -0.004252, 0.061597),
        (1.2516e-2, 1.0027e-2, 4.815e-3, -4.28e-4, -1.196e-3, -7.41e-4),
    ),
    "panda_hand": (0.73, (-0.01, 0, 0.03), (1.0e-3, 2.5e-3, 1.7e-3, 0, 0, 0)),
    "panda_leftfinger": (0.015, (0, 0, 0), (2.4e-6, 2.4e-6, 0.75e-6, 0, 0, 0)),
    "panda_rightfinger": (0.015, (0, 0, 0), (2.4e-6, 2.4e-6, 0.75e-6, 0, 0, 0)),
}

WHITE = plastic((0.92, 0.93, 0.94), 0.35)
GREY = plastic((0.35, 0.37, 0.40), 0.45)  # joint rings and the flange
SIDES = 16


def write_franka_panda(folder: Path) -> None:
    """`<folder>/{config.yml,franka-panda.urdf,meshes/}`."""
    write_arm(folder, franka_panda(), CONFIG)


def franka_panda() -> ArticulatedModel:
    """The arm on its stand, root `panda_link0` at the arm's foot, x forward, z up."""
    arm = (
        _base(),
        _shoulder(),
        _upper_arm(),
        _elbow(),
        _forearm_top(),
        _forearm(),
        _wrist(),
        _flange(),
    )
    shapes = dict(zip(LINKS, arm, strict=True))
    shapes["panda_hand"] = _hand()
    shapes["panda_leftfinger"] = _finger()
    shapes["panda_rightfinger"] = moved(_finger(), placed((0, 0, 0), (0, 0, np.pi)))
    links: dict[str, Body] = by_name(tuple(shapes), shapes, FIGURES)
    links["camera"] = Body(*aloha_arm.camera())
    names = [f"panda_joint{i}" for i in range(1, 8)]
    frames = [placed(*frame) for frame in FRAMES]
    joints = turning(names, LINKS, frames, LIMITS, EFFORT)
    joints.append(Joint("panda_hand_joint", "fixed", "panda_link7", "panda_hand", HAND))
    joints.append(Joint("camera_joint", "fixed", "panda_hand", "camera", CAMERA))
    for i, (side, y) in enumerate((("left", 1.0), ("right", -1.0)), 1):
        name, child = f"panda_finger_joint{i}", f"panda_{side}finger"
        span = (0.0, STROKE)
        joints.append(
            Joint(
                name,
                "prismatic",
                "panda_hand",
                child,
                FINGER_ROOT,
                (0, y, 0),
                span,
                effort=FINGER_EFFORT,
                speed=0.2,
            )
        )
    return ArticulatedModel(links, tuple(joints), "aluminium", ("arm of seven joints",))


def _base() -> Shape:
    """z up, x forward; the foot is at z = 0."""
    foot = prism([(-0.13, -0.07), (0.04, -0.09), (0.07, 0.0), (0.04, 0.09), (-0.13, 0.07)], 0.06)
    column = drum("z", 0.066, 0.10, SIDES).at(0, 0, 0.09)
    pillar, solid = stand(0.75, 0.18, 0.18)
    foot = foot.at(0, 0, 0.03)
    parts = (Part(together(foot, column), WHITE), pillar)
    return parts, (hull([*foot.vertices, *column.vertices]), solid)


def _shoulder() -> Shape:
    """z up, 0.333 above the foot; the shoulder axis is y."""
    column = drum("z", 0.060, 0.125, SIDES).at(0, 0, -0.1275)
    ring = drum("z", 0.063, 0.012, SIDES).at(0, 0, -0.184)
    drum_ = drum("y", 0.062, 0.12, SIDES).at(0, -0.045)
    solid = hull([*column.vertices, *drum_.vertices])
    return (Part(together(column, drum_), WHITE), Part(ring, GREY)), (solid,)


def _upper_arm() -> Shape:
    """y down the arm: the elbow is at (0, -0.316, 0); z is the shoulder axis."""
    side = drum("z", 0.058, 0.11, SIDES).at(0, 0, 0.075)
    column = drum("y", 0.056, 0.12, SIDES).at(0, -0.135)
    neck = prism([(-0.05, 0.02), (0.05, 0.02), (0.055, -0.10), (-0.055, -0.10)], 0.06).at(
        0, 0, 0.04
    )
    ring = drum("y", 0.059, 0.010, SIDES).at(0, -0.198)
    solid = hull([*side.vertices, *column.vertices])
    return (Part(together(side, column, neck), WHITE), Part(ring, GREY)), (solid,)


def _elbow() -> Shape:
    """z up the arm; the elbow's axis is y, at x = 0.0825."""
    column = drum("z", 0.056, 0.09, SIDES).at(0, 0, -0.065)
    side = drum("y", 0.054, 0.10, SIDES).at(0.0825, 0.035)
    solid = hull([*column.vertices, *side.vertices])
    return (Part(hull([*column.vertices, *side.vertices]), WHITE),), (solid,)


def _forearm_top() -> Shape:
    """y along the forearm, which lies at x = -0.0825; z is the elbow's axis."""
    side = drum("z", 0.052, 0.10, SIDES).at(0, 0, 0.035)
    column = drum("y", 0.054, 0.07, SIDES).at(-0.0825, 0.085)
    solid = hull([*side.vertices, *column.vertices])
    ring = drum("y", 0.057, 0.010, SIDES).at(-0.0825, 0.122)
    return (Part(solid, WHITE), Part(ring, GREY)), (solid,)


def _forearm() -> Shape:
    """z along the forearm to the wrist (origin), whose axis is y."""
    top = drum("z", 0.050, 0.06, SIDES).at(0, 0, -0.225)
    slope = hull([*top.vertices, *drum("y", 0.030, 0.06, SIDES).at(0, 0.07, -0.06).vertices])
    wrist = drum("y", 0.048, 0.115, SIDES).at(0, 0.045)
    join = hull([*drum("y", 0.030, 0.05, SIDES).at(0, 0.075, -0.06).vertices, *wrist.vertices])
    return (Part(together(slope, join), WHITE),), (slope, join)


def _wrist() -> Shape:
    """x towards the flange's axis at x = 0.088; z is the wrist's axis."""
    side = drum("z", 0.044, 0.09, SIDES).at(0.0, 0.0, 0.0)
    turret = drum("y", 0.046, 0.09, SIDES).at(0.088, 0.0)
    solid = hull([*side.vertices, *turret.vertices])
    return (Part(solid, WHITE),), (solid,)


def _flange() -> Shape:
    """z towards the hand at z = 0.107."""
    body = drum("z", 0.043, 0.040, SIDES).at(0, 0, 0.070)
    ring = drum("z", 0.038, 0.018, SIDES).at(0, 0, 0.098)
    bracket = prism([(0.0, -0.02), (0.075, 0.02), (0.055, 0.065), (0.0, 0.06)], 0.02).at(
        0, 0, 0.085
    )
    return (Part(together(body, bracket), WHITE), Part(ring, GREY)), (body, ring)


def _hand() -> Shape:
    """z is the approach, y the closing direction."""
    outline = [
        (-0.102, 0.005),
        (-0.09, -0.002),
        (0.09, -0.002),
        (0.102, 0.005),
        (0.102, 0.060),
        (-0.102, 0.060),
    ]
    palm = prism(outline, 0.052).placed([[0, 0, 1, 0], [1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 1]])
    slot = box(0.030, 0.180, 0.006).at(0, 0, 0.0625)
    neck = box(0.040, 0.030, 0.014).at(0.042, 0.0, 0.012)
    parts = (Part(palm, WHITE), Part(slot, MOTOR), Part(neck, GREY))
    return parts, (palm, slot)


def _finger() -> Shape:
    """The left finger, which opens along +y; its inner face meets the other's at y = 0."""
    foot = rounded_box(0.022, 0.026, 0.016, 0.002, 1).at(0, 0.0155, 0.014)
    blade = hull(
        [
            *box(0.022, 0.016, 0.004).at(0, 0.018, 0.018).vertices,
            *box(0.020, 0.005, 0.004).at(0, 0.0066, 0.0515).vertices,
        ]
    )
    pad = box(0.020, 0.0035, 0.036).at(0, 0.00185, 0.0358)
    parts = (Part(foot, STEEL, "aluminium"), Part(blade, MOTOR), Part(pad, PAD, "rubber"))
    # The gripping plate is a plain box: a flat face, so that contact is a patch and not an edge.
    plate = box(0.020, 0.006, 0.036).at(0, 0.0031, 0.0358)
    return parts, (plate, blade, foot)


CONFIG = """\
urdf_path: "./franka-panda.urdf"
dual_arm: false
joint_stiffness: 1000
joint_damping: 200
gripper_stiffness: 1000
gripper_damping: 200
move_group: ["panda_hand", "panda_hand"]
arm_joints_name:
  - [panda_joint1, panda_joint2, panda_joint3, panda_joint4,
     panda_joint5, panda_joint6, panda_joint7]
  - [panda_joint1, panda_joint2, panda_joint3, panda_joint4,
     panda_joint5, panda_joint6, panda_joint7]
gripper_name:
  - base: "panda_finger_joint1"
    mimic: [["panda_finger_joint2", 1.0, 0.0]]
  - base: "panda_finger_joint1"
    mimic: [["panda_finger_joint2", 1.0, 0.0]]
gripper_bias: 0.08
gripper_scale: [-0.01, 0.05]
homestate:
  - [0, 0.19634954, 0, -2.61799388, 0, 2.94159265, 0.78539816]
  - [0, 0.19634954, 0, -2.61799388, 0, 2.94159265, 0.78539816]
delta_matrix: [[0, 0, 1], [0, -1, 0], [1, 0, 0]]
robot_pose: [[0, -0.65, 0.75, 0.707, 0, 0, 0.707]]
static_camera_list:
  - name: head_camera
    type: D435
    position: [-0.032, -0.45, 1.35]
    forward: [0, 0.6, -0.8]
    left: [-1, 0, 0]
"""
