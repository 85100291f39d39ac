"""A task as a Gymnasium environment, with the same worlds as `rtphys evaluate`."""

from collections.abc import Mapping, Sequence

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from rtphys.assets.embodiment import DEFAULT
from rtphys.assets.pack import default_pack
from rtphys.core.errors import BadFile, BadValue, Infeasible, UnknownName, counted
from rtphys.episode import PolicyEpisode, begin
from rtphys.episode.control import ActionKind
from rtphys.episode.policy_episode import joint_positions, object_poses
from rtphys.gym import shapes
from rtphys.physics.attribute import is_attribute
from rtphys.physics.domain import check_overrides
from rtphys.physics.idle import why_idle
from rtphys.physics.values import Value, plain_value
from rtphys.plan.kinematics import check_robot
from rtphys.policies.baselines import limits
from rtphys.results.instances import benchmark_file, read_list
from rtphys.senses import SENSES
from rtphys.spec.episode import EpisodeSpec
from rtphys.spec.protocol import load_protocol
from rtphys.spec.recording import USUAL, RecordingSpec
from rtphys.task.props import parts
from rtphys.task.spec import load_task

Obs = dict[str, object]
Info = dict[str, object]
MODES = ("state", "pixels")
CONTROLS: dict[str, ActionKind] = {"official": "qpos", "tracking": "tracked_qpos"}
MAX_SEEDS = 100  # consecutive seeds without a world after which `reset` fails
OPTIONS = ("protocol", "physics", "split", "index")
OF_LEROBOT = "lerobot_new_rollout"  # an option that LeRobot's evaluation sends to every environment


class TaskEnv(gymnasium.Env[Obs, NDArray[np.float32]]):
    """Environment of one task; actions are absolute joint targets and openings (`ActionLayout`).

    The reward is 1 at the instant of success, which terminates the episode, and 0 otherwise; the
    task's action limit truncates it. `info` always holds the physics, observations on request.

    Protocol, physics and split hold in every episode, also in those that a vector environment
    begins by itself. Options of `reset` hold in one episode.

    Args:
        task: as in `rtphys tasks`.
        protocol: clean, official_random, phys_random, phys_random_all, or a library's own.
        obs: "state" (commands, measurements, object poses) or "pixels" (commands, pictures).
        show_physics: add the attributes to observations, under "physics", and the values of single
            props as `friction@left_block`.
        senses: also observe "depth" [m], "segmentation" (ids of bodies, named in `info["bodies"]`)
            "pointcloud", or "touch" (what each finger feels), each under its name.
        render_mode: "rgb_array", the picture of the head camera.
        control: "official": each action is a motion from rest to rest and lasts until it ends;
            "tracking": each action lasts one frame (60 ms), and the arms continue at their present
            speed, as on a real robot.
        embodiment: the robot, a name of the asset pack or LEFT,RIGHT,DISTANCE; it decides the
            length of an action.
        physics: attributes that are held at a value, such as `{"friction": 0.2}`; a warning says
            which could not act.
        split: "seen" or "unseen" textures and sentences.

    Raises:
        UnknownName: no such task, protocol, control, robot, sense, attribute, observation or render
            mode.
        BadValue: a value of an attribute that the simulator does not support.
        BadFile, MissingAsset: the robot's description is not usable.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 17}  # noqa: RUF012 - as in gymnasium

    def __init__(
        self,
        task: str,
        protocol: str = "clean",
        obs: str = "state",
        show_physics: bool = False,
        render_mode: str | None = None,
        control: str = "official",
        senses: Sequence[str] = (),
        embodiment: str = DEFAULT,
        physics: Mapping[str, object] | None = None,
        split: str = "unseen",
    ) -> None:
        if obs not in MODES:
            raise UnknownName("observation", obs, MODES)
        if control not in CONTROLS:
            raise UnknownName("control", control, CONTROLS)
        if render_mode is not None and render_mode not in self.metadata["render_modes"]:
            raise UnknownName("render mode", render_mode, self.metadata["render_modes"])
        self._task, self._pack = load_task(task), default_pack()
        self._lasting = {"protocol": protocol, "physics": physics or {}, "split": split}
        self._robot, self._obs = embodiment, obs
        self._shown: list[str] = []  # keys of the physics in observations
        self._kind: ActionKind = CONTROLS[control]
        self.render_mode = render_mode
        robot = check_robot(self._pack, self._spec({}).embodiment)
        bounds = limits(robot).astype(np.float32)
        states = obs == "state"
        parts = shapes.state(bounds, self._task.props(0)) if states else shapes.pixels(bounds)
        if show_physics:
            drawn = self._spec({}).draw(0)
            self._shown = [key for key in drawn if is_attribute(key)]
            parts["physics"] = shapes.physics(self._shown)
        self._recording = RecordingSpec(senses=tuple(senses))
        parts |= shapes.sensed(self._recording)
        self.action_space = shapes.commands(bounds)
        space = spaces.Dict(parts)
        self.observation_space = space  # pyright: ignore[reportAttributeAccessIssue] - of mappings
        self._episode: PolicyEpisode | None = None
        self._attempts = 0
        self._bodies: tuple[str, ...] = ()  # name of each id, once it is known

    def _spec(self, options: Mapping[str, object]) -> EpisodeSpec:
        """All of an episode but its seed. Raises `UnknownName`, `BadValue`."""
        now = {**self._lasting, **options}
        if not isinstance(held := now["physics"], Mapping):
            raise BadValue("physics", held, "it must map attributes to values")
        values = {
            str(key): plain_value(
                value.tolist() if isinstance(value, np.ndarray | np.generic) else value
            )
            for key, value in held.items()
        }
        check_overrides(values)
        spec = EpisodeSpec(
            task=self._task.name,
            protocol=str(now["protocol"]),
            overrides=values,
            split=str(now["split"]),
            embodiment=self._robot,
        )
        load_protocol(spec.protocol)
        return spec

    def reset(
        self, *, seed: int | None = None, options: Mapping[str, object] | None = None
    ) -> tuple[Obs, Info]:
        """Begin a new episode.

        Args:
            seed: of the episode, as in `rtphys collect`; also seeds later episodes without a seed.
                If the world never comes to rest, the next seed is tried.
            options: of this episode alone: `{"protocol": name, "physics": {attribute: value},
                "split": "seen", "index": n}`; certified instance n replaces the seed, and no other
                seed is tried.

        Raises:
            UnknownName, BadValue: an option is wrong.
            BadFile: `index` is given, but nothing is certified.
            Infeasible: 100 consecutive seeds give no world, or the instance gives none.
        """
        super().reset(seed=seed)
        given = {key: value for key, value in (options or {}).items() if key != OF_LEROBOT}
        for key in given:
            if key not in OPTIONS:
                raise UnknownName("reset option", key, OPTIONS)
        index, spec = given.pop("index", None), self._spec(given)
        if index is not None:
            seed = certified_seed(spec, index)
        first = int(self.np_random.integers(2**31)) if seed is None else seed
        most = MAX_SEEDS if index is None else 1
        for tried in range(most):
            self._attempts = tried + 1
            recipe = spec.at(first + tried)
            try:
                self._episode = begin(recipe, self._task, self._pack, self._recording)
                break
            except Infeasible:
                if self._attempts == most:
                    raise
        self._warn_of_idle(spec)
        return self._observation(), self._info()

    def _warn_of_idle(self, spec: EpisodeSpec) -> None:
        """Warns of values that change nothing, since the attribute could not act in the episode."""
        instance = self._running().instance
        for key, value in spec.overrides.items():
            if not is_attribute(key):
                continue
            if why := why_idle(key, instance.physics, parts(instance.props), value):
                gymnasium.logger.warn(f"{key} could not act in {spec.task}: {why}")

    def step(self, action: NDArray[np.float32]) -> tuple[Obs, float, bool, bool, Info]:
        """Carry out one action, clipped to the limits.

        Raises:
            BadValue: an action of the wrong length, or with numbers that are not finite.
            gymnasium.error.ResetNeeded: before the first `reset`.
        """
        episode = self._running()
        episode.act(np.asarray(action, float), self._kind)
        done = episode.success
        return self._observation(), float(done), done, episode.over and not done, self._info()

    def render(self) -> NDArray[np.uint8] | None:
        """Picture of the head camera (240, 320, 3) RGB, None without mode. Raises `NoRenderer`."""
        return self._running().observe().images["head"] if self.render_mode else None

    def close(self) -> None:
        self._episode = None

    def _running(self) -> PolicyEpisode:
        if self._episode is None:
            raise gymnasium.error.ResetNeeded("call reset() first")
        return self._episode

    def _observation(self) -> Obs:
        episode = self._running()
        now = episode.observe()
        found: dict[str, object] = {"agent_pos": now.vector}
        if self._obs == "state":
            found |= {
                "measured": now.measured,
                "velocities": now.velocities,
                "efforts": now.efforts,
                "endposes": now.endposes,
                "objects": object_poses(episode),
            }
            if joints := joint_positions(episode):
                found["joints"] = joints
        shown = shapes.single(found)
        if self._obs == "pixels":
            shown["pixels"] = {name: now.images[name] for name in USUAL}
        if self._shown:
            shown["physics"] = shapes.physics_of(episode.instance, self._shown)
        for name in self._recording.senses:
            sense = SENSES[name]
            if sense.scope == "pixel":
                seen = {camera: now.cameras[camera].senses for camera in USUAL}
                shown[name] = {camera: sense.observed(one) for camera, one in seen.items()}
            elif sense.drawn:
                shown[name] = sense.observed(now.cameras["head"].senses)
            else:
                felt = sense.capture(now.touch)
                shown[name] = sense.observed({key: frames[0] for key, frames in felt.items()})
            if ids := sense.fields[0].ids:
                self._bodies = now.view.names[ids]
        return shown

    def _info(self) -> Info:
        episode = self._running()
        return {
            "seed": episode.seed,
            "protocol": episode.protocol,
            "instruction": episode.instruction,
            "physics": {key: _number(value) for key, value in episode.instance.physics.items()},
            "attempts": self._attempts,
            "success": episode.success,
            "reason": episode.reason,
            "time": episode.rollout.scene.time,
            **({"bodies": self._bodies} if self._bodies else {}),
        }


def _number(value: Value) -> Value:
    """A vector environment's array of an integer would round the numbers of the other episodes."""
    return float(value) if isinstance(value, int) else value


def certified_seed(spec: EpisodeSpec, index: object) -> int:
    """Seed of a certified instance, counted from 0.

    Raises:
        BadFile: the task is not certified under this protocol.
        BadValue: no such number, or the instances are another robot's.
    """
    if isinstance(index, bool) or not isinstance(index, int | np.integer) or index < 0:
        raise BadValue("index", index, "it must be an integer, counting certified instances from 0")
    if spec.embodiment != DEFAULT:
        raise BadValue("index", index, f"instances are certified for the {DEFAULT} alone")
    listed = read_list(path := benchmark_file(spec.protocol, spec.task), spec.task)
    if listed is None:
        raise BadFile(path, f"has no list of {spec.task}")
    feasible = listed.feasible
    if index >= len(feasible):
        raise BadValue("index", index, f"certified: {counted(len(feasible), 'instances')}")
    return feasible[index].seed
