"""Moves every servo a little, and looks where the head camera is."""

from collections.abc import Mapping

import numpy as np
from scipy.spatial.transform import Rotation

from rtphys.core.poses import Pose
from rtphys.laws.audit.specimen import Finding, Measurement, Specimen
from rtphys.laws.lab import record, time_constants
from rtphys.sim.engine import TIME_STEP
from rtphys.spec.recording import HEAD
from rtphys.task.props import TABLE_TOP

STEP = 0.03  # [rad] of every arm joint, towards the middle of its range
CLOSE = 0.8  # gripper command, from fully open
LONG = 3.0  # time constants for which the motion is watched


def drag(specimen: Specimen) -> list[Finding]:
    """Damping gains of all arm and finger servos, as factors on the nominal ones."""
    groups = []  # attribute, servos, positions in qpos, targets and nominal time constant
    for arm in specimen.world.robot.arms:
        target, drive, grip = arm.target, arm.limb.drive, arm.limb.gripper_drive
        target += np.where(target <= arm.limb.limits.mean(axis=1), STEP, -STEP)
        arm.drive(target.tolist(), [0.0] * len(target))
        arm.grip(CLOSE)
        tau = drive.damping / drive.stiffness
        groups.append(("arm_joint_damping", arm.servos, arm.index, target, tau))
        fingers, tau = np.array(arm.finger_targets), grip.damping / grip.stiffness
        groups.append(("gripper_joint_damping", arm.finger_servos, arm.finger_index, fingers, tau))
    slowest = max(specimen.number(key) * tau for key, _, _, _, tau in groups)
    robot = specimen.world.robot.articulation
    start, steps = np.array(robot.qpos, float), int(np.ceil(LONG * slowest / TIME_STEP))
    _, path = record(specimen.world, steps, lambda: robot.qpos)
    findings: list[Finding] = []
    for key, servos, index, target, tau in groups:
        factors = time_constants(np.vstack([start, path])[:, index], target) / tau
        for servo, factor in zip(servos, factors, strict=True):
            findings.append(Measurement(key, servo.name, specimen.number(key), float(factor)))
    return findings


def locate(specimen: Specimen, stored: Mapping[str, Pose]) -> list[Finding]:
    """Distance and angle of the head camera: in the built world, and where files say it was.

    `stored`: what says so -> world pose of the camera; x forward, y left, z up.
    """
    # Position [m] and axes, as columns, in the robot's description.
    cameras = specimen.world.robot.embodiment.cameras
    spec = next(camera for camera in cameras if camera.name == HEAD)
    p, forward, left = (np.asarray(v, float) for v in (spec.position, spec.forward, spec.left))
    forward = forward / np.linalg.norm(forward)
    left = left - (left @ forward) * forward
    left /= np.linalg.norm(left)
    axes = np.column_stack([forward, left, np.cross(forward, left)])
    # An orbit still looks at the point where the nominal line of sight meets the nominal table.
    gaze = p + forward * (p[2] - TABLE_TOP) / -forward[2]
    orbits = specimen.values.get("camera_mode") == "orbit"
    findings: list[Finding] = []
    for place, X in {"world": specimen.world.head_camera.pose, **stored}.items():
        unturned = axes
        if orbits:  # by the smallest rotation that keeps it in the middle
            turn = Rotation.align_vectors([gaze - X.p], [gaze - p])[0]
            unturned = turn.as_matrix() @ axes
        angle = float(np.degrees(Rotation.from_matrix(unturned.T @ X.R).magnitude()))
        away, name = float(np.linalg.norm(X.p - p)), f"{HEAD}, {place}"
        for key, measured in (("camera_distance", away), ("camera_angle", angle)):
            findings.append(Measurement(key, name, specimen.number(key), measured))
    return findings
