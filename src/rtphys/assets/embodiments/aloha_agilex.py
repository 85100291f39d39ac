"""The dual-arm aloha-agilex: joints, frames, limits and inertias of the official model.

Joint and link names are the official ones, so a recorded joint vector means the same on both. Only
the two front arms move; wheels and rear arms are scenery. Figures: the machine's published URDF.
"""

from pathlib import Path

import numpy as np

from rtphys.assets.asset_model import ArticulatedModel, Body, Inertial, Joint, Part
from rtphys.assets.embodiment import ALOHA_LIMITS
from rtphys.assets.embodiments import aloha_arm, aloha_base
from rtphys.assets.urdf import placed
from rtphys.assets.write import write_links

PI = 3.1416  # as the official URDF writes it: the frames agree to the digit

# joint: origin xyz [m], rpy [rad], axis
ARM_JOINTS = (
    ((0, 0, 0.058), (0, 0, 0), (0, 0, 1)),
    ((0.025013, 0.00060169, 0.042), (0, 0, 0), (0, 1, 0)),
    ((-0.26396, 0.0044548, 0), (-PI, 0, -0.015928), (0, 1, 0)),
    ((0.246, -0.00025, -0.06), (0, 0, 0), (0, 1, 0)),
    ((0.06775, 0.0015, -0.0855), (0, 0, -0.015928), (0, 0, 1)),
    ((0.03095, 0, 0.0855), (-PI, 0, 0), (1, 0, 0)),
)
FINGER_JOINTS = (
    ((0.08457, 0.024493, -0.00010349), (0, 1, 0)),
    ((0.08457, -0.024496, -0.00010354), (0, -1, 0)),
)
FINGER_STROKE = 0.04765  # [m]
FINGER_EFFORT = 50.0  # [N] largest of the AgileX gripper, data sheet; the official URDF says 100
WRIST_CAMERA = ((0.07, 0.032, 0.065), (0, 0.4, 0))

# side: its wrist camera, base xyz on the footprint, yaw. The small yaws are the machine's own.
SIDES = {
    "fl": ("left_camera", (0.2305, 0.297, 0.782), 0.02),
    "fr": ("right_camera", (0.2315, -0.3063, 0.781), 0.01),
}

# link: mass [kg], centre of mass [m], inertia xx yy zz xy xz yz [1e-6 kg m^2]
INERTIALS = {
    "base": (0.155113, (0, 0.0001, 0.0273), (76.0, 76.4, 69.5, 0, 0, 0)),
    "1": (0.021629, (0.0063, -0.0248, 0.0152), (11.6, 9.5, 10.7, 1.6, -2.7, 3.0)),
    "2": (0.317041, (-0.0752, 0, 0), (148.6, 646.3, 613.1, 8.0, 2.1, 0)),
    "3": (
        0.475180,
        (0.0959, -0.0001, -0.0389),
        (245.8, 848.6, 732.9, -1.2, -0.3, 0),
    ),
    "4": (
        0.138134,
        (0.0591, 0.0028, -0.0552),
        (56.8, 55.7, 64.3, 3.2, 3.3, -2.1),
    ),
    "5": (0.126742, (0.0087, 0, 0.0818), (52.9, 41.4, 44.7, 0, 1.1, 0)),
    "6": (0.142880, (0.0383, 0, 0.0036), (98.4, 39.5, 84.7, 0.1, 0.2, 0.3)),
    "7": (
        0.026478,
        (0.0063, -0.0071, -0.0029),
        (8.8, 14.9, 11.1, 3.0, -0.6, 0.1),
    ),
    "8": (0.026478, (0.0063, 0.0071, 0.0015), (9.0, 15.1, 11.1, -3.0, 1.5, 0.1)),
    "camera": (0.1, (0, 0, 0), (1000, 1000, 1000, 0, 0, 0)),
    "mobile": (132.4, (0.015, 0.023, 0), (5e6, 5e6, 8e6, 0, 0, 0)),
    "tower": (0.336, (-0.0086, 0, 0.1701), (5806, 5826, 187, 0, 0, 0)),
    "rear": (3.2, (-0.13, 0, 0.1), (20e3, 50e3, 50e3, 0, 0, 0)),
}


def write_aloha_agilex(folder: Path) -> None:
    """`<folder>/{config.yml,urdf/aloha_agilex.urdf,urdf/meshes/}`."""
    folder.mkdir(parents=True, exist_ok=True)
    write_links(folder / "urdf", "aloha_agilex", aloha_agilex(), "aloha_agilex.urdf")
    (folder / "config.yml").write_text(CONFIG)


def aloha_agilex() -> ArticulatedModel:
    """The whole machine, root `footprint` on the ground, x forward, z up."""
    links = {"footprint": Body((), ())} | _scenery()
    joints = list(_scenery_joints())
    arm = _arm_bodies()
    for side in SIDES:
        links |= {_link(side, key): body for key, body in arm.items()}
        joints += _arm_joints(side)
    return ArticulatedModel(
        links=links,
        joints=tuple(joints),
        material="aluminium",
        description=("two-armed mobile robot",),
    )


def _link(side: str, key: str) -> str:
    if key == "camera":
        return SIDES[side][0]
    return f"{side}_base_link" if key == "base" else f"{side}_link{key}"


def _arm_bodies() -> dict[str, Body]:
    """One set of bodies for both arms: they share their mesh files."""
    shapes = {
        "base": aloha_arm.base(),
        "1": aloha_arm.shoulder(),
        "2": aloha_arm.upper_arm(),
        "3": aloha_arm.forearm(),
        "4": aloha_arm.wrist_pitch(),
        "5": aloha_arm.wrist_yaw(),
        "6": aloha_arm.hand(),
        "7": aloha_arm.finger(left=True),
        "8": aloha_arm.finger(left=False),
        "camera": aloha_arm.camera(),
    }
    return {key: _body(key, *shape) for key, shape in shapes.items()}


def _body(key: str, visual: tuple[Part, ...], collision: tuple) -> Body:
    mass, com, (xx, yy, zz, xy, xz, yz) = INERTIALS[key]
    inertia = 1e-6 * np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return Body(visual, collision, given=Inertial(mass, np.array(com, float), inertia, 0.0))


def _arm_joints(side: str) -> list[Joint]:
    _, xyz, yaw = SIDES[side]
    hand, camera = _link(side, "6"), _link(side, "camera")
    base = placed(xyz, (0, 0, yaw))
    return [
        Joint(f"{side}_base_joint", "fixed", "footprint", _link(side, "base"), base),
        Joint(f"{camera}_joint", "fixed", hand, camera, placed(*WRIST_CAMERA)),
        *_turning_joints(side),
        *_finger_joints(side),
    ]


def _turning_joints(side: str) -> list[Joint]:
    links = [_link(side, key) for key in ("base", "1", "2", "3", "4", "5", "6")]
    rows = zip(links, links[1:], ARM_JOINTS, ALOHA_LIMITS, strict=False)
    return [
        Joint(f"{side}_joint{i}", "revolute", parent, child, placed(origin, rpy), axis, limits)
        for i, (parent, child, (origin, rpy, axis), limits) in enumerate(rows, 1)
    ]


def _finger_joints(side: str) -> list[Joint]:
    return [
        Joint(
            f"{side}_joint{key}",
            "prismatic",
            _link(side, "6"),
            _link(side, key),
            placed(origin),
            axis,
            (0.0, FINGER_STROKE),
            effort=FINGER_EFFORT,
            speed=1.0,
        )
        for key, (origin, axis) in zip("78", FINGER_JOINTS, strict=True)
    ]


def _scenery() -> dict[str, Body]:
    rear = _body("rear", *aloha_base.rear_arm())
    return {
        "base_link": _body("mobile", *aloha_base.mobile_base()),
        "camera_base_link": _body("tower", *aloha_base.tower()),
        "camera_link1": _body("camera", *aloha_base.tower_camera()),
        "camera_link2": _body("camera", *aloha_base.tower_camera()),
        "lr_base_link": rear,
        "rr_base_link": rear,
    }


def _scenery_joints() -> tuple[Joint, ...]:
    rows = (
        ("box_joint", "footprint", "base_link", (0, 0, 0.15), 0.0),
        ("camera_to_box1", "base_link", "camera_base_link", (0.18, 0, 0.626), 0.0),
        ("camera_joint1", "camera_base_link", "camera_link1", (0.071198, 0, 0.10384), 0.26931),
        ("camera_joint2", "camera_link1", "camera_link2", (-0.14, 0, 0.5), 0.011358),
        ("lr_base_joint", "footprint", "lr_base_link", (-0.309, 0.307, 0.903), 0.0),
        ("rr_base_joint", "footprint", "rr_base_link", (-0.309, -0.307, 0.903), 0.0),
    )
    return tuple(
        Joint(name, "fixed", parent, child, placed(xyz, (0, pitch, 0)))
        for name, parent, child, xyz, pitch in rows
    )


CONFIG = """\
urdf_path: "./urdf/aloha_agilex.urdf"
joint_stiffness: 1000
joint_damping: 200
gripper_stiffness: 1000
gripper_damping: 200
move_group: ["fl_link6", "fr_link6"]
ee_joints: ["fl_joint6", "fr_joint6"]
arm_joints_name:
  - ["fl_joint1", "fl_joint2", "fl_joint3", "fl_joint4", "fl_joint5", "fl_joint6"]
  - ["fr_joint1", "fr_joint2", "fr_joint3", "fr_joint4", "fr_joint5", "fr_joint6"]
gripper_name:
  - base: "fl_joint7"
    mimic: [["fl_joint8", 1.0, 0.0]]
  - base: "fr_joint7"
    mimic: [["fr_joint8", 1.0, 0.0]]
gripper_bias: 0.12
gripper_scale: [-0.01, 0.045]
homestate: [[0, 0, 0, 0, 0, 0], [0, 0, 0, 0, 0, 0]]
delta_matrix: [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
global_trans_matrix: [[1, 0, 0], [0, -1, 0], [0, 0, -1]]
robot_pose: [[0, -0.65, 0.0, 0.707, 0, 0, 0.707]]
dual_arm: true
rotate_lim: [0, 1]
grasp_perfect_direction: ["front_right", "front_left"]
static_camera_list:
  - name: head_camera
    type: D435
    position: [-0.032, -0.45, 1.35]
    forward: [0, 0.6, -0.8]
    left: [-1, 0, 0]
  - name: front_camera
    type: D435
    position: [0.20, -0.45, 0.85]
    forward: [0, 1, -0.1]
    left: [-1, 0, 0]
"""
