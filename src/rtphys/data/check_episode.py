"""Checks that an episode's four files are sound, and agree with each other and the manifest."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import IntEnum
from pathlib import Path

import h5py
import numpy as np

from rtphys.assets.embodiment import ALOHA_LIMITS
from rtphys.assets.pack import Pack
from rtphys.core.errors import BadFile, RtphysError
from rtphys.core.poses import quat_to_matrix
from rtphys.data import files, jpeg, schema, video
from rtphys.data.attempts import Accepted, Rejected, Row
from rtphys.data.episode import FRAME_RATE, FRAME_STEPS, Frames
from rtphys.data.hdf5_episode import (
    CLOUDS,
    FORMAT_VERSION,
    derived,
    read_frames,
    read_pictures,
)
from rtphys.data.hdf5_file import array, holds, note, open_read, text, texts
from rtphys.data.hdf5_senses import declared, read_names, sense_streams
from rtphys.data.layout import EMBODIMENT, EpisodePaths, embodiment_folder
from rtphys.data.schema import FailureMeta, Instructions, PhysMeta
from rtphys.data.video import VIDEO_CAMERA
from rtphys.senses import SENSES
from rtphys.spec.collection import TaskHeader
from rtphys.spec.stored import differences, stored

PERIOD = float(1 / FRAME_RATE)  # [s] between two frames
UNIT_QUATERNION = 1e-3  # how far a stored quaternion's length may be from 1
RIGID = 1e-4  # [m] and [1]: calibration is stored in single precision
LIMIT_SLACK = 1e-6  # [rad]
AT_REST = 0.005  # [m] that an untouched object may creep while it comes to rest
WRIST = {"left": "left_camera", "right": "right_camera"}
GL_FROM_CV = np.diag([1.0, -1.0, -1.0, 1.0])


@dataclass(frozen=True)
class Problem:
    """One thing that is wrong."""

    path: Path
    text: str

    def __str__(self) -> str:
        return f"{self.path}: {self.text}"


class Effort(IntEnum):
    """How thorough a verification is."""

    QUICK = 0  # pictures by their first and last bytes
    NORMAL = 1  # every picture decoded
    DEEP = 2  # every video decoded too, and whether it all makes physical sense


@dataclass(frozen=True)
class Hdf5Facts:
    """What a file holds, for comparison with the episode's other files."""

    problems: tuple[str, ...]
    frames: Frames | None = None
    seen: tuple[str, ...] = ()
    shapes: Mapping[str, tuple[int, int, int]] = field(default_factory=dict)  # of pictures
    senses: tuple[str, ...] = ()  # held beyond colours


def check_episode(
    paths: EpisodePaths,
    header: TaskHeader,
    row: Row,
    effort: Effort,
    pack: Pack | None,
) -> tuple[PhysMeta | None, list[Problem]]:
    """The label, when it is readable, and what is wrong.

    Args:
        header, row: what the ledger says of it.
        pack: the asset pack of the collection, which knows its robot; None: it is not here.
    """
    spec = header.spec
    facts = check_hdf5(paths.hdf5, spec.recording.layout, decode=effort >= Effort.NORMAL)
    frames, meta = facts.frames, None
    wrong: dict[Path, list[str]] = {path: [] for path in paths.all()}
    wrong[paths.hdf5] += facts.problems
    try:
        count = video.frame_count(files.read(paths.video))
        if frames is not None and count != len(frames):
            wrong[paths.video].append(f"has {count} frames for {len(frames)} recorded ones")
    except (BadFile, video.BadVideo) as error:
        wrong[paths.video].append(getattr(error, "problem", str(error)))
    try:
        words = schema.read(Instructions, paths.instruction)
        if facts.seen and words.seen not in ([], [*facts.seen]):
            wrong[paths.instruction].append("its sentences are not those in the HDF5 file")
    except BadFile as error:
        wrong[paths.instruction].append(error.problem)
    try:
        kind = FailureMeta if isinstance(row, Rejected) else PhysMeta
        meta = schema.read(kind, paths.phys_meta)
        wrong[paths.phys_meta] += _check_meta(meta, header, row)
    except BadFile as error:
        wrong[paths.phys_meta].append(error.problem)
    if meta is not None and frames is not None:
        if set(meta.cameras) - set(spec.recording.official):
            wrong[paths.phys_meta].append("names cameras that were not recorded")
        wrong[paths.hdf5] += _check_recording(facts, frames, header, row, pack)
        if effort is Effort.DEEP and not facts.problems:
            wrong[paths.hdf5] += check_meaning(frames, meta, spec.episode.embodiment)
            if shape := facts.shapes.get(VIDEO_CAMERA):
                wrong[paths.video] += check_video(paths.video, len(frames), shape)
    return meta, [Problem(path, text) for path, texts in wrong.items() for text in texts]


def _check_meta(meta: PhysMeta, header: TaskHeader, row: Row) -> list[str]:
    spec, verdict, domain = header.spec, meta.verdict, header.resolved.domain
    pairs: dict[str, tuple[object, object]] = {
        "episode": (meta.episode, row.on_disk and row.on_disk.number),
        "seed": (meta.seed, row.seed),
        "task": (meta.task, spec.episode.task),
        "protocol": (meta.protocol, spec.episode.protocol),
        "domain": (meta.domain.model_dump(), {key: domain.get(key) for key in ("name", "digest")}),
        "verdict.accepted": (verdict.accepted, isinstance(row, Accepted)),
    }
    if isinstance(row, Accepted):
        pairs["verdict.recovered"] = (verdict.recovered, row.recovered and spec.episode.recovery)
        acting = {key: label.value for key, label in meta.attributes.items() if label.could_act}
        for key in sorted({*acting, *row.physics}):
            pairs[f"attributes.{key}"] = (acting.get(key), row.physics.get(key))
    elif isinstance(meta, FailureMeta) and row.kept is not None:
        pairs["failure.reason"] = (meta.failure.reason, row.reason)
        pairs["failure.event"] = (meta.failure.event, row.kept.event)
        pairs["failure.time"] = (meta.failure.time, row.kept.time)
    problems = [
        f"{key} is {found!r}, the ledger says {expected!r}"
        for key, (found, expected) in pairs.items()
        if found != expected
    ]
    clauses = differences(stored(spec.episode.at(row.seed)), meta.recipe)
    return problems + [f"recipe is not the ledger's: {clause}" for clause in clauses]


def _check_recording(
    facts: Hdf5Facts,
    frames: Frames,
    header: TaskHeader,
    row: Row,
    pack: Pack | None,
) -> list[str]:
    """Length, robot, senses, and sizes of pictures where the ledger names one."""
    recording, problems = header.spec.recording, list[str]()
    if row.on_disk is not None and row.on_disk.frames != len(frames):
        problems.append(f"has {len(frames)} frames, the ledger says {row.on_disk.frames}")
    problems += _other_robot(frames, header.spec.episode.embodiment, pack)
    if recording.senses != facts.senses:
        problems.append(f"holds senses {facts.senses}, the manifest says {recording.senses}")
    if recording.camera_type is not None or recording.size is not None:
        width, height, _ = recording.optics("D435")
        problems += [
            f"{name} is {shape[1]}x{shape[0]}, not {width}x{height}"
            for name, shape in facts.shapes.items()
            if shape[:2] != (height, width)
        ]
    return problems


def _other_robot(frames: Frames, name: str, pack: Pack | None) -> list[str]:
    """Why the joints cannot be those of the spec's robot; the aloha needs no pack for it."""
    per_arm, usual = frames.layout.per_arm, len(ALOHA_LIMITS)
    if embodiment_folder(name) == EMBODIMENT and per_arm != (usual, usual):
        other = next(joints for joints in per_arm if joints != usual)
        return [f"an arm has {other} joints, not {usual}: it is not the aloha's"]
    if pack is None:
        return []
    try:
        robot = pack.embodiment(name)
    except RtphysError:  # of a library that is not here
        return []
    if per_arm != (own := robot.action_layout.per_arm):
        return [f"its arms have {per_arm} joints, those of {name} have {own}"]
    known = {joint for limb in robot.limbs for joint in (*limb.joints, *limb.finger_joints)}
    if missing := sorted(known - {*frames.joint_names}):
        return [f"has no joint {missing[0]!r}: it is not of the robot {name}"]
    return []


def check_hdf5(path: Path, layout: str, *, decode: bool) -> Hdf5Facts:
    """Reads a whole file. `decode`: every picture, not only its first and last bytes."""
    try:
        with open_read(path) as file:
            return _facts(file, layout, decode)
    except BadFile as error:  # also what HDF5 itself raises
        return Hdf5Facts((error.problem,))


def _facts(file: h5py.File, layout: str, decode: bool) -> Hdf5Facts:
    frames = read_frames(file, layout)
    expected, seen, problems = derived(frames, layout), tuple[str, ...](), list[str]()
    if layout == "native":
        if not (seen := texts(text(file, "instructions"), file)):
            raise ValueError("it has no sentence")
        frequency = int(array(file, "additional_info/frequency"))
        constants = {
            "source_format": (note(file, "source_format"), "RoboTwin"),
            "data_format_version": (text(file, "data_format_version"), FORMAT_VERSION),
            "additional_info/frequency": (frequency, FRAME_STEPS),
            "instruction": (text(file, "instruction"), seen[0]),
        }
        problems += [f"{key} is {a!r}, not {b!r}" for key, (a, b) in constants.items() if a != b]
    elif CLOUDS in declared(file):  # which then are checked by themselves
        del expected[CLOUDS]
    for key, value in expected.items():
        if not holds(file, key):
            problems.append(f"{key} is missing")
            continue
        found = array(file, key)
        if (found.dtype, found.shape) != (value.dtype, value.shape):
            is_, should = f"{found.dtype} {found.shape}", f"{value.dtype} {value.shape}"
            problems.append(f"{key} is {is_}, not {should}")
        elif not np.array_equal(found, value):
            problems.append(f"{key} differs from the recorded frames")
    shapes: dict[str, tuple[int, int, int]] = {}
    for name in frames.cameras:  # one at a time, so that the memory of one serves the next
        streams, shapes[name] = read_pictures(file, layout, name)
        if len(streams) != len(frames):
            problems.append(f"{name} has {len(streams)} pictures for {len(frames)} frames")
        for index, stream in enumerate(streams):
            whole = decode or index in (0, len(streams) - 1)
            if problem := _picture_problem(stream, shapes[name], layout, whole):
                problems.append(f"{name} picture {index} {problem}")
    sensed, senses = _check_senses(file, layout, frames, shapes, decode)
    problems += sensed
    return Hdf5Facts((*problems, *_motion(frames)), frames, seen, shapes, senses)


def _picture_problem(stream: bytes, shape: tuple[int, ...], layout: str, decode: bool) -> str:
    if not (stream.startswith(b"\xff\xd8") and stream.endswith(b"\xff\xd9")):
        return "is no whole JPEG stream"
    if not decode:
        return ""
    try:
        if (stated := jpeg.shape_of(stream)) != shape:
            return f"is {stated}, not {shape}"
        jpeg.decode(stream)
    except jpeg.BadImage:
        return "does not decode"
    if jpeg.marked(stream) == (layout == "native"):
        return ""
    return "is not marked as standard RGB" if layout == "native" else "is marked XPL-RGB1"


def _motion(frames: Frames) -> list[str]:
    problems = []
    steps = np.diff(frames.time)
    if not np.allclose(steps, PERIOD, atol=1e-6):
        problems.append(f"frames are {steps.min():g} to {steps.max():g} s apart, not {PERIOD:g}")
    poses = {"left_endpose": frames.left_endpose, "right_endpose": frames.right_endpose}
    poses |= {f"object_poses/{name}": pose for name, pose in frames.object_poses.items()}
    for name, pose in poses.items():
        lengths = np.linalg.norm(pose[:, 3:], axis=1)
        if np.abs(lengths - 1).max() > UNIT_QUATERNION:
            problems.append(f"{name} holds quaternions that are not of unit length")
    for arm, opening in (("left", frames.left_gripper), ("right", frames.right_gripper)):
        if opening.min() < 0 or opening.max() > 1:
            problems.append(f"{arm}_gripper leaves 0..1")
    return problems


def _check_senses(
    file: h5py.File, layout: str, frames: Frames, shapes: Mapping[str, tuple[int, ...]], every: bool
) -> tuple[list[str], tuple[str, ...]]:
    """What is wrong, and the senses that the file says it holds.

    Args:
        shapes: (H, W, 3) of each camera's pictures.
        every: look at every frame, not only at the first and the last.
    """
    senses, T = declared(file), len(frames)
    problems = [f"{name!r} is no sense" for name in senses if name not in SENSES]
    counts = {kind: len(names) for kind, names in read_names(file, {*senses} & {*SENSES}).items()}
    chosen = range(T) if every else sorted({0, T - 1})
    for stream in sense_streams(SENSES, layout, shapes):
        key = stream.rows.key
        if stream.sense.name not in senses:
            if holds(file, key) and key != CLOUDS:
                problems.append(f"{key} is there, and {stream.sense.name} is not declared")
            continue
        height, width, _ = shapes.get(stream.camera, (0, 0, 0))
        try:
            problems += stream.problems(file, {"H": height, "W": width, **counts}, T, chosen)
        except KeyError:
            problems.append(f"{key} is missing")
    return problems, senses


def check_meaning(frames: Frames, meta: PhysMeta, embodiment: str) -> list[str]:
    """One sentence for each thing that no real recording would hold."""
    problems = _cameras(frames)
    low, high = np.asarray(ALOHA_LIMITS, float).T
    aloha = embodiment_folder(embodiment) == EMBODIMENT
    if aloha and frames.layout.per_arm == (len(low), len(low)):  # else `_other_robot` says so
        for arm in ("left", "right"):
            targets = getattr(frames, f"{arm}_arm")
            outside = (targets < low - LIMIT_SLACK) | (targets > high + LIMIT_SLACK)
            for joint in np.flatnonzero(outside.any(axis=0)):
                t = int(outside[:, joint].argmax())
                value = f"{targets[t, joint]:.4f} rad at frame {t}"
                problems.append(f"target of {arm} joint {joint + 1} leaves its limits: {value}")
    # Without an external force nothing moves before a gripper first touches something. Afterwards
    # anything may: objects fall, roll, and hit each other.
    force = meta.attributes.get("external_force")
    if force is None or force.value in (None, 0, 0.0):
        touched = np.zeros(len(frames), bool)
        for contact in frames.contacts.values():
            touched |= contact.any(axis=1)
        first = int(touched.argmax()) if touched.any() else len(frames)
        still = max(first - 1, 0)  # the touch may begin just after the frame before
        for name, pose in frames.object_poses.items():
            if still > 1 and (moved := float(np.ptp(pose[:still, :3], axis=0).max())) > AT_REST:
                problems.append(f"{name} moves {moved * 1000:.1f} mm before anything touches it")
    return problems


def _cameras(frames: Frames) -> list[str]:
    problems: list[str] = []
    # A wrist camera is bolted to the link of the ee frame: its pose seen from there never changes.
    for arm, camera in WRIST.items():
        if camera in frames.cameras:
            poses = getattr(frames, f"{arm}_endpose")
            X_WE = np.tile(np.eye(4), (len(poses), 1, 1))
            X_WE[:, :3, :3] = [quat_to_matrix(q) for q in poses[:, 3:]]
            X_WE[:, :3, 3] = poses[:, :3]
            X_EC = np.linalg.inv(X_WE) @ frames.cameras[camera].cam2world_gl
            if (drift := float(np.ptp(X_EC, axis=0).max())) > RIGID:
                problems.append(f"{camera} moves by {drift:.2g} against the {arm} end-effector")
    # The two pose matrices of a camera are one pose in two conventions.
    for name, one in frames.cameras.items():
        again = np.linalg.inv(np.asarray(one.cam2world_gl, float) @ GL_FROM_CV)[:, :3]
        if (gap := float(np.abs(again - one.extrinsic_cv).max())) > RIGID:
            problems.append(f"{name}: extrinsic_cv and cam2world_gl disagree by {gap:.2g}")
    return problems


def check_video(path: Path, frames: int, size: tuple[int, ...]) -> list[str]:
    """Decodes every picture. `size`: height and width of the head camera first [px]."""
    try:
        facts = video.probe(files.read(path), frames + 1)
    except video.BadVideo as error:
        return [str(error)]
    expected = video.VideoFacts("h264", size[1], size[0], float(video.FPS), frames)
    return [] if facts == expected else [f"is {facts}, not {expected}"]
