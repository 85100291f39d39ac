"""What the fingers felt, from what the simulator reported at every step.

A finger's force is what its joint transmits to it: with 26 g of its own it weighs nothing beside a
load. Its normal is that of the contacts at the frame (the joint's axis where there are none), the
rest is tangential. Slip is the way of the touched object past the finger in 20 ms, by their poses:
PhysX's velocities at the end of a step are wrong for bodies that are held.
"""

from dataclasses import replace
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from rtphys.core.poses import Array
from rtphys.data.touch import Touch
from rtphys.sim.engine import RATE
from rtphys.sim.touch import POSE_STEPS, Press, TouchRow, TouchTrack

LEAST = 0.2  # [N] normal force from which a finger counts as loaded
HANDS = ("left_gripper", "right_gripper")
Track: TypeAlias = tuple[Array, Array]  # rotations, positions


def felt(track: TouchTrack) -> Touch:
    """What was felt in all rows of a recording."""
    objects = sorted({_object(press) for row in track.rows for press in row.presses})
    frames = [_frame(track, row, objects) for row in track.rows]
    stacked = {key: np.array([frame[key] for frame in frames], np.float32) for key in frames[0]}
    return Touch(track.fingers, tuple(objects), **stacked)


def felt_now(track: TouchTrack, row: TouchRow) -> Touch:
    """What is felt in one frame, T = 1."""
    return felt(replace(track, rows=[row]))


def _object(press: Press) -> str:
    first, second = press.names
    return second if first in HANDS else first


def _frame(track: TouchTrack, row: TouchRow, objects: list[str]) -> dict[str, Array]:
    n, F = len(row.wrenches), len(track.fingers)
    empty = {key: np.zeros(F) for key in ("slip", "slip_peak")}
    found: dict[str, Array] = {"force": np.zeros((F, 3)), **empty, "margin": np.ones(F)}
    for key in ("normal", "tangential"):
        found[key], found[f"{key}_peak"] = np.zeros(F), np.zeros(F)
    found["pressed"] = np.zeros((F, len(objects)))
    if n == 0:
        return found
    poses = np.frombuffer(b"".join(row.packed), np.float32).reshape(len(row.packed), -1, 7)
    ends = np.minimum(
        np.arange(len(row.packed)) * POSE_STEPS, n
    )  # steps made when poses were taken
    pose_of_step = np.arange(n) // POSE_STEPS + 1
    wrenches = np.array(row.wrenches, float)[:, list(track.links)]
    for f, body in enumerate(track.bodies):
        own = [press for press in row.presses if body in press.bodies]
        if not own and np.abs(wrenches[:, f, :3]).max() < LEAST:
            continue  # it shows its own inertia only
        for press in own:
            found["pressed"][f, objects.index(_object(press))] += press.strength * RATE
        R_WF, p_WF = _track(poses, body)
        force = np.einsum("tij,jk,tk->ti", R_WF[pose_of_step], track.joints[f], wrenches[:, f, :3])
        normal = _normal(own, R_WF[-1] @ track.joints[f][:, 0])
        along = np.abs(force @ normal)
        across = np.linalg.norm(force - np.outer(force @ normal, normal), axis=1)
        found["force"][f] = force.mean(axis=0)
        for key, values in (("normal", along), ("tangential", across)):
            found[key][f], found[f"{key}_peak"][f] = values.mean(), values.max()
        loaded = along > LEAST
        if own and loaded.any():
            found["margin"][f] = (1 - across[loaded] / (track.friction * along[loaded])).min()
        if own:
            press = max(own, key=lambda press: press.strength)
            first, second = press.bodies
            if (other := second if first == body else first) >= 0:
                ways = _slip((R_WF, p_WF), _track(poses, other), np.asarray(press.point), normal)
                found["slip"][f] = ways.sum() * RATE / n
                found["slip_peak"][f] = (ways / np.diff(ends)).max() * RATE
    return found


def _normal(presses: list[Press], axis: Array) -> Array:
    """Unit vector in the world."""
    total = np.sum([press.impulse for press in presses], axis=0) if presses else axis
    length = float(np.linalg.norm(total))
    return np.asarray(total) / length if length > 0 else axis


def _slip(finger: Track, thing: Track, point: Array, normal: Array) -> Array:
    """(n,) [m] by which a body's point under the pad moves past the pad, from pose to pose.

    Args:
        point: where the pad is touched after the last step, world.
        normal: of the pad there; motion along it is no slip.
    """
    (R_F, p_F), (R_O, p_O) = finger, thing
    at = R_F[-1].T @ (point - p_F[-1])  # in the finger's frame
    # The body's point that is there after a step: where, seen from the finger, was it before?
    world = R_F[1:] @ at + p_F[1:]
    own = np.einsum("tji,tj->ti", R_O[1:], world - p_O[1:])
    was = np.einsum("tij,tj->ti", R_O[:-1], own) + p_O[:-1]
    way = at - np.einsum("tji,tj->ti", R_F[:-1], was - p_F[:-1])
    n = R_F[-1].T @ normal
    return np.linalg.norm(way - np.outer(way @ n, n), axis=1)


def _track(packed: NDArray[np.float32], body: int) -> Track:
    """Rotations (n, 3, 3) and positions (n, 3) of a body, from rows of wxyz + xyz."""
    w, x, y, z, *position = packed[:, body].astype(float).T
    R = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.array(R).transpose(2, 0, 1), np.array(position).T
