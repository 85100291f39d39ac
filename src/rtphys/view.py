"""An episode as a Rerun recording: cameras, moving solids, forces, joints, labels, stages."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from uuid import uuid4

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from rtphys.core.poses import Array
from rtphys.core.untrusted import hidden
from rtphys.data import files
from rtphys.data.dataset import Episode
from rtphys.data.episode import ARMS, Frames
from rtphys.episode.solids import Solid3D
from rtphys.report.pictures import panels
from rtphys.senses.touch import Touch

APPLICATION = "rtphys"
VERSION = rr.__version__  # a viewer of another one may not read it
TIME, FRAME = "time", "frame"  # names of the timelines
METRES_PER_NEWTON = 0.005  # length of a force's arrow
COLOURS = {"room": (150, 140, 130), "robot": (200, 205, 212), "objects": (70, 130, 200)}
RED = (230, 60, 60)
JPEG = 90


def record(episode: Episode, scene: Sequence[Solid3D], path: Path | None = None) -> None:
    """Writes a whole `.rrd` file, or opens the viewer.

    Raises `BadFile`: the episode is damaged; `CannotWrite`: the file system refuses.
    """
    # A viewer shows recordings of one id as one, and other datasets have episodes of this name.
    stream = rr.RecordingStream(APPLICATION, recording_id=uuid4())
    stream.send_recording_name(episode.name)
    if path is None:
        stream.spawn(default_blueprint=blueprint(episode))
        log_episode(stream, episode, scene)
        stream.flush()
        return
    temporary = hidden(path, files.TEMPORARY)
    with files.all_or_nothing(temporary):
        temporary.open("wb").close()  # says why not, where Rerun raises an error of its own
        stream.save(temporary, default_blueprint=blueprint(episode))
        log_episode(stream, episode, scene)
        stream.flush()
        stream.disconnect()
        files.move(temporary, path)


def blueprint(episode: Episode) -> rrb.Blueprint:
    """What is seen at first: the scene, the cameras, the joints, the label, the stages."""
    views = [rrb.Spatial2DView(origin=f"cameras/{name}", name=name) for name in episode.cameras]
    joints = [rrb.TimeSeriesView(origin=f"joints/{arm}", name=f"{arm} arm") for arm in ARMS]
    right = rrb.Tabs(
        rrb.TextDocumentView(origin="label", name="label"),
        rrb.TextLogView(origin="events", name="stages"),
    )
    return rrb.Blueprint(
        rrb.Vertical(
            rrb.Horizontal(
                rrb.Spatial3DView(origin="world", name="scene"),
                rrb.Vertical(*views),
                right,
                column_shares=[5, 2, 2],
            ),
            rrb.Horizontal(*joints, rrb.TimeSeriesView(origin="forces", name="forces [N]")),
            row_shares=[3, 2],
        ),
        collapse_panels=True,
    )


def log_episode(stream: rr.RecordingStream, episode: Episode, scene: Sequence[Solid3D]) -> None:
    """Logs everything, frame by frame."""
    frames, senses = episode.frames, episode.senses
    touch = senses.touch() if "touch" in senses.senses else None
    text = rr.TextDocument(label_text(episode), media_type="text/markdown")
    stream.log("label", text, static=True)
    stream.log("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    for solid in scene:
        colour = COLOURS[solid.name.partition("/")[0]]
        mesh = rr.Mesh3D(
            vertex_positions=solid.vertices, triangle_indices=solid.triangles, albedo_factor=colour
        )
        stream.log(f"world/{solid.name}", mesh, static=True)
    for name, camera in frames.cameras.items():
        K = np.asarray(camera.intrinsic_cv[0], float)
        pinhole = rr.Pinhole(image_from_camera=K, image_plane_distance=0.1)
        stream.log(f"world/cameras/{name}", pinhole, static=True)
    pictures = {name: episode.each_image(name) for name in episode.cameras}
    joints, tracks = panels(frames), {solid.name: solid.poses for solid in scene}
    for t in range(len(frames)):
        stream.set_time(FRAME, sequence=t)
        stream.set_time(TIME, duration=float(frames.time[t]))
        for name, poses in tracks.items():
            if t < len(poses):
                w, x, y, z = poses[t, 3:]
                turn = rr.Quaternion(xyzw=[x, y, z, w])
                place = rr.Transform3D(translation=poses[t, :3], quaternion=turn)
                stream.log(f"world/{name}", place)
        for name, images in pictures.items():
            picture = rr.Image(next(images)).compress(jpeg_quality=JPEG)
            stream.log(f"cameras/{name}", picture)
            extrinsic = frames.cameras[name].extrinsic_cv[t]
            X = np.linalg.inv(np.vstack([extrinsic, [0, 0, 0, 1]]).astype(float))
            place = rr.Transform3D(translation=X[:3, 3], mat3x3=X[:3, :3])
            stream.log(f"world/cameras/{name}", place)
        for panel in joints:
            arm, joint = panel.title.partition(" [")[0].split(" ")
            for label, values in (("command", panel.target), ("measured", panel.measured)):
                if values is not None:
                    stream.log(f"joints/{arm}/{joint}/{label}", rr.Scalars(float(values[t])))
        for finger, force in _forces(frames, touch, t):
            stream.log(f"forces/{finger}", rr.Scalars(float(np.linalg.norm(force))))
            if (track := tracks.get(f"robot/{finger}")) is not None:
                vector, at = METRES_PER_NEWTON * force, track[t, :3]
                arrow = rr.Arrows3D(origins=[at], vectors=[vector], colors=[RED])
                stream.log(f"world/forces/{finger}", arrow)
        if t == 0 or frames.stage[t] != frames.stage[t - 1]:
            stream.log("events", rr.TextLog(frames.stages[int(frames.stage[t])], level="INFO"))
        failure, moved = episode.failure, frames.object_poses
        if failure is None or t != failure.frame:
            continue
        what = " ".join(word for word in (failure.event, failure.object, failure.side) if word)
        text = f"WENT WRONG: {what}; {failure.reason}: {failure.detail}"
        stream.log("events", rr.TextLog(text, level="ERROR"))
        if failure.object in moved:
            at = moved[failure.object][t, :3]
            mark = rr.Points3D([at], radii=[0.015], colors=[RED], labels=[what])
            stream.log("world/went_wrong", mark)


def _forces(frames: Frames, touch: Touch | None, t: int) -> Iterator[tuple[str, Array]]:
    """Finger -> force [N] on what it touches, world; without the sense, of the hand's effort."""
    if touch is not None:
        yield from zip(touch.fingers, np.asarray(touch.force[t], float), strict=True)
        return
    for prefix, arm in zip(("fl", "fr"), ARMS, strict=True):
        pose = np.asarray(getattr(frames, f"{arm}_endpose")[t], float)
        w, x, y, z = pose[3:]
        closing = np.array([2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)])
        for number, sign in ((7, 1.0), (8, -1.0)):
            joint = f"{prefix}_joint{number}"
            if joint in frames.joint_names:
                effort = float(frames.effort[t, frames.joint_names.index(joint)])
                yield f"{prefix}_link{number}", sign * effort * closing


def label_text(episode: Episode) -> str:
    """Task, verdict and physics as Markdown."""
    lines = [f"# {episode.task}, seed {episode.seed}", "", f"protocol {episode.protocol}", ""]
    lines += [*episode.instructions.seen[:1], ""]
    if (failure := episode.failure) is not None:
        when = f"{failure.time:.2f} s (frame {failure.frame})"
        what = f"{failure.event} {failure.object} {failure.side}"
        lines += [f"**failed: {failure.reason}** ({failure.detail})", ""]
        lines += [f"went wrong at {when}: {what}", ""]
    lines += ["| attribute | value | unit |", "|---|---|---|"]
    for key, label in episode.meta.attributes.items():
        value = "asset's own" if label.value is None else np.round(label.value, 4)
        note = label.note and f", {label.note}"
        lines.append(f"| {key} | {value}{note} | {label.unit} |")
    return "\n".join(lines)
