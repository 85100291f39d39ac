"""Datasets that lie, with all checksums made anew: each a change that a replay must find."""

import json
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import cv2
import numpy as np
from forger import HEAD, Entry, Forge, Forger, put

from rtphys.data import jpeg
from rtphys.data.episode import CameraFrames, Frames
from rtphys.data.hdf5_episode import episode_bytes, read_episode
from rtphys.data.json_text import pretty
from rtphys.data.video import EncodedImages, encode_images
from rtphys.physics.domain import Domain


def _halved_friction(forger: Forger) -> None:
    """The domain that halves it, labels and ledger along; the episodes stay."""
    domain = forger.entries[0]["resolved"]["domain"]
    rule = domain["rules"]["friction"]["uniform"]
    domain["rules"]["friction"]["uniform"] = [value / 2 for value in rule]
    digest = Domain.from_json(domain).digest
    domain["digest"] = digest
    for entry in forger.entries[1:]:
        if "friction" in entry["physics"]:
            entry["physics"]["friction"] /= 2

    def halve(label: Entry) -> None:
        label["domain"]["digest"] = digest
        label["attributes"]["friction"]["value"] /= 2

    for number in (0, 1):
        forger.label(number, halve)


def _swapped(forger: Forger) -> None:
    """All of two episodes but their numbers and seeds; both have as many frames."""
    first, second = (forger.place.episode(number) for number in (0, 1))
    for old, new in zip(first.all(), second.all(), strict=True):
        a, b = old.read_bytes(), new.read_bytes()
        old.write_bytes(b)
        new.write_bytes(a)
    seeds = [forger.entry(number)["seed"] for number in (0, 1)]
    kept = [{k: forger.entry(n)[k] for k in ("frames", "physics", "scene_info")} for n in (0, 1)]
    for number in (0, 1):
        forger.entry(number).update(kept[1 - number])

        def rename(label: Entry, number: int = number) -> None:
            label.update(episode=number, seed=seeds[number])
            label["recipe"]["seed"] = seeds[number]

        forger.label(number, rename)


def _invented_rejection(forger: Forger) -> None:
    """The last episode never was: its seed slipped."""
    entry = forger.entry(1)
    for path in forger.place.episode(1).all():
        path.unlink()
    said = {"verdict": "rejected", "reason": "slipped", "detail": "stapler left the left hand"}
    kept = {key: entry[key] for key in ("seed", "physics")}
    forger.entries[forger.entries.index(entry)] = {**kept, **said}


def _invented_episode(forger: Forger) -> None:
    """The rejected seed has an episode: a copy of another with its label's seed changed."""
    forger.entries[1] = {**forger.entry(0), "seed": forger.entries[1]["seed"]}
    del forger.entries[2]
    forger.entries[2] = {**forger.entry(1), "seed": 1}

    for seed in (0, 1):

        def change(label: Entry, seed: int = seed) -> None:
            label["seed"] = label["recipe"]["seed"] = seed

        forger.label(seed, change)


def _words(forger: Forger, key: str) -> None:
    path = forger.place.episode(1).instruction
    words = json.loads(path.read_text())
    words[key][0] = "Hand me the scissors."
    path.write_bytes(pretty(words))
    hdf5 = forger.place.episode(1).hdf5
    frames, images, _ = read_episode(hdf5, "native")
    hdf5.write_bytes(episode_bytes("native", frames, images, words["seen"]))


def _cut(forger: Forger) -> None:
    """The last frame is left out, everywhere."""

    def change(frames: Frames, images: EncodedImages) -> Frames:
        images.jpegs[HEAD].pop()
        arrays = {k: getattr(frames, k)[:-1] for k in ("time", "stage", "qpos", "qvel", "effort")}
        for arm in ("left", "right"):
            for part in ("arm", "gripper", "endpose"):
                arrays[f"{arm}_{part}"] = getattr(frames, f"{arm}_{part}")[:-1]
        camera = frames.cameras[HEAD]
        views = (camera.intrinsic_cv, camera.extrinsic_cv, camera.cam2world_gl)
        return replace(
            frames,
            **arrays,
            object_poses={name: pose[:-1] for name, pose in frames.object_poses.items()},
            contacts={name: touch[:-1] for name, touch in frames.contacts.items()},
            cameras={HEAD: CameraFrames(*(view[:-1] for view in views))},
        )

    forger.hdf5(1, change, video=True)
    forger.entry(1)["frames"] -= 1


def _frozen(forger: Forger) -> None:
    """The tenth picture is the ninth again; the video is left."""

    def change(_: Frames, images: EncodedImages) -> None:
        images.jpegs[HEAD][10] = images.jpegs[HEAD][9]

    forger.hdf5(1, change)


def _rougher(surfaces: Entry) -> Entry:
    """The friction that the simulator reports of one surface, doubled."""
    name = min(surfaces)
    first = {key: 2 * value for key, value in surfaces[name].items() if "friction" in key}
    return {**surfaces, name: {**surfaces[name], **first}}


def _ledger(number: int | None, *way: Any, value: Any) -> Forge:
    def forge(forger: Forger) -> None:
        put(*way, value=value)(forger.entries[1] if number is None else forger.entry(number))

    return forge


def _label(*way: Any, value: Any) -> Forge:
    return lambda forger: forger.label(1, put(*way, value=value))


def turned(frames: Frames, _: EncodedImages) -> Frames:
    """The head camera hangs 2 cm elsewhere, by its calibration."""
    camera = frames.cameras[HEAD]
    gl = camera.cam2world_gl.copy()
    gl[:, 0, 3] += 0.02
    extrinsic = np.linalg.inv(gl @ np.diag([1.0, -1, -1, 1]))[:, :3].astype(np.float32)
    return replace(frames, cameras={HEAD: CameraFrames(camera.intrinsic_cv, extrinsic, gl)})


def renamed(frames: Frames, _: EncodedImages) -> Frames:
    ordered = sorted(frames.object_poses)
    names = dict(zip(ordered, reversed(ordered), strict=True))
    poses = {names[name]: pose for name, pose in frames.object_poses.items()}
    touched = {names[name]: touch for name, touch in frames.contacts.items()}
    return replace(frames, object_poses=poses, contacts=touched)


def flipped(frames: Frames, _: EncodedImages) -> Frames:
    first = min(frames.contacts)
    return replace(frames, contacts={**frames.contacts, first: ~frames.contacts[first]})


def pushed(frames: Frames, _: EncodedImages) -> Frames:
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


def darker(_: int, rgb: np.ndarray) -> np.ndarray:
    return (rgb * 0.7).astype(np.uint8)


def worse(_: int, rgb: np.ndarray) -> bytes:
    done, stream = cv2.imencode(".jpg", rgb, [cv2.IMWRITE_JPEG_QUALITY, 20])
    assert done
    return stream.tobytes()


def _scaled(share: float) -> Callable[[np.ndarray], np.ndarray]:
    return lambda array: array * share


def _video(forger: Forger) -> None:
    paths = [forger.place.episode(number).video for number in (0, 1)]
    paths[1].write_bytes(paths[0].read_bytes())


_ARM = {f"{arm}_arm": _scaled(0.97) for arm in ("left", "right")}

# By name: the forgery, and the parts of the path or of the sentence by which it must be found.
FORGERIES: dict[str, tuple[Forge, str]] = {
    # Those that passed before.
    "halved friction, its domain forged along": (_halved_friction, "episode_0000001.hdf5"),
    "black pictures": (lambda f: f.pictures(1, lambda _, rgb: 0 * rgb), "of head_camera"),
    "actions x 0.97": (lambda f: f.arrays(1, **_ARM), "right_arm"),
    "two episodes swapped": (_swapped, "episode_0000001.hdf5: not as made again"),
    "another seed's recipe": (_label("recipe", "seed", value=5), "recipe.seed is 5"),
    "an invented rejection": (_invented_rejection, "seed 2 is recorded as rejected (slipped)"),
    # Arrays.
    "shifted time stamps": (lambda f: f.arrays(1, time=lambda t: t + 0.06), "time from frame 0"),
    "touch exchanged": (lambda f: f.hdf5(1, flipped), "contacts/"),
    "effort scaled": (lambda f: f.arrays(1, effort=_scaled(1.02)), "effort"),
    "measured joints exchanged": (lambda f: f.arrays(1, qpos=lambda q: q[:, ::-1].copy()), "qpos"),
    "speeds left out": (lambda f: f.arrays(1, qvel=_scaled(0.0)), "qvel"),
    "objects renamed": (lambda f: f.hdf5(1, renamed), "object_poses/"),
    "an object moved by a millimetre": (lambda f: f.hdf5(1, pushed), "object_poses/"),
    "the hand moved": (
        lambda f: f.arrays(1, left_endpose=lambda p: p + np.eye(7)[0] * 1e-3),
        "left_endpose",
    ),
    "stages renamed": (
        lambda f: f.arrays(1, stages=lambda s: tuple(f"{name}x" for name in s)),
        "stages are",
    ),
    "stages moved": (lambda f: f.arrays(1, stage=lambda s: np.roll(s, 3)), "stage from frame"),
    "joints renamed": (lambda f: f.arrays(1, joint_names=lambda n: n[::-1]), "joint_names are"),
    "the camera's calibration moved": (lambda f: f.hdf5(1, turned), "cameras/head_camera"),
    "the last frame left out": (_cut, "frames, made again"),
    # Pictures.
    "a small sticker in one picture": (lambda f: f.pictures(1, patch), "equal to the last bit"),
    "a picture twice": (_frozen, "of head_camera"),
    "darker pictures": (lambda f: f.pictures(1, darker), "of head_camera"),
    "colours exchanged": (
        lambda f: f.pictures(1, lambda _, rgb: rgb[..., ::-1].copy()),
        "of head_camera",
    ),
    "pictures of less quality": (lambda f: f.pictures(1, worse, video=False), "of head_camera"),
    "another episode's video": (_video, "of the video"),
    "a mirrored video": (
        lambda f: f.place.episode(1).video.write_bytes(_mirrored(f)),
        "of the video",
    ),
    # Labels.
    "friction within its tolerance": (
        _label("attributes", "friction", "value", value=lambda v: v + 1e-6),
        "attributes.friction.value",
    ),
    "the camera's place": (
        _label("cameras", HEAD, "position", 0, value=lambda v: v + 0.01),
        "cameras.head_camera.position",
    ),
    "the time of success": (
        _label("verdict", "first_success_time", value=lambda v: v - 0.06),
        "verdict.first_success_time",
    ),
    "success that held": (_label("verdict", "held", value=False), "verdict.held"),
    "friction that was read back": (
        _label("readback", "surfaces", value=_rougher),
        "readback.surfaces",
    ),
    "a look": (_label("visual", "flickers", value=lambda v: not v), "visual.flickers"),
    "state hash": (_label("state_hash", value="f" * 64), "state_hash"),
    "versions": (_label("versions", "numpy", value="1.0"), "versions.numpy"),
    "which mode the camera had": (_label("draws", "camera_mode", value="spin"), "camera_mode"),
    # Sentences, side files and lines.
    "a sentence": (lambda f: _words(f, "seen"), "episode_0000001.json: seen is"),
    "an unseen sentence": (lambda f: _words(f, "unseen"), "episode_0000001.json: unseen is"),
    "scene_info": (
        _ledger(1, "scene_info", "info", "{A}", value="001_bottle/base0"),
        "scene_info.info.{A} is",
    ),
    "physics in the ledger": (
        _ledger(1, "physics", "friction", value=lambda v: v * 1.01),
        "ledger.jsonl: seed 2: physics.friction",
    ),
    "the reason of a rejection": (_ledger(None, "reason", value="slipped"), "rejected (slipped)"),
    "the detail of a rejection": (_ledger(None, "detail", value="bad luck"), "detail is"),
    "the physics of a rejection": (
        _ledger(None, "physics", "restitution", value=lambda v: v * 1.01),
        "physics.restitution",
    ),
    "a rejection by a crash": (_ledger(None, "reason", value="worker_crash"), "worker_crash"),
    "an episode of a rejected seed": (_invented_episode, "made again it is rejected"),
}


def _mirrored(forger: Forger) -> bytes:
    _, images, _ = read_episode(forger.place.episode(1).hdf5, "native")
    pictures = ({HEAD: jpeg.decode(one)[:, ::-1].copy()} for one in images.jpegs[HEAD])
    return encode_images(pictures).video
