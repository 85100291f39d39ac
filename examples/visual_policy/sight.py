"""What the network is shown: small pictures, the command, and what is felt.

Training and acting both come through here, so that they cannot differ.
"""

from collections.abc import Mapping
from typing import Literal

import cv2
import numpy as np
from numpy.typing import NDArray

from rtphys.assets.pack import default_pack
from rtphys.data.dataset import Episode
from rtphys.data.jpeg import decode, encode
from rtphys.episode import Observation

PICTURES = {"head": (96, 128), "left": (48, 64), "right": (48, 64)}  # camera -> height, width [px]
SMALLEST = PICTURES["head"]  # pictures must be drawn at this size or larger

# What fingers feel of force and slip. Their `margin` is left out: it is made with the label.
TOUCH = ("normal", "tangential", "slip")
FELT = 12 + 14 + 4 * len(TOUCH)  # numbers of a frame; of a robot with two arms of six joints

Pictures = dict[str, NDArray[np.uint8]]
Floats = NDArray[np.float32]
Sees = Literal["joints", "touch", "memory"]  # beside pictures; each also what those before it see
STRIDE, LOOKS = 8, 32  # frames between what is remembered, and how many: the last 15 s


def looks(sees: Sees) -> NDArray[np.intp]:
    """How many frames ago what is shown was felt, now first."""
    return STRIDE * np.arange(LOOKS if sees == "memory" else 1)


def shrink(camera: str, picture: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """A camera's picture (H, W, 3) at the network's size, each pixel the mean of what it covers.

    Raises:
        ValueError: the picture is smaller than the network's, or has another shape.
    """
    height, width = PICTURES[camera]
    if picture.shape[0] < height or picture.shape[0] * width != picture.shape[1] * height:
        drawn = f"{picture.shape[1]}x{picture.shape[0]}"
        raise ValueError(f"camera {camera}: pictures of {drawn}, the network needs 4:3, {width} up")
    if picture.shape[:2] == (height, width):
        return picture
    return np.asarray(cv2.resize(picture, (width, height), interpolation=cv2.INTER_AREA), np.uint8)


def shrunk(images: Mapping[str, NDArray[np.uint8]]) -> Pictures:
    """All cameras of one instant of an episode, as a dataset would have stored them.

    A dataset's pictures have gone through JPEG. A network that was trained on them may fail on
    pictures that have not.
    """
    stored = {camera: decode(encode(images[camera])) for camera in PICTURES}
    return {camera: shrink(camera, picture) for camera, picture in stored.items()}


def felt(observation: Observation) -> Floats:
    """What is felt at one instant (FELT,), as `felt_frames` has it."""
    arms, touch = _arm_columns(), observation.touch
    if touch is None:
        raise ValueError("the network was trained with touch: evaluate --sense touch")
    lag = (observation.vector - observation.measured)[arms]
    fingers = [getattr(touch, name)[0] for name in TOUCH]
    return np.concatenate([lag, observation.efforts, *fingers]).astype(np.float32)


def felt_frames(episode: Episode) -> Floats:
    """What is felt in every frame of an episode (T, FELT).

    How far each arm joint is behind its command [rad], efforts [N m, of fingers N], and force
    along and across [N] and slip [m/s] of each finger.
    """
    frames, touch = episode.frames, episode.senses.touch()
    limbs = sorted(default_pack().embodiment(episode.embodiment).limbs, key=lambda limb: limb.side)
    arms = [[frames.joint_names.index(name) for name in limb.joints] for limb in limbs]
    fingers = [[frames.joint_names.index(name) for name in limb.finger_joints] for limb in limbs]
    lag = frames.vector[:, _arm_columns()] - frames.qpos[:, [*arms[0], *arms[1]]]
    efforts = [
        np.column_stack([frames.effort[:, own], frames.effort[:, hand].mean(axis=1)])
        for own, hand in zip(arms, fingers, strict=True)
    ]
    parts = [lag, *efforts, *(getattr(touch, name) for name in TOUCH)]
    return np.concatenate(parts, axis=1).astype(np.float32)


def _arm_columns() -> list[int]:
    return [*range(6), *range(7, 13)]
