"""Layout of a LeRobot export: features, camera names and rates."""

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from rtphys.assets.action_layout import SIDES, ActionLayout
from rtphys.assets.embodiment import DEFAULT
from rtphys.core.errors import BadValue, UnknownName
from rtphys.data.dataset import Episode

VERSIONS = ("v3.0", "v2.1")
CAMERA_NAMES: dict[str, dict[str, str]] = {
    "aloha": {
        "head_camera": "cam_high",
        "left_camera": "cam_left_wrist",
        "right_camera": "cam_right_wrist",
        "front_camera": "cam_low",
    },
    "robotwin": {name: name for name in ("head_camera", "left_camera", "right_camera")}
    | {"front_camera": "front_camera"},
}
RATE = Fraction(250, 15)  # [Hz] frames: one every 15 of 250 control steps per second
CHUNK = 1000  # files in a folder (v3.0), episodes in a folder (v2.1)

POSE = [f"{side}_{part}" for side in SIDES for part in ("x", "y", "z", "qw", "qx", "qy", "qz")]
INDICES = ("frame_index", "episode_index", "index", "task_index")


@dataclass(frozen=True)
class Plan:
    """Options of one export, resolved for its dataset."""

    version: str
    cameras: Mapping[str, str]  # official name -> name in the export
    size: tuple[int, int]  # height, width of every picture
    layout: ActionLayout  # of states and actions
    joints: tuple[str, ...]  # of efforts
    robot: str  # name of the embodiment

    def video_key(self, camera: str) -> str:
        """Feature name of a camera's video."""
        return f"observation.images.{self.cameras[camera]}"

    def features(self) -> dict[str, dict[str, object]]:
        """Value of `features` in info.json."""
        height, width = self.size
        info = {
            "video.height": height,
            "video.width": width,
            "video.codec": "h264",
            "video.pix_fmt": "yuv420p",
            "video.is_depth_map": False,
            "video.fps": float(RATE),
            "video.channels": 3,
            "has_audio": False,
        }
        commands = list(self.layout.names)
        vectors = {
            "observation.state": commands,
            "observation.ee_pose": POSE,
            "observation.effort": list(self.joints),
            "action": commands,
        }
        features: dict[str, dict[str, object]] = {
            name: {"dtype": "float32", "shape": [len(parts)], "names": parts}
            for name, parts in vectors.items()
        }
        for camera in self.cameras:
            features[self.video_key(camera)] = {
                "dtype": "video",
                "shape": [height, width, 3],
                "names": ["height", "width", "channels"],
                "info": info,
            }
        features["timestamp"] = {"dtype": "float32", "shape": [1], "names": None}
        features |= {name: {"dtype": "int64", "shape": [1], "names": None} for name in INDICES}
        return features


def plan_for(episode: Episode, version: str, camera_names: str) -> Plan:
    """Reads one episode to see which cameras there are, how large their pictures, how many joints.

    Args:
        episode: any episode of the dataset.
        version: "v3.0" or "v2.1".
        camera_names: "aloha", "robotwin", or pairs such as "head_camera=top,left_camera=wrist";
            with pairs, only the named cameras are exported.

    Raises:
        UnknownName: no such version or camera.
        BadValue: cameras of different sizes, or two cameras with one name.
    """
    if version not in VERSIONS:
        raise UnknownName("LeRobot version", version, VERSIONS)
    chosen = _names(camera_names, episode.cameras)
    sizes = {camera: episode.image(camera, 0).shape for camera in chosen}
    if len({*sizes.values()}) != 1:
        raise BadValue("cameras", sizes, "all pictures of an export must have one size")
    height, width, _ = next(iter(sizes.values()))
    frames = episode.frames
    robot = str(episode.meta.recipe.get("embodiment", DEFAULT))
    return Plan(version, chosen, (height, width), frames.layout, frames.joint_names, robot)


def _names(naming: str, cameras: tuple[str, ...]) -> dict[str, str]:
    """Name in the export by camera."""
    if "=" not in naming:
        if naming not in CAMERA_NAMES:
            raise UnknownName("camera naming", naming, CAMERA_NAMES)
        return {camera: CAMERA_NAMES[naming][camera] for camera in cameras}
    chosen: dict[str, str] = {}
    for pair in naming.split(","):
        camera, _, name = pair.partition("=")
        if camera not in cameras:
            raise UnknownName("camera", camera, cameras)
        if not name or "/" in name or name in chosen.values():
            raise BadValue("camera name", name, "each camera needs a distinct name without /")
        chosen[camera] = name
    return chosen
