"""One evaluation episode: a settled world that a policy observes and acts in."""

from functools import partial

from rtphys.assets.pack import Pack
from rtphys.core.poses import Array
from rtphys.episode.assemble import describer
from rtphys.episode.control import ActionKind, ActionLog, PolicyControl
from rtphys.episode.generate import Instance, prepare, settle, start
from rtphys.episode.observation import Mirror, Observation
from rtphys.episode.touch import felt_now
from rtphys.sim.recorder import FRAME_STEPS
from rtphys.sim.rollout import Keep, Outcome, Rollout, RolloutOptions
from rtphys.spec.episode import Recipe
from rtphys.spec.recording import RecordingSpec
from rtphys.task.instructions import instructions
from rtphys.task.spec import Task

USUAL = RecordingSpec()  # head and both wrists, colours alone


def begin(
    recipe: Recipe,
    task: Task,
    pack: Pack,
    recording_spec: RecordingSpec = USUAL,
    keep: Keep = "rows",
    sentences: str | None = None,
) -> "PolicyEpisode":
    """Builds the world of a recipe and lets it settle.

    Args:
        recording_spec: the cameras that observations show, and what these are asked for.
        keep: what is recorded (`RolloutOptions`); whoever draws or stores the episode needs rows.
        sentences: "seen" or "unseen"; None: as the recipe's textures.

    Raises `Infeasible`: "layout", "invalid_physics" or "unsettled"; never on a certified seed.
    """
    instance = prepare(recipe, task, pack)
    settle(instance)
    return PolicyEpisode(instance, pack, recording_spec, keep, sentences)


class PolicyEpisode:
    """Observations out, actions in, until it is over.

    It is over at the first instant at which the task's success condition holds (polled after every
    physics step), or when the task's number of actions is used up.

    Attributes:
        instruction: a sentence of the chosen split, the same one for the same seed.
        step_limit: actions that the task allows.
        rollout: the world and its recorder; for the expert, tests and videos, never for a policy.
    """

    def __init__(
        self,
        instance: Instance,
        pack: Pack,
        recording_spec: RecordingSpec,
        keep: Keep,
        sentences: str | None,
    ) -> None:
        recipe, task = instance.recipe, instance.task
        self.instance, self.recipe, self.recording_spec = instance, recipe, recording_spec
        self.task, self.protocol, self.seed = task.name, recipe.protocol, recipe.seed
        self.step_limit = task.step_limit
        options = RolloutOptions(keep=keep, touch=recording_spec.touch)
        self.rollout: Rollout = start(instance, options)
        self._control = PolicyControl(self.rollout, recipe.seed)
        self._mirror = Mirror(instance, pack, recording_spec)
        self._outcome: Outcome | None = None
        split = sentences or recipe.spec.split
        self.instruction = instructions(task, recipe.seed, describer(pack))[split][0]

    @property
    def taken(self) -> int:
        """Actions so far."""
        return self._control.actions

    @property
    def unreachable(self) -> int:
        """How often an arm was sent where it cannot go, and kept still."""
        return self._control.unreachable

    @property
    def log(self) -> ActionLog:
        """Where its actions did not fit the robot."""
        return self._control.log

    @property
    def success(self) -> bool:
        """Whether the success condition has held at some instant."""
        return self.rollout.first_success is not None

    @property
    def over(self) -> bool:
        """Whether further actions do nothing."""
        return self._outcome is not None or self.success or self.taken >= self.step_limit

    @property
    def reason(self) -> str:
        """Why there is no success: "running", "step_limit" or "gave_up"; empty with one."""
        if self.success:
            return ""
        if self.taken >= self.step_limit:
            return "step_limit"
        return "running" if self._outcome is None else "gave_up"

    def observe(self) -> Observation:
        """The world now; also after the end."""
        rollout = self.rollout
        packed, touch = rollout.world.scene.pack_poses(), rollout.recorder.touch
        return Observation(
            rollout.scene.time,
            rollout.world.robot,
            draw=partial(self._mirror.view, packed, rollout.steps // FRAME_STEPS),
            feel=None if touch is None else partial(felt_now, touch.track, touch.last()),
        )

    def act(self, action: Array, kind: ActionKind = "qpos") -> bool:
        """One action (`PolicyControl.act`); true if the episode has succeeded. Ignored when over.

        Raises `BadValue`: an action that no robot can be given; `UnknownName`: no such kind of
        action.
        """
        if not self.over:
            self._control.act(action, kind)
        return self.success

    def conclude(self, actions: int, outcome: Outcome | None) -> None:
        """Ends the episode for somebody who drove `rollout` instead of acting.

        Args:
            actions: what it was worth.
            outcome: its own verdict; None: it gave up, and the world is judged as it is.
        """
        self._control.actions, self._outcome = actions, outcome

    def finish(self) -> Outcome:
        """Ends the episode: both arms stop where they are commanded to be, then it is judged.

        Repeating it changes nothing.
        """
        if self._outcome is None:
            for arm in self.rollout.world.robot.arms:
                arm.stop()
            # What succeeds only after the policy has stopped is not its success.
            self._outcome = self.rollout.finish(counts_success=False)
        return self._outcome


def object_poses(episode: PolicyEpisode) -> dict[str, Array]:
    """Task object -> (7,) xyz [m] + wxyz, world frame, as datasets store `object_poses`."""
    objects = episode.rollout.world.objects
    return {name: scene_object.pose.flat for name, scene_object in objects.items()}


def joint_positions(episode: PolicyEpisode) -> dict[str, float]:
    """Articulated task object -> position of its first joint [rad or m]; 0 if it has none."""
    return {
        name: float(scene_object.articulation.qpos[0]) if scene_object.articulation.dof else 0.0
        for name, scene_object in episode.rollout.world.objects.items()
        if scene_object.articulation is not None
    }
