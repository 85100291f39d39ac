"""What the network is shown: small pictures, the command, and the physics labels if it may know.

Training and acting both come through here, so that they cannot differ.
"""

from collections.abc import Mapping

import cv2
import numpy as np
from numpy.typing import NDArray

from rtphys.data.jpeg import decode, encode
from rtphys.physics import Physics, attributes

PICTURES = {"head": (96, 128), "left": (48, 64), "right": (48, 64)}  # camera -> height, width [px]
SMALLEST = PICTURES["head"]  # pictures must be drawn at this size or larger

Pictures = dict[str, NDArray[np.uint8]]


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


def labels(physics: Physics) -> NDArray[np.float32]:
    """All attributes in a row, in alphabetical order; 0 for what is the asset's own (None)."""
    numbers: list[float] = []
    for key in sorted(attributes()):
        value = physics[key]
        if isinstance(value, tuple):
            numbers += value
        else:
            numbers.append(physics.scalar(key, 0.0))
    return np.array(numbers, np.float32)


def shrunk(images: Mapping[str, NDArray[np.uint8]]) -> Pictures:
    """All cameras of one instant of an episode, as a dataset would have stored them.

    A dataset's pictures have gone through JPEG. A network that was trained on them may fail on
    pictures that have not.
    """
    stored = {camera: decode(encode(images[camera])) for camera in PICTURES}
    return {camera: shrink(camera, picture) for camera, picture in stored.items()}
