"""What the fingers felt, from what the simulator reported at every step.

A finger's force is what its joint transmits to it: with 26 g of its own it weighs nothing beside a
load. Its normal is that of the contacts at the frame (the joint's axis where there are none), the
rest is tangential. Slip is the way of the touched object past the finger in 20 ms, by their poses:
PhysX's velocities at the end of a step are wrong for bodies that are held.

All frames are computed at once: one after the other they took a tenth of the attempt's time.
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import chain
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rtphys.core.poses import Array
from rtphys.senses.touch import Touch
from rtphys.sim.engine import RATE
from rtphys.sim.touch import HANDS, POSE_STEPS, Pair, TouchRow, TouchTrack

LEAST = 0.2  # [N] normal force from which a finger counts as loaded
SCALARS = ("normal", "tangential", "normal_peak", "tangential_peak", "slip", "slip_peak")
Rows = NDArray[np.intp]


class Presses(NamedTuple):
    """K times that a pair presses in a frame; sums over its contact points."""

    frame: Rows  # (K,)
    pair: Rows  # (K,) of `TouchTrack.pairs`
    impulse: Array  # (K, 3) [N s] of the normal forces, up to its sign
    strength: Array  # (K,) [N s] sum of their magnitudes
    point: Array  # (K, 3) [m] mean of the points, weighted by impulse; world


class Cells(NamedTuple):
    """C fingers, each in a frame in which it feels something."""

    frame: Rows  # (C,)
    finger: Rows  # (C,)
    impulse: Array  # (C, 3) [N s] of all that presses on it
    press: Rows  # (C,) the strongest of `Presses`; -1: none
    other: Rows  # (C,) row of the packed poses of the body that this is; -1: none


class Track(NamedTuple):
    """P poses of a body in each of C cells."""

    R: Array  # (C, P, 3, 3)
    p: Array  # (C, P, 3)


def felt(track: TouchTrack) -> Touch:
    """What was felt in all rows of a recording."""
    pairs = {pair for row in track.rows for pair in row.pairs}
    objects = sorted({_object(track.pairs[pair]) for pair in pairs})
    found = _nothing(track, objects)
    # All frames have 15 steps, but the first has none, and one that has not ended has fewer.
    steps = np.array([len(row.wrenches) for row in track.rows])
    for n in sorted({*steps.tolist()} - {0}):
        frames = np.flatnonzero(steps == n)
        part = replace(track, rows=[track.rows[t] for t in frames])
        for key, values in _alike(part, objects).items():
            found[key][frames] = values
    arrays = {key: values.astype(np.float32) for key, values in found.items()}
    return Touch(track.fingers, tuple(objects), **arrays)


def felt_now(track: TouchTrack, row: TouchRow) -> Touch:
    """What is felt in one frame, T = 1."""
    return felt(replace(track, rows=[row]))


def _object(pair: Pair) -> str:
    first, second = pair.names
    return second if first in HANDS else first


def _nothing(track: TouchTrack, objects: Sequence[str]) -> dict[str, Array]:
    T, F = len(track.rows), len(track.fingers)
    scalars = {key: np.zeros((T, F)) for key in SCALARS}
    more = {"force": np.zeros((T, F, 3)), "pressed": np.zeros((T, F, len(objects)))}
    return {**scalars, **more, "margin": np.ones((T, F))}


def _alike(track: TouchTrack, objects: Sequence[str]) -> dict[str, Array]:
    """What is felt in frames that all have n steps."""
    n, found = len(track.rows[0].wrenches), _nothing(track, objects)
    presses, wrenches = _presses(track.rows), _wrenches(track)
    loaded = np.asarray((np.abs(wrenches) >= LEAST).any(axis=(2, 3)))
    cells = _cells(track, presses, loaded)
    _add_pressed(found["pressed"], track, presses, objects)
    at, poses = (cells.frame, cells.finger), _poses(track.rows)
    hand = _track(poses, cells.frame, np.array(track.bodies)[cells.finger])
    joints = track.joints[cells.finger]
    axis = np.einsum("cij,cj->ci", hand.R[:, -1], joints[:, :, 0])
    normal = _unit(cells.impulse, axis)
    turns = np.einsum("cpij,cjk->cpik", hand.R[:, 1:], joints)
    of_step = turns[:, np.arange(n) // POSE_STEPS]  # the finger's turn at the next pose
    force = np.einsum("ctij,ctj->cti", of_step, wrenches[at])
    along, across = _parts(force, normal)
    along = np.abs(along)
    found["force"][at] = force.mean(axis=1)
    for key, values in (("normal", along), ("tangential", across)):
        found[key][at], found[f"{key}_peak"][at] = values.mean(axis=1), values.max(axis=1)
    own, every = cells.press >= 0, track.friction[""]
    of_pair = np.array([track.friction.get(_object(pair), every) for pair in track.pairs])
    friction = np.full(own.shape, every)
    friction[own] = of_pair[presses.pair[cells.press[own]]]
    found["margin"][at] = np.where(own, _margin(along, across, friction), 1.0)

    slides = cells.other >= 0
    on = tuple(rows[slides] for rows in at)
    thing = _track(poses, on[0], cells.other[slides])
    touched = presses.point[cells.press[slides]]
    ways = _slip(Track(hand.R[slides], hand.p[slides]), thing, touched, normal[slides])
    ends = np.minimum(np.arange(poses.shape[1]) * POSE_STEPS, n)  # steps made at each pose
    found["slip"][on] = ways.sum(axis=1) * RATE / n
    found["slip_peak"][on] = (ways / np.diff(ends)).max(axis=1) * RATE
    return found


# ---- what the rows hold --------------------------------------------------------------------------


def _wrenches(track: TouchTrack) -> Array:
    """(T, F, n, 3) [N] on each finger, in its joint's frame."""
    shape = len(track.rows), len(track.rows[0].wrenches), len(track.links), 3
    found = np.concatenate([*chain.from_iterable(row.wrenches for row in track.rows)])
    by_step = found.reshape(shape[0] * shape[1], -1)
    columns = 6 * np.array(track.links)[:, None] + np.arange(3)
    forces = by_step.take(columns.ravel(), axis=1).reshape(shape)
    return forces.swapaxes(1, 2).astype(float, order="C")


def _poses(rows: Sequence[TouchRow]) -> NDArray[np.float32]:
    """(T, P, n, 7) wxyz + xyz of every body."""
    packed = b"".join([one for row in rows for one in row.packed])
    return np.frombuffer(packed, np.float32).reshape(len(rows), len(rows[0].packed), -1, 7)


def _presses(rows: Sequence[TouchRow]) -> Presses:
    counts = [len(row.pairs) for row in rows]
    pair = np.array([*chain.from_iterable(row.pairs for row in rows)], int)
    points = np.array([*chain.from_iterable(row.points for row in rows)], float)
    values = points.reshape(-1, 6)
    x, y, z = values[:, :3].T
    size = np.sqrt(x * x + y * y + z * z)
    frame = np.repeat(np.arange(len(rows)), counts)
    base = int(pair.max(initial=0)) + 1
    cells, group = np.unique(frame * base + pair, return_inverse=True)
    columns = (x, y, z, size, *(size * values[:, i] for i in (3, 4, 5)))
    # One after the other, in the order in which they were read.
    sums = np.array([np.bincount(group, each, len(cells)) for each in columns], float)
    strength, point = sums[3], (sums[4:] / sums[3]).T
    return Presses(cells // base, cells % base, sums[:3].T, strength, point)


def _hands(track: TouchTrack, presses: Presses) -> tuple[Rows, Rows, Rows]:
    """(H,) a press, the finger that it acts on, and the row of the body that presses there."""
    bodies = np.array([pair.bodies for pair in track.pairs], int).reshape(-1, 2)[presses.pair]
    press, side, finger = np.nonzero(bodies[:, :, None] == np.array(track.bodies))
    return press, finger, bodies[press, 1 - side]


def _cells(track: TouchTrack, presses: Presses, loaded: NDArray[np.bool_]) -> Cells:
    """
    Args:
        loaded: (T, F) more force is transmitted than a finger's own inertia takes.
    """
    press, finger, other = _hands(track, presses)
    frame = presses.frame[press]
    total = np.zeros((*loaded.shape, 3))
    np.add.at(total, (frame, finger), presses.impulse[press])
    strongest = np.full((*loaded.shape, 2), -1)
    order = np.lexsort((-press, presses.strength[press]))  # the first of equals comes last
    strongest[frame[order], finger[order]] = np.stack([press, other], axis=1)[order]
    at = frame, finger = np.nonzero((strongest[..., 0] >= 0) | loaded)
    press, other = strongest[at].T
    return Cells(frame, finger, total[at], press, other)


def _add_pressed(
    pressed: Array, track: TouchTrack, presses: Presses, objects: Sequence[str]
) -> None:
    """Adds the normal force of each finger on each object, (T, F, P)."""
    press, finger, _ = _hands(track, presses)
    # Of those that press elsewhere in the episode only there may be no column.
    names = map(_object, track.pairs)
    column = np.array([objects.index(name) if name in objects else -1 for name in names], int)
    at = presses.frame[press], finger, column[presses.pair[press]]
    np.add.at(pressed, at, presses.strength[press] * RATE)


def _track(poses: NDArray[np.float32], frame: Rows, body: Rows) -> Track:
    """Of a body in each cell, from rows of wxyz + xyz."""
    w, x, y, z, *position = np.moveaxis(poses[frame, :, body].astype(float), -1, 0)
    R = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return Track(np.moveaxis(np.array(R), (0, 1), (2, 3)), np.stack(position, axis=-1))


# ---- what is computed from them ------------------------------------------------------------------


def _unit(vectors: Array, otherwise: Array) -> Array:
    """(C, 3) along a vector; along the other where there is none."""
    some = np.where(vectors.any(axis=1, keepdims=True), vectors, otherwise)
    return some / np.linalg.norm(some, axis=1, keepdims=True)


def _parts(vectors: Array, normal: Array) -> tuple[Array, Array]:
    """Of (C, n, 3) vectors along a cell's normal, signed, and across it: (C, n) each."""
    along = np.einsum("cti,ci->ct", vectors, normal)
    return along, np.linalg.norm(vectors - along[:, :, None] * normal[:, None], axis=2)


def _margin(along: Array, across: Array, friction: Array) -> Array:
    """(C,) least of the steps in which a finger is loaded; 1 where there is none."""
    loaded = along > LEAST
    margin = 1 - across / (friction[:, None] * np.where(loaded, along, 1.0))
    least = np.where(loaded, margin, np.inf).min(axis=1)
    return np.where(loaded.any(axis=1), least, 1.0)


def _slip(finger: Track, thing: Track, point: Array, normal: Array) -> Array:
    """(C, P - 1) [m] by which a body's point under the pad moves past the pad, pose to pose.

    Args:
        point: (C, 3) where the pad is touched after the last step, world.
        normal: (C, 3) of the pad there; motion along it is no slip.
    """
    (R_F, p_F), (R_O, p_O) = finger, thing
    at = np.einsum("cji,cj->ci", R_F[:, -1], point - p_F[:, -1])  # in the finger's frame
    # The body's point that is there after a step: where, seen from the finger, was it before?
    world = np.einsum("cpij,cj->cpi", R_F[:, 1:], at) + p_F[:, 1:]
    own = np.einsum("cpji,cpj->cpi", R_O[:, 1:], world - p_O[:, 1:])
    was = np.einsum("cpij,cpj->cpi", R_O[:, :-1], own) + p_O[:, :-1]
    before = np.einsum("cpji,cpj->cpi", R_F[:, :-1], was - p_F[:, :-1])
    return _parts(at[:, None] - before, np.einsum("cji,cj->ci", R_F[:, -1], normal))[1]
