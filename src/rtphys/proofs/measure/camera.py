"""Measures from poses how far the head camera is from where the robot's description puts it."""

from collections.abc import Mapping

import numpy as np
from scipy.spatial.transform import Rotation

from rtphys.assets.embodiment import Embodiment
from rtphys.core.poses import Array, Pose
from rtphys.proofs.measure.finding import Finding, Measurement
from rtphys.proofs.measure.specimen import Specimen
from rtphys.sim.room import TOP

HEAD = "head_camera"


def locate(specimen: Specimen, stored: Mapping[str, Pose]) -> list[Finding]:
    """Distance and angle of the head camera: in the built world, and where files say it was.

    Args:
        stored: what says so -> world pose of the camera; x forward, y left, z up.
    """
    world = specimen.world
    p, axes = _described(world.robot.embodiment)
    orbits = specimen.values.get("camera_mode") == "orbit"
    findings: list[Finding] = []
    for place, X in {"world": world.head_camera.pose, **stored}.items():
        unturned = _towards(p, X.p, axes) @ axes if orbits else axes
        turn = Rotation.from_matrix(unturned.T @ X.R).magnitude()
        name = f"{HEAD}, {place}"
        away, angle = float(np.linalg.norm(X.p - p)), float(np.degrees(turn))
        label = specimen.number("camera_distance"), specimen.number("camera_angle")
        findings.append(Measurement("camera_distance", name, label[0], away))
        findings.append(Measurement("camera_angle", name, label[1], angle))
    return findings


def _described(embodiment: Embodiment) -> tuple[Array, Array]:
    """Position (3,) [m] and axes (3, 3), as columns, in the robot's description."""
    spec = next(camera for camera in embodiment.cameras if camera.name == HEAD)
    forward, left = (np.asarray(v, float) for v in (spec.forward, spec.left))
    forward = forward / np.linalg.norm(forward)
    left = left - (left @ forward) * forward
    left /= np.linalg.norm(left)
    axes = np.column_stack([forward, left, np.cross(forward, left)])
    return np.asarray(spec.position, float), axes


def _towards(nominal: Array, now: Array, axes: Array) -> Array:
    """(3, 3) smallest rotation with which a camera that has moved still looks at the same point.

    That point is where the nominal line of sight meets the nominal table top.
    """
    forward = axes[:, 0]
    gaze = nominal + forward * (nominal[2] - TOP) / -forward[2]
    a, b = (v / np.linalg.norm(v) for v in (gaze - nominal, gaze - now))
    across = np.cross(a, b)
    sine = np.linalg.norm(across)
    if sine == 0:
        return np.eye(3)
    return Rotation.from_rotvec(across / sine * np.arctan2(sine, a @ b)).as_matrix()
