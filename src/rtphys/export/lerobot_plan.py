"""Layout of a LeRobot export: features, camera names and rates."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import product
from pathlib import Path
from typing import Annotated, NamedTuple

from rtphys.assets.action_layout import SIDES, ActionLayout
from rtphys.core.errors import BadFile, BadValue, UnknownName
from rtphys.data.dataset import Episode
from rtphys.data.episode import CAMERA_NAMES, FRAME_RATE, official_camera
from rtphys.data.schema import informs
from rtphys.senses import SENSES
from rtphys.spec.option import Option, checked_dataclass, one_of

READERS = {
    "v3.0": "lerobot 0.4 and later",
    # Its converter rounds 16.67 frames a second down to 16, and later tools cut the videos by that.
    "v2.1": "openpi, GR00T and lerobot 0.3; lerobot's converter to v3.0 breaks it: export v3.0",
}
"""Version of the format -> who reads it."""

SENTENCES = ("first", "all", "task")
# [Hz] LeRobot's tools for v3.0 cut videos at a whole
# number of frames a second: with 50/3 they show the pictures of other frames, and say nothing.
RATES = {"v3.0": Fraction(17), "v2.1": FRAME_RATE}

POSE = [f"{side}_{part}" for side in SIDES for part in ("x", "y", "z", "qw", "qx", "qy", "qz")]
# Features on request. Numbers of an episode repeat in each of its frames, because lerobot's tools
# keep the columns of frames, and drop those of episodes that they do not know.
EXPORTED = tuple(name for name, sense in SENSES.items() if sense.exports)
WANTED = ("physics", "environment_state", "contact", *EXPORTED, "depth")
PHYSICS = ("observation.physics", "observation.environment_state")  # the same numbers
PICTURE = "observation.images."  # what names of videos begin with
INDICES = ("frame_index", "episode_index", "index", "task_index")
# Depth is what lerobot 0.6 makes of it, a lossless video of 12-bit numbers. Ours are millimetres
# from 0, where nothing is, to 4095; its own scale, which `info.json` states too, has 1.5 mm at 1 m.
DEPTH_MOST = 4095  # [mm]
DEPTH_INFO = {
    "is_depth_map": True,
    "depth_unit": "mm",
    "video.depth_min": 0.0,  # [m] at 0
    "video.depth_max": DEPTH_MOST / 1000,  # [m] at the largest number
    "video.use_log": False,
    "video.extra_options": {"x265-params": "lossless=1"},
}


class Video(NamedTuple):
    """What a video of an export shows."""

    camera: str  # official name
    depth: bool


@checked_dataclass(frozen=True)
class ExportSpec:
    """What an export holds of a dataset."""

    version: Annotated[
        str, one_of("LeRobot version", READERS), Option("v3.0, or v2.1 for openpi and GR00T.")
    ] = "v3.0"
    camera_names: Annotated[
        str, Option("aloha, robotwin, or pairs: head_camera=top,left_camera=wrist.")
    ] = "aloha"
    features: Annotated[
        tuple[str, ...],
        one_of("feature", WANTED),
        Option(f"Also in each frame: {', '.join(WANTED)}."),
    ] = ()
    sentences: Annotated[
        str,
        one_of("choice of sentences", SENTENCES),
        Option("Of each episode: first, all (alternating), or task (the task's name)."),
    ] = "first"

    def __post_init__(self) -> None:
        if "depth" in self.features and self.version != "v3.0":
            raise BadValue("features", "depth", "lerobot reads depth from v3.0 on")


@dataclass(frozen=True)
class Plan:
    """Options of one export, resolved for its dataset."""

    version: str
    videos: Mapping[str, Video]  # by feature
    size: tuple[int, int]  # height, width of every picture
    layout: ActionLayout  # of states and actions
    joints: tuple[str, ...]  # of efforts
    robot: str  # name of the embodiment
    more: Mapping[str, Sequence[str]]  # features that were asked for -> names of their numbers
    left_out: tuple[str, ...]  # attributes that are the asset's own in every episode

    @property
    def rate(self) -> Fraction:
        """Frames a second that the export declares."""
        return RATES[self.version]

    def features(self) -> dict[str, dict[str, object]]:
        """Value of `features` in info.json."""
        height, width = self.size
        commands = list(self.layout.names)
        vectors = {
            "observation.state": commands,
            "observation.ee_pose": POSE,
            "observation.effort": list(self.joints),
            "action": commands,
            **{name: list(parts) for name, parts in self.more.items()},
        }
        features: dict[str, dict[str, object]] = {
            name: {"dtype": "float32", "shape": [len(parts)], "names": parts}
            for name, parts in vectors.items()
        }
        for key, video in self.videos.items():
            codec, pixels = ("hevc", "gray12le") if video.depth else ("h264", "yuv420p")
            channels = 1 if video.depth else 3
            features[key] = {
                "dtype": "video",
                "shape": [height, width, channels],
                "names": ["height", "width", "channels"],
                "info": {
                    "video.height": height,
                    "video.width": width,
                    "video.codec": codec,
                    "video.pix_fmt": pixels,
                    "video.is_depth_map": video.depth,
                    "video.fps": float(self.rate),
                    "video.channels": channels,
                    "has_audio": False,
                    **(DEPTH_INFO if video.depth else {}),
                },
            }
        features["timestamp"] = {"dtype": "float32", "shape": [1], "names": None}
        features |= {name: {"dtype": "int64", "shape": [1], "names": None} for name in INDICES}
        return features


def plan_for(episodes: Sequence[Episode], spec: ExportSpec) -> Plan:
    """Reads the first episode of each task dataset, to see what its pictures and joints are.

    Args:
        episodes: those that are exported, at least one; the cameras are those that all of their
            task datasets have, or where `camera_names` has pairs, the named ones.

    Raises `UnknownName`: no such camera; `BadValue`: pictures of different sizes, two videos with
    one name, or several robots; `BadFile`: an episode that does not hold what a feature needs.
    """
    wanted, firsts = spec.features, dict[Path, Episode]()
    for one in episodes:
        firsts.setdefault(one.paths.folder, one)
    robot, *others = dict.fromkeys(one.embodiment for one in firsts.values())
    if others:
        allowed = "an export holds the episodes of one robot; choose it by `embodiment`"
        raise BadValue("dataset", ", ".join([robot, *others]), allowed)
    heads = [*map(replace, firsts.values())]  # copies, to forget what is read of them
    episode = heads[0]
    shared = [name for name in episode.cameras if all(name in one.cameras for one in heads)]
    chosen = _names(spec.camera_names, tuple(shared))
    sizes: dict[tuple[int, ...], str] = {}  # of pictures -> where it was seen first
    for one, camera in product(heads, chosen):
        sizes.setdefault(one.image(camera, 0).shape[:2], f"{one.task}, {one.config}, {camera}")
    if len(sizes) != 1:
        found = "; ".join(f"{width}x{height} ({of})" for (height, width), of in sizes.items())
        allowed = "all pictures of an export must have one size"
        raise BadValue("cameras", found or "none that all task datasets have", allowed)
    ((height, width),) = sizes
    for name, one in product(sorted({*wanted} & {*EXPORTED, "depth"}), heads):
        if name not in one.senses.senses:
            draw = ", or add it with `rtphys render add=depth`" if name == "depth" else ""
            problem = f"holds no {name}; `rtphys collect senses={name}` records it{draw}"
            raise BadFile(one.paths.hdf5, problem)
    named = {camera: f"{PICTURE}{name}" for camera, name in chosen.items()}
    videos = {key: Video(camera, False) for camera, key in named.items()}
    if "depth" in wanted:
        depths = {f"{key}_depth": Video(camera, True) for camera, key in named.items()}
        for key in depths.keys() & videos.keys():
            name = key.removeprefix(PICTURE)
            raise BadValue("camera name", name, f"the depth of {depths[key].camera} is called so")
        videos |= depths
    more, left_out = dict[str, Sequence[str]](), tuple[str, ...]()
    if with_physics := [key for key in PHYSICS if key.partition(".")[2] in wanted]:
        numbers, left_out = _numbers(episodes)
        more = dict.fromkeys(with_physics, numbers)
    if "contact" in wanted:
        more["observation.contact"] = [f"{side}_gripper" for side in SIDES]
    for name in set(wanted) & {*EXPORTED}:
        more[f"observation.{name}"] = [*episode.senses.columns(name)]
    frames = episode.frames
    size, joints = (height, width), frames.joint_names
    return Plan(spec.version, videos, size, frames.layout, joints, robot, more, left_out)


def _numbers(episodes: Iterable[Episode]) -> tuple[list[str], tuple[str, ...]]:
    """Names of the attributes that have a number in each episode, and of those that never have.

    Raises `BadFile`: one has a number in some episodes alone.
    """
    numbers, own = dict[str, Path](), dict[str, Path]()  # name -> where it was seen first
    for episode in episodes:
        path = episode.paths.phys_meta
        for name, value in physics_of(replace(episode)).items():  # a copy, to forget what it read
            (own if value is None else numbers).setdefault(name, path)
    if mixed := [name for name in own if name in numbers]:
        name = mixed[0]
        problem = (
            f"{name} is the asset's own here, and a number in {numbers[name]}; a feature needs a "
            "number in all episodes or in none: export them apart, by `config` or `protocol`"
        )
        raise BadFile(own[name], problem)
    return [*numbers], tuple(own)


def physics_of(episode: Episode, acting: bool = False) -> dict[str, float | None]:
    """The attributes, vectors as a number an axis; None where the asset's own value holds.

    Args:
        acting: None, too, where an attribute could not act or did not act.
    """
    found: dict[str, float | None] = {}
    for key, label in episode.meta.attributes.items():
        left_out = acting and not informs(key, label)
        if isinstance(label.value, list):
            parts = zip("xyz", label.value, strict=True)
            found |= {f"{key}_{axis}": None if left_out else float(part) for axis, part in parts}
        else:
            found[key] = None if label.value is None or left_out else float(label.value)
    return found


def _names(naming: str, cameras: tuple[str, ...]) -> dict[str, str]:
    """Name in the export by camera."""
    if "=" not in naming:
        if naming not in CAMERA_NAMES:
            raise UnknownName("camera naming", naming, CAMERA_NAMES)
        return {camera: CAMERA_NAMES[naming][camera] for camera in cameras}
    chosen: dict[str, str] = {}
    for pair in naming.split(","):
        camera, _, name = pair.partition("=")
        camera = official_camera(camera)
        if camera not in cameras:
            raise UnknownName("camera", camera, cameras)
        if camera in chosen:
            raise BadValue("camera names", naming, f"name {camera} once")
        if not name or "/" in name or name in chosen.values():
            raise BadValue("camera name", name, "each camera needs a distinct name without /")
        chosen[camera] = name
    return chosen
