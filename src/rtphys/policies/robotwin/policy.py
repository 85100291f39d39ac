"""A RoboTwin plug-in as a policy: `robotwin:PATH/deploy_policy.py`."""

from collections.abc import Mapping
from contextlib import chdir
from pathlib import Path

from rtphys.core.errors import RtphysError
from rtphys.episode import PolicyEpisode
from rtphys.policies import options
from rtphys.policies.policy import PolicySetup
from rtphys.policies.robotwin.options import user_args
from rtphys.policies.robotwin.plugin import BrokenPlugin, Plugin, load_plugin
from rtphys.policies.robotwin.task_env import TaskEnv

IDLE_CALLS = 1000  # calls of `eval` in a row that may pass without an action


class StuckPlugin(RtphysError):
    """A plug-in that is called again and again and never acts."""


class RoboTwinPolicy:
    """Drives `get_model`, `eval` and `reset_model` as RoboTwin's evaluation does.

    The plug-in runs in its root folder, because it may name files relative to it.

    Raises:
        BrokenPlugin: `get_model` fails.
    """

    needs_images = True

    def __init__(self, plugin: Plugin, usr_args: dict[str, object]) -> None:
        self._plugin, self._args = plugin, usr_args
        self.env = TaskEnv()
        try:
            with chdir(plugin.root):
                self.model = plugin.get_model(usr_args)
        except Exception as error:
            told = f"get_model: {type(error).__name__}: {error}"
            raise BrokenPlugin(f"{plugin.name}: {told}") from error

    def play(self, episode: PolicyEpisode) -> None:
        """Raises whatever the plug-in raises, and `StuckPlugin`."""
        self.env.begin_episode(episode)
        with chdir(self._plugin.root):
            play(self._plugin, self.model, self.env, bool(self._args.get(SKIP)))
        self.env.test_num += 1
        self.env.suc += episode.success

    def close(self) -> None:
        """Nothing to let go of: the model goes with the process."""


SKIP = "skip_get_obs_within_replan"  # a plug-in's wish not to be shown what it will not look at


def play(plugin: Plugin, model: object, env: TaskEnv, skip_unwanted: bool = False) -> None:
    """One episode of an environment that has begun it.

    Raises:
        StuckPlugin: the plug-in does not act. Whatever else it raises passes through.
    """
    plugin.reset_model(model)
    wanted = getattr(model, "should_request_observation", None) if skip_unwanted else None
    idle = 0
    while env.take_action_cnt < env.step_lim and not env.eval_success:
        before = env.take_action_cnt
        observation = env.get_obs() if wanted is None or wanted() else None
        plugin.eval(env, model, observation)
        idle = idle + 1 if env.take_action_cnt == before else 0
        if idle >= IDLE_CALLS:
            raise StuckPlugin(f"{plugin.name}: {IDLE_CALLS} calls of eval without an action")


def told(setup: PolicySetup) -> Mapping[str, object]:
    """What the run decides in `usr_args`."""
    return {
        "task_name": setup.task,
        "task_config": setup.protocol,
        "ckpt_setting": None,
        "seed": setup.seed,
        "instruction_type": setup.split,
    }


def open_robotwin(argument: str, setup: PolicySetup) -> RoboTwinPolicy:
    """`robotwin:PATH/deploy_policy.py[?key=value]`.

    Options override the plug-in's YAML (`deploy_policy.yml` beside it, or `?config=PATH`);
    `?policy_name=a.b.c` is the dotted name under which a launcher would import it.

    Raises:
        BadFile: there is no such plug-in.
        BrokenPlugin: it cannot be imported, or its model cannot be made.
    """
    path, given = options.split(argument, setup.options)
    file = Path(path)
    plugin = load_plugin(file, str(given.get("policy_name", "")))
    beside = file.with_suffix(".yml")
    default = beside if beside.is_file() else None
    config = Path(str(given.pop("config"))) if "config" in given else default
    run = {**told(setup), "policy_name": plugin.name}
    # The task is the run's even where the file names one: RoboTwin's launchers override it too.
    usr_args = user_args(config, run, {"task_name": setup.task, **given})
    return RoboTwinPolicy(plugin, usr_args)
