"""The official XPolicyLab v1.0 file as RoboTwin's own collector writes it, and a little more.

Rows R = T - 1: state row t is frame t, action row t is frame t + 1. Beyond the official keys: the
scalar `instruction` that several readers need, and the group `rtphys/` (see `hdf5_record`) with
`rtphys/last/<camera>`, the picture that the shifted layout drops.
"""

import json
from collections.abc import Mapping, Sequence

import h5py
import numpy as np

from rtphys.data import jpeg
from rtphys.data.encode import EncodedImages
from rtphys.data.episode import ARMS, FRAME_STEPS, Frames
from rtphys.data.hdf5_file import array, build, group, put, text
from rtphys.data.hdf5_record import GROUP, read_record, write_record
from rtphys.errors import BadFile

FORMAT_VERSION = "v1.0"
CAMERA_KEYS = {
    "head_camera": "cam_head",
    "left_camera": "cam_left_wrist",
    "right_camera": "cam_right_wrist",
    "front_camera": "cam_third_view",
}


def native_bytes(
    frames: Frames, images: EncodedImages, instructions: Mapping[str, Sequence[str]], fallback: str
) -> bytes:
    """The file's bytes. `fallback` is the sentence when `seen` is empty (official: task name)."""

    def fill(file: h5py.File) -> None:
        file.attrs["source_format"] = "RoboTwin"
        file.attrs["source_path"] = "native_collection"
        sentences = list(instructions.get("seen") or [fallback])
        put(file, "data_format_version", FORMAT_VERSION)
        put(file, "instruction", sentences[0])
        put(file, "instructions", json.dumps(sentences, ensure_ascii=False))
        put(file, "additional_info/frequency", np.int32(FRAME_STEPS))
        for part, rows in (("state", slice(0, -1)), ("action", slice(1, None))):
            _write_motion(file.create_group(part), frames, rows)
        write_record(file, frames)
        for name in images.jpegs:
            _write_camera(file, name, frames, images)

    return build(fill)


def _write_motion(part: h5py.Group, frames: Frames, rows: slice) -> None:
    for arm in ARMS:
        joints = np.asarray(getattr(frames, f"{arm}_arm"), np.float32)[rows]
        opening = np.asarray(getattr(frames, f"{arm}_gripper"), np.float32)[rows, None]
        pose = np.asarray(getattr(frames, f"{arm}_endpose"), np.float32)[rows]
        put(part, f"{arm}_arm_joint_states", joints)
        put(part, f"{arm}_ee_joint_states", opening)  # (R, 1) in native files, not (R,)
        put(part, f"{arm}_ee_poses", pose)


def _write_camera(file: h5py.File, name: str, frames: Frames, images: EncodedImages) -> None:
    vision = file.create_group(f"vision/{CAMERA_KEYS[name]}")
    streams, camera = images.jpegs[name], frames.cameras[name]
    put(vision, "colors", jpeg.padded(streams[:-1]), {"channel_order": jpeg.CHANNEL_ORDER})
    put(vision, "shape", np.array(images.shapes[name], np.int32))
    put(vision, "intrinsic_matrix", np.asarray(camera.intrinsic_cv, np.float32)[:-1])
    # Named `extrinsics` but holding the OpenGL camera-to-world pose, as upstream has it.
    put(vision, "extrinsics_matrix", np.asarray(camera.cam2world_gl, np.float32)[:-1])
    last = {"channel_order": jpeg.CHANNEL_ORDER}
    put(file, f"{GROUP}/last/{name}", np.bytes_(streams[-1]), last)


def read_native(file: h5py.File) -> tuple[Frames, EncodedImages, dict[str, list[str]]]:
    """Frames, T pictures a camera and the seen instructions. Raises `BadFile`."""
    frames = read_record(file)
    images = EncodedImages()
    try:
        for name in frames.cameras:
            vision = group(file, f"vision/{CAMERA_KEYS[name]}")
            streams = array(vision, "colors").tolist()
            images.jpegs[name] = [*streams, array(file, f"{GROUP}/last/{name}").item()]
            height, width, depth = (int(n) for n in array(vision, "shape"))
            images.shapes[name] = (height, width, depth)
        seen = json.loads(text(file, "instructions"))
    except (KeyError, ValueError, TypeError, OSError) as error:
        raise BadFile(file.filename, f"not a whole native file ({error})") from error
    return frames, images, {"seen": seen}
