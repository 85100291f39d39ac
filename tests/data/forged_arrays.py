"""Changes of an episode's arrays and pictures, for datasets that lie."""

from dataclasses import replace

import cv2
import numpy as np
from forger import HEAD

from rtphys.data.encode import EncodedImages
from rtphys.data.episode import CameraFrames, Frames


def turned(frames: Frames, images: EncodedImages) -> Frames:
    """The head camera hangs 2 cm elsewhere, by its calibration."""
    camera = frames.cameras[HEAD]
    gl = camera.cam2world_gl.copy()
    gl[:, 0, 3] += 0.02
    extrinsic = np.linalg.inv(gl @ np.diag([1.0, -1, -1, 1]))[:, :3].astype(np.float32)
    return replace(frames, cameras={HEAD: CameraFrames(camera.intrinsic_cv, extrinsic, gl)})


def renamed(frames: Frames, images: EncodedImages) -> Frames:
    names = dict(
        zip(sorted(frames.object_poses), sorted(frames.object_poses, reverse=True), strict=True)
    )
    poses = {names[name]: pose for name, pose in frames.object_poses.items()}
    touched = {names[name]: touch for name, touch in frames.contacts.items()}
    return replace(frames, object_poses=poses, contacts=touched)


def flipped(frames: Frames, images: EncodedImages) -> Frames:
    first = min(frames.contacts)
    return replace(frames, contacts={**frames.contacts, first: ~frames.contacts[first]})


def pushed(frames: Frames, images: EncodedImages) -> Frames:
    first = min(frames.object_poses)
    pose = frames.object_poses[first].copy()
    pose[:, 0] += 1e-3
    return replace(frames, object_poses={**frames.object_poses, first: pose})


def patch(index: int, rgb: np.ndarray) -> np.ndarray:
    """A sticker of 8 x 8 pixels in one picture, 0.1 % of it."""
    changed = rgb.copy()
    if index == 20:
        changed[100:108, 100:108] = 0
    return changed


def darker(index: int, rgb: np.ndarray) -> np.ndarray:
    return (rgb * 0.7).astype(np.uint8)


def worse(index: int, rgb: np.ndarray) -> bytes:
    done, stream = cv2.imencode(".jpg", rgb, [cv2.IMWRITE_JPEG_QUALITY, 20])
    assert done
    return stream.tobytes()
