"""One episode in memory: what the recorder filled, what files hold, what a loader returns."""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from rtphys.assets.action_layout import ActionLayout
from rtphys.core.errors import BadFile, shortened
from rtphys.senses import SENSES, Arrays
from rtphys.senses.sense import Array
from rtphys.spec import recording

Floats: TypeAlias = NDArray[np.floating]
Images: TypeAlias = Mapping[str, NDArray[np.uint8]]  # camera name -> (H, W, 3) RGB
Track: TypeAlias = Sequence[Array] | Array  # T frames of a field of a sense

ARMS = ("left", "right")
NATIVE = ("cam_head", "cam_left_wrist", "cam_right_wrist", "cam_third_view")
CAMERAS = tuple(recording.CAMERAS.values())  # official names
CAMERA_KEYS = dict(zip(CAMERAS, NATIVE, strict=True))  # official name -> that in the native layout
ALOHA = ("cam_high", "cam_left_wrist", "cam_right_wrist", "cam_low")
CAMERA_NAMES = {  # naming of an export and of those who learn from it -> official name -> its name
    "aloha": dict(zip(CAMERAS, ALOHA, strict=True)),
    "robotwin": dict(zip(CAMERAS, CAMERAS, strict=True)),
}
OBJECT = re.compile(r"[^/.][^/]*")  # an HDF5 link name
FRAME_STEPS = 15  # control steps between two frames
FRAME_RATE = Fraction(250, FRAME_STEPS)  # [Hz] of frames, 0.06 s apart


def official_camera(name: str) -> str:
    """RoboTwin's name of a camera: `head` and `head_camera` are the same one."""
    return f"{name}_camera" if f"{name}_camera" in CAMERAS else name


@dataclass(frozen=True, eq=False)
class CameraFrames:
    """Calibration of one camera over T frames."""

    intrinsic_cv: Floats  # (T, 3, 3) [px]
    extrinsic_cv: Floats  # (T, 3, 4) world -> camera, OpenCV axes (x right, y down, z forward) [m]
    cam2world_gl: Floats  # (T, 4, 4) camera -> world, OpenGL axes (x right, y up, z back) [m]


@dataclass(frozen=True, eq=False)
class Frames:
    """T frames, uniformly spaced by 15 control steps. Poses are xyz [m] + wxyz, world frame."""

    time: Floats  # (T,) since the policy stage began [s]
    left_arm: Floats  # (T, k) commanded targets of an arm's k joints [rad]
    right_arm: Floats  # (T, k) [rad]
    left_gripper: Floats  # (T,) commanded opening, 0 closed .. 1 open
    right_gripper: Floats  # (T,)
    left_endpose: Floats  # (T, 7) measured pose of the ee frame
    right_endpose: Floats  # (T, 7)
    qpos: Floats  # (T, n) measured [rad or m]
    qvel: Floats  # (T, n) measured [rad/s or m/s]
    # (T, n) what each joint exerts along its axis, measured [N m or N]; the robot's own weight is
    # compensated and not in it.
    effort: Floats
    joint_names: tuple[str, ...]  # n names
    object_poses: Mapping[str, Floats]  # name -> (T, 7)
    contacts: Mapping[str, NDArray[np.bool_]]  # name -> (T, 2), touched by (left, right) gripper
    stage: NDArray[np.integer]  # (T,) index into `stages`
    stages: tuple[str, ...]  # the expert's, in order
    cameras: Mapping[str, CameraFrames]  # by official name: head_camera, left_camera, ...

    def __len__(self) -> int:
        return len(self.time)

    @property
    def layout(self) -> ActionLayout:
        """Where each arm and gripper stands in `vector`."""
        return ActionLayout(self.left_arm.shape[-1], self.right_arm.shape[-1])

    @property
    def vector(self) -> NDArray[np.float64]:
        """(T, N) commanded: left arm, left gripper, right arm, right gripper (see `layout`)."""
        return np.column_stack(
            [self.left_arm, self.left_gripper, self.right_arm, self.right_gripper]
        ).astype(np.float64)

    def shapes(self) -> dict[str, tuple[NDArray[np.generic], tuple[int, ...]]]:
        """Every array by name with the shape it must have."""
        left, right = self.layout.per_arm
        n = len(self.joint_names)
        own = {"time": (), "left_arm": (left,), "left_gripper": (), "left_endpose": (7,)}
        own |= {"right_arm": (right,), "right_gripper": (), "right_endpose": (7,)}
        own |= {"qpos": (n,), "qvel": (n,), "effort": (n,), "stage": ()}
        found = {key: (getattr(self, key), shape) for key, shape in own.items()}
        found |= {f"object_poses/{name}": (pose, (7,)) for name, pose in self.object_poses.items()}
        found |= {f"contacts/{name}": (touch, (2,)) for name, touch in self.contacts.items()}
        matrices = {"intrinsic_cv": (3, 3), "extrinsic_cv": (3, 4), "cam2world_gl": (4, 4)}
        for name, camera in self.cameras.items():
            for key, shape in matrices.items():
                found[f"cameras/{name}/{key}"] = (getattr(camera, key), shape)
        return {key: (array, (len(self), *shape)) for key, (array, shape) in found.items()}

    def problems(self) -> list[str]:
        """What is wrong with the arrays, one sentence each; empty when they agree."""
        problems: list[str] = []
        if len(self) < 2:
            problems.append(f"{len(self)} frames, a stored episode needs at least 2")
        for key, (array, shape) in self.shapes().items():
            if array.shape != shape:
                problems.append(f"{key} has shape {array.shape}, not {shape}")
            elif array.dtype.kind == "f" and not np.isfinite(array).all():
                problems.append(f"{key} holds a number that is not finite")
        objects = {**self.object_poses, **self.contacts}
        misnamed = [name for name in objects if not OBJECT.fullmatch(name)]
        problems += [f"{name!r} is no object name" for name in misnamed]
        if self.stage.size and not (0 <= self.stage.min() <= self.stage.max() < len(self.stages)):
            problems.append(f"stage runs outside the {len(self.stages)} named stages")
        problems += [f"{name!r} is no camera" for name in self.cameras if name not in CAMERAS]
        return problems

    def check(self, path: str | Path) -> None:
        """Raises `BadFile` when the arrays of a file contradict each other."""
        try:
            found = self.problems()
        except (AttributeError, IndexError, TypeError, ValueError) as error:
            found = [f"its arrays do not fit together: {error}"]
        if found:
            raise BadFile(path, shortened("; ".join(found)))


@dataclass(eq=False)
class Sensed:
    """What was sensed beyond colours: T frames of each sense that was asked for."""

    senses: tuple[str, ...]  # names in `rtphys.senses`
    # (field, camera) -> its T frames; the camera is empty but for a sense of every pixel.
    tracks: dict[tuple[str, str], Track] = field(default_factory=dict)
    names: dict[str, tuple[str, ...]] = field(default_factory=dict)  # by kind: "actor", "finger"

    def keep(self, camera: str, arrays: Arrays) -> None:
        """Append a frame: what the senses captured of a camera, by field."""
        for name in self.senses:
            for each in SENSES[name].fields:
                if each.name in arrays:
                    place = each.name, camera if SENSES[name].scope == "pixel" else ""
                    track = self.tracks.setdefault(place, [])
                    assert isinstance(track, list)
                    track.append(arrays[each.name])


@dataclass(frozen=True, eq=False)
class Episode:
    """An episode, or a failure that is kept, on its way to disk.

    `images` is consumed once, T items in frame order, so that frame t + 1 renders while frame t is
    encoded. Each item needs fresh arrays: a buffer that the renderer overwrites would tear.
    """

    recipe: Mapping[str, object]
    frames: Frames
    phys_meta: Mapping[str, object]  # schema.PhysMeta without `episode`, which commit knows
    instructions: Mapping[str, Sequence[str]]  # {"seen": [...], "unseen": [...]}
    scene_info: Mapping[str, object]  # one entry: cluttered_table_info, texture_info, info
    images: Iterable[Images] = field(repr=False)
    sensed: Sensed | None = None  # complete once `images` is consumed
