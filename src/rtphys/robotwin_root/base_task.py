"""What RoboTwin's launchers and adapters import: `Base_Task` of `envs`, and the sentences."""

from collections.abc import Mapping, Sequence
from subprocess import Popen
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from rtphys.assets.action_layout import SIDES
from rtphys.assets.embodiment import DEFAULT, canonical
from rtphys.assets.pack import Pack, default_pack
from rtphys.core.errors import BadValue, Infeasible, RtphysError, UnknownName
from rtphys.core.poses import quat_to_matrix
from rtphys.episode import begin
from rtphys.episode.assemble import describer
from rtphys.episode.control import ActionKind
from rtphys.episode.generate import attempt
from rtphys.policies.robotwin_env import DATA_TYPES, Posed, TaskEnv
from rtphys.spec.episode import SPLITS, EpisodeSpec, Recipe
from rtphys.spec.protocol import protocol_names
from rtphys.spec.recording import RecordingSpec
from rtphys.task.instructions import fits, instructions, scene_info
from rtphys.task.spec import Task, load_task

PROTOCOL = "rtphys_protocol"  # key of our task configurations
SEED = "rtphys_seed"  # key of an episode's info; sentences are derived from it
OFFICIAL = {"demo_clean": "clean", "demo_randomized": "official_random"}
"""RoboTwin's task configuration -> our protocol."""

# Names of RoboTwin for objects whose name here is another, of the tasks in which drivers use them.
OBJECTS = {
    "blocks_ranking_rgb": {"block1": "red", "block2": "green", "block3": "blue"},
    "blocks_ranking_size": {"block1": "large", "block2": "medium", "block3": "small"},
    "place_object_scale": {"object": "thing"},
}


class UnStableError(RtphysError):
    """A world cannot be set up or does not come to rest: launchers try the next seed."""


class ArmTag(str):
    """Name of an arm, "left" or "right"; any other one is a ValueError."""

    def __new__(cls, value: str) -> "ArmTag":
        if value not in SIDES:
            raise ValueError(f"{value!r} is neither 'left' nor 'right'")
        return super().__new__(cls, value)

    @property
    def opposite(self) -> "ArmTag":
        """The other arm."""
        return ArmTag(SIDES[1 - SIDES.index(self)])


def get_face_prod(q: ArrayLike, local_axis: ArrayLike, target_axis: ArrayLike) -> float:
    """Scalar product of an axis, turned by the quaternion `q` (wxyz), and one in the world."""
    return float(quat_to_matrix(q) @ np.asarray(local_axis, float) @ np.asarray(target_axis, float))


def protocol_of(args: dict[str, object]) -> str:
    """Protocol of a task configuration's arguments. Raises `UnknownName`: they name none."""
    config = str(args.get("task_config", ""))
    name = str(args.get(PROTOCOL) or OFFICIAL.get(config, config))
    known = protocol_names()
    if name not in known:
        raise UnknownName("task configuration", name, (*known, *OFFICIAL))
    return name


def robot_of(args: Mapping[str, object]) -> str:
    """Robot of a task configuration's arguments. Raises `BadValue`: they name none."""
    robot = args.get("embodiment") or DEFAULT
    return canonical(robot if isinstance(robot, str) else ",".join(map(str, robot)))  # type: ignore[call-overload]


class Base_Task(TaskEnv):
    """RoboTwin task whose name is its class's name: `class click_bell(Base_Task)`."""

    def __init__(self) -> None:
        super().__init__()
        self.task_name = type(self).__name__
        self.info: dict[str, object] = {}
        self.eval_video_ffmpeg: Popen[bytes] | None = None
        self._made: tuple[Recipe, Task, Pack] | None = None
        self._demonstrated: bool | None = None  # whether the expert solved this episode

    def setup_demo(
        self, now_ep_num: int = 0, seed: int = 0, is_test: bool = False, **args: object
    ) -> None:
        """Begin a new episode.

        Args:
            is_test: use textures and sentences of the unseen split, as `eval_mode` does.
            args: the whole task configuration; its `embodiment` is a name, `[NAME]` or
                `[LEFT, RIGHT, DISTANCE]`.

        Raises `UnStableError`: the world cannot be set up; `UnknownName`: the configuration names
        no protocol; `BadValue`: it names no robot.
        """
        self._init_task_env_(now_ep_num=now_ep_num, seed=seed, is_test=is_test, **args)

    def _init_task_env_(self, now_ep_num: int, seed: int, is_test: bool, **args: object) -> None:
        """Does what `setup_demo` says; RoboTwin's name, which FACT's adapter replaces."""
        self.ep_num = now_ep_num
        self.eval_video_path = args.get("eval_video_save_dir")
        if isinstance(wanted := args.get("data_type"), dict):
            self.data_type = dict(wanted)
        spec = EpisodeSpec(
            self.task_name,
            protocol_of(args),
            split="unseen" if is_test or args.get("eval_mode") else "seen",
            embodiment=robot_of(args),
        )
        asked = {sense for key, sense in DATA_TYPES.items() if self.data_type.get(key)}
        recording = RecordingSpec(senses=tuple(sorted(asked)))
        recipe, task, pack = spec.at(seed), load_task(self.task_name), default_pack()
        try:
            self.begin_episode(begin(recipe, task, pack, recording))
        except Infeasible as problem:
            raise UnStableError(str(problem)) from problem
        self._made, self._demonstrated, self.plan_success = (recipe, task, pack), None, True

    def play_once(self) -> dict[str, object]:
        """Let the expert try this episode, in a separate world.

        Returns `info`: the placeholders of the episode's sentences, and their seed.
        """
        if self._made is None:
            raise RuntimeError("no episode yet: setup_demo(...) begins one")
        recipe, task, pack = self._made
        self._demonstrated = self.plan_success = attempt(recipe, task, pack).accepted
        self.info = {
            **self.episode.instance.look.scene_info(),
            "info": {**scene_info(task, recipe.seed), SEED: recipe.seed},
        }
        return self.info

    def check_success(self) -> bool:
        """Success of the expert after `play_once`, otherwise of the actions so far."""
        return super().check_success() if self._demonstrated is None else self._demonstrated

    def take_action(self, action: ArrayLike, action_type: ActionKind = "qpos") -> None:
        """As `TaskEnv`'s; before it, the head camera's picture goes to the launcher's video."""
        video = self.eval_video_ffmpeg
        running = self.take_action_cnt < self.step_lim and not self.eval_success
        if running and video is not None and video.stdin is not None:
            video.stdin.write(self.episode.observe().images["head"].tobytes())
        super().take_action(action, action_type)

    def close_env(self, clear_cache: bool = False) -> None:
        self._made = None

    def __getattr__(self, name: str) -> Posed:
        """An object of the scene, by its name or by that of RoboTwin; its pose is to be had."""
        episode = self.__dict__.get("_episode")
        objects = episode.rollout.world.objects if episode is not None else {}
        name_here = OBJECTS.get(self.__dict__.get("task_name", ""), {}).get(name, name)
        if name_here not in objects:
            raise AttributeError(f"{type(self).__name__} has no attribute {name!r}", name=name)
        return Posed(lambda: objects[name_here].pose)

    def _set_eval_video_ffmpeg(self, ffmpeg: Popen[bytes]) -> None:
        self.eval_video_ffmpeg = ffmpeg

    def _del_eval_video_ffmpeg(self) -> None:
        if self.eval_video_ffmpeg is not None and self.eval_video_ffmpeg.stdin is not None:
            self.eval_video_ffmpeg.stdin.close()
            self.eval_video_ffmpeg.wait()
        self.eval_video_ffmpeg = None


def generate_episode_descriptions(
    task_name: str, episodes: Sequence[Mapping[str, object]], max_descriptions: int = 100
) -> list[dict[str, Any]]:
    """Sentences of episodes, each `{"episode_index": i, "seen": [...], "unseen": [...]}`.

    Args:
        episodes: what `play_once` returned in each. Of one that a driver made up itself, without
            our seed, the values fill the placeholders: `{"{A}": "red block", "{a}": "left"}`.
        max_descriptions: sentences per split.

    Raises `BadValue`: no sentence of the task fits an episode's placeholders.
    """
    task, describe = load_task(task_name), describer(default_pack())
    described: list[dict[str, Any]] = []
    for index, info in enumerate(episodes):
        seed = info.get(SEED)
        said = instructions(task, seed, describe) if isinstance(seed, int) else _filled(task, info)
        limited = {split: lines[:max_descriptions] for split, lines in said.items()}
        described.append({"episode_index": index, **limited})
    return described


def _filled(task: Task, info: Mapping[str, object]) -> dict[str, list[str]]:
    """The task's sentences with the values of an episode's info."""
    words: dict[str, str] = {}
    for key, value in info.items():
        thing = (
            str(value).partition("/")[0].lstrip("0123456789_").replace("_", " ")
        )  # 050_bell/base0
        noun = f"{value} arm" if value in SIDES else thing.removeprefix("the ")
        words[key.strip("{}")] = f"the {noun}"
    phrases, found = task.sentences(), dict[str, list[str]]()
    for split in SPLITS:
        lines = [text.format(**words) for text in getattr(phrases, split) if fits(text, words)]
        found[split] = [line[:1].upper() + line[1:] for line in lines]
    if not all(found.values()):
        expected = ", ".join(f"{{{letter}}}" for letter in task.info) or "none"
        raise BadValue("episodes", dict(info), f"placeholders of {task.name} are {expected}")
    return found
