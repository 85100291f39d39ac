"""TASK_ENV, the environment object that RoboTwin's policy adapters use, under RoboTwin's names.

Its members are the union of what 28 public adapters read, call or set.
"""

from collections.abc import Callable
from copy import deepcopy
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rtphys.assets.action_layout import SIDES
from rtphys.core.poses import Pose
from rtphys.data.palette import coloured
from rtphys.episode import CameraView, Observation, PolicyEpisode
from rtphys.episode.control import ActionKind
from rtphys.senses import drawn
from rtphys.senses.depth import to_mm
from rtphys.sim.robot import SimArm
from rtphys.spec.recording import CAMERAS

Robotwin = dict[str, object]
DATA_TYPES = {
    "depth": "depth",
    "pointcloud": "pointcloud",
    "mesh_segmentation": "segmentation",
    "actor_segmentation": "segmentation",
    "touch": "touch",
}
"""Key of RoboTwin's `data_type`, to which we add `touch`, -> our sense."""
CLOSED, OPEN = 0.2, 0.8  # commanded openings that RoboTwin counts as closed (<) and open (>)


def official(now: Observation, pictures: bool = True) -> Robotwin:
    """An observation as RoboTwin's `get_obs` gives it: nested dicts, plain lists, RGB pictures.

    It holds `observation`, `pointcloud`, `joint_action` and `endpose`. Depth, segmentation and
    point cloud are there if the episode was begun with them: in mm, in the palette's colours, and
    (1024, 6). Joint actions are drive targets, grippers 0 closed .. 1 open. End poses are lists,
    xyz [m] + wxyz in the world frame: adapters concatenate them with `+`.

    `touch`, which RoboTwin does not have, is there if the episode was begun with it: fingers and
    objects by name, and an array of each quantity, a row a finger (`rtphys.senses.touch`).

    `pictures`: False leaves `observation` empty and draws nothing.
    """
    joints: Robotwin = {}
    ends: Robotwin = {}
    for side, part in zip(SIDES, now.embodiment.action_layout.sides, strict=True):
        *arm, gripper = now.vector[part].tolist()
        joints[f"{side}_arm"], joints[f"{side}_gripper"] = arm, gripper
        ends[f"{side}_endpose"], ends[f"{side}_gripper"] = now.endposes[side].tolist(), gripper
    felt: Robotwin = {}
    if (touch := now.touch) is not None:
        felt = {"touch": {"fingers": touch.fingers, "objects": touch.objects, **now.felt}}
    views = now.cameras if pictures else {}
    return {
        **felt,
        "observation": {CAMERAS[name]: official_view(view) for name, view in views.items()},
        "pointcloud": now.cloud if pictures and now.cloud is not None else [],
        "joint_action": {**joints, "vector": now.vector.copy()},
        "endpose": ends,
    }


def official_view(view: CameraView) -> Robotwin:
    """One camera under RoboTwin's keys, with those senses that there are."""
    found: Robotwin = {"rgb": view.rgb, **matrices(view)}
    if view.depth is not None:
        found["depth"] = to_mm(view.depth)
    if view.actors is not None and view.meshes is not None:
        found["mesh_segmentation"] = coloured(view.meshes)
        found["actor_segmentation"] = coloured(view.actors)
    return found


def matrices(view: CameraView) -> dict[str, NDArray[np.float32]]:
    """A camera's matrices under RoboTwin's keys."""
    return {key: getattr(view, key) for key in ("intrinsic_cv", "extrinsic_cv", "cam2world_gl")}


class Posed:
    """A camera or a body of which adapters ask the pose alone."""

    def __init__(self, pose: Callable[[], Pose]) -> None:
        self._pose = pose

    def get_pose(self) -> Pose:
        """Pose in the world frame, `p` [m] and `q` wxyz."""
        return self._pose()


# What RoboTwin's `Robot` tells of an arm, by the name of the method, a side in place of `{}`.
READINGS: dict[str, Callable[[SimArm], object]] = {
    "get_{}_arm_jointState": lambda arm: [*arm.target.tolist(), arm.gripper],  # [rad], opening
    "get_{}_gripper_val": lambda arm: arm.gripper,  # commanded, 0 closed .. 1 open
    "get_{}_ee_pose": lambda arm: arm.ee().flat.tolist(),  # of the ee frame
    "get_{}_tcp_pose": lambda arm: arm.tcp().flat.tolist(),  # of the tool centre point
    "is_{}_gripper_close": lambda arm: arm.gripper < CLOSED,
    "is_{}_gripper_open": lambda arm: arm.gripper > OPEN,
}


class Robot:
    """Joint commands, and measured poses, xyz [m] + wxyz in the world, under RoboTwin's names."""

    def __init__(self, episode: PolicyEpisode) -> None:
        for arm in episode.rollout.world.robot.arms:
            vars(self)[f"{arm.side}_camera"] = Posed(arm.ee)
            for name, reading in READINGS.items():
                vars(self)[name.format(arm.side)] = partial(reading, arm)

    def set_planner(self, scene: object = None) -> None:
        """Nothing to do: there is no planner to load; drivers replace this to save its time."""

    def __getattr__(self, name: str) -> Any:
        raise AttributeError(f"a robot has {name!r} neither here nor in RoboTwin", name=name)


class Cameras:
    """Pictures on request; wrist cameras follow their links by themselves."""

    def __init__(self, episode: PolicyEpisode) -> None:
        self._episode = episode
        self._seen = episode.observe()

    def update_wrist_camera(self, left_pose: object, right_pose: object) -> None:
        """Nothing to do: mounted cameras move with their links."""

    def update_picture(self) -> None:
        """Observe the present instant; its pictures are drawn when they are requested."""
        self._seen = self._episode.observe()

    def get_rgb(self) -> dict[str, dict[str, NDArray[np.uint8]]]:
        """`{"head_camera": {"rgb": (240, 320, 3) uint8 RGB}, ...}`."""
        return {CAMERAS[name]: {"rgb": view.rgb} for name, view in self._seen.cameras.items()}

    def get_config(self) -> dict[str, dict[str, NDArray[np.float32]]]:
        """Matrices of every camera by RoboTwin's name."""
        return {CAMERAS[name]: matrices(view) for name, view in self._seen.cameras.items()}


class TaskEnv:
    """Environment of all episodes of a run; `begin_episode` starts the next one.

    It has no __slots__, because adapters set attributes of their own on it.

    Attributes:
        take_action_cnt, step_lim: number of actions so far, and the limit.
        eval_success: whether the success condition was true at some instant.
        test_num, suc: number of episodes before this one, and of successes among them.
        now_obs: the last result of `get_obs`.
        data_type: content of observations; without `rgb` and senses nothing is drawn.
    """

    robot: Robot
    cameras: Cameras

    def __init__(self) -> None:
        self.task_name = ""
        self.test_num = self.suc = 0
        self.take_action_cnt = self.step_lim = 0
        self.eval_success = False
        self.plan_success = True
        self.now_obs: Robotwin = {}
        self.data_type: dict[str, bool] = {"rgb": True, "endpose": True, "qpos": True}
        self.seed = self.ep_num = 0
        self.render_freq = 0
        self.save_data = False
        self.viewer = None
        self.eval_video_path = None
        self._instruction = ""
        self._episode: PolicyEpisode | None = None

    @property
    def episode(self) -> PolicyEpisode:
        """The episode that is being played."""
        if self._episode is None:
            raise RuntimeError("no episode yet: setup_demo(...) begins one")
        return self._episode

    def begin_episode(self, episode: PolicyEpisode) -> None:
        """Switch all members to this episode."""
        self._episode = episode
        self.task_name, self.seed = episode.task, episode.seed
        self.take_action_cnt, self.step_lim = 0, episode.step_limit
        self.eval_success, self.now_obs = False, {}
        self._instruction = episode.instruction
        self.robot, self.cameras = Robot(episode), Cameras(episode)
        senses = episode.recording_spec.senses
        self.data_type |= {key: True for key, sense in DATA_TYPES.items() if sense in senses}

    def get_instruction(self) -> str:
        return self._instruction

    def set_instruction(self, instruction: str) -> None:
        self._instruction = str(instruction)

    def get_obs(self) -> Robotwin:
        """Observation of the present instant in RoboTwin's format (`official`)."""
        self._update_render()
        drawing = [key for key, sense in DATA_TYPES.items() if drawn((sense,))]
        pictures = any(self.data_type.get(key) for key in ("rgb", *drawing))
        now = official(self.episode.observe(), pictures)
        self.now_obs = deepcopy(now)
        return now

    def take_action(self, action: ArrayLike, action_type: ActionKind = "qpos") -> None:
        """Carry out an action (`PolicyEpisode.act`); ignored after success and beyond the limit."""
        if self.take_action_cnt >= self.step_lim or self.eval_success:
            return
        self.take_action_cnt += 1
        self.eval_success = self.episode.act(np.asarray(action, float), action_type)

    def check_success(self) -> bool:
        """Whether the success condition was true at some instant so far."""
        return self.episode.success

    def close_env(self, clear_cache: bool = False) -> None:
        """Nothing to do: the next episode replaces the world."""

    def _update_render(self) -> None:
        """Called before each observation; adapters replace it to save drawing (lazy here)."""
