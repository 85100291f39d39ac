"""Tracks of a hand and a cup whose story is known, for the tests of failures and of holds."""

import numpy as np

from rtphys.data.episode import Frames
from rtphys.episode.failure import went_wrong

T = 60
SHUT = 20  # frame in which the left hand has closed
LIFT = 30  # first frame of the lift


def frames_of(cup: np.ndarray, touched: np.ndarray, opening: np.ndarray | None = None) -> Frames:
    """A left hand comes down, closes and lifts by 1 cm a frame; the right one does nothing."""
    hand = np.tile([0.0, 0, 0.9, 1, 0, 0, 0], (T, 1))
    hand[:, 2] += np.clip(np.arange(T) - LIFT, 0, None) * 0.01
    closing = np.interp(np.arange(T), [SHUT - 8, SHUT], [1.0, 0.0])
    still, nothing = np.zeros((T, 0)), np.zeros(T, bool)
    return Frames(
        time=np.arange(T) * 0.06,
        left_arm=np.zeros((T, 6)),
        right_arm=np.zeros((T, 6)),
        left_gripper=closing if opening is None else opening,
        right_gripper=np.ones(T),
        left_endpose=hand,
        right_endpose=np.tile([9.0, 0, 0, 1, 0, 0, 0], (T, 1)),
        qpos=still,
        qvel=still,
        effort=still,
        joint_names=(),
        object_poses={"cup": cup, "clutter0": np.tile([5.0, 0, 0, 1, 0, 0, 0], (T, 1))},
        contacts={
            "cup": np.column_stack([touched, nothing]),
            "clutter0": np.zeros((T, 2), bool),
        },
        stage=np.zeros(T, int),
        stages=("start",),
        cameras={},
    )


def resting() -> np.ndarray:
    return np.tile([0.0, 0, 0.8, 1, 0, 0, 0], (T, 1))


def lifted(until: int) -> np.ndarray:
    """In the hand until a frame, then on the table again."""
    cup = resting()
    rise = np.clip(np.arange(T) - LIFT, 0, None) * 0.01
    cup[:until, 2] += rise[:until]
    return cup


def during(first: int, last: int) -> np.ndarray:
    return (np.arange(T) >= first) & (np.arange(T) <= last)


def mark(frames: Frames, reason: str, detail: str = "") -> tuple[str, int, str, str]:
    instant = went_wrong(frames, reason, detail, ["clutter0"])
    return instant.event, instant.frame, instant.object, instant.side
