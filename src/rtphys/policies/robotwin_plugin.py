"""Runs unmodified RoboTwin plug-ins: `get_model`, `eval`, `reset_model` of `deploy_policy.py`."""

import importlib
import os
import sys
from collections.abc import Callable, Mapping
from contextlib import chdir
from dataclasses import dataclass
from pathlib import Path

from rtphys.core import library
from rtphys.core.errors import BadFile, RtphysError
from rtphys.episode import PolicyEpisode
from rtphys.policies.policy import PolicySetup
from rtphys.policies.registry import literal, split_options
from rtphys.policies.robotwin_env import TaskEnv

CONTRACT = ("get_model", "eval", "reset_model")
IDLE_CALLS = 1000  # consecutive calls of `eval` without an action after which to give up
ARM_SIZES = ("left_arm_dim", "right_arm_dim")  # arguments: joints of each arm
SKIP = "skip_get_obs_within_replan"  # a plug-in's option to get no observation it will not use


@dataclass(frozen=True)
class Plugin:
    """The three functions of a plug-in, and the folder that it must run in."""

    name: str  # RoboTwin's policy_name; may be dotted
    root: Path  # RoboTwin's root, or the folder above the plug-in's
    get_model: Callable[[dict[str, object]], object]
    eval: Callable[[object, object, object], object]
    reset_model: Callable[[object], object]

    def play(self, model: object, env: TaskEnv, skip_unwanted: bool = False) -> None:
        """Run it through the episode that `env` has begun. Its own errors pass through.

        Raises `RtphysError`: it does not act.
        """
        self.reset_model(model)
        wanted = getattr(model, "should_request_observation", None) if skip_unwanted else None
        idle = 0
        while env.take_action_cnt < env.step_lim and not env.eval_success:
            before = env.take_action_cnt
            observation = env.get_obs() if wanted is None or wanted() else None
            self.eval(env, model, observation)
            idle = idle + 1 if env.take_action_cnt == before else 0
            if idle >= IDLE_CALLS:
                raise RtphysError(f"{self.name}: {IDLE_CALLS} calls of eval without an action")


def plugin_named(name: str, root: Path, file: Path | None = None) -> Plugin:
    """Import a plug-in by its dotted name, from a RoboTwin root as launchers do.

    Raises `RtphysError`: importing it fails, or finds another than `file`, or it lacks one of the
    three functions.
    """
    for path in (root, root / "policy", root / "description" / "utils"):
        if path.is_dir() and str(path) not in sys.path:
            sys.path.append(str(path))
    # A package may re-export the three functions (official ones do), or keep them in its module.
    inner = file.stem if file else "deploy_policy"
    names = [name] if name.endswith(f".{inner}") else [name, f"{name}.{inner}"]
    where, missing = str(file or f"policy_name {name!r}"), list[str]()
    for candidate in names:
        try:
            module = importlib.import_module(candidate)
        except Exception as error:
            raise RtphysError(f"{where}: {type(error).__name__}: {error}") from error
        if file is not None:  # Python silently imports another package of the same name
            places = [module.__file__] if module.__file__ else list(module.__path__)
            home = file.parent.resolve()
            if not any(Path(place).resolve().is_relative_to(home) for place in places):
                problem = f"`import {candidate}` finds {places[0]} instead"
                raise RtphysError(f"{file}: {problem}; rename the plug-in's folder")
        missing = [key for key in CONTRACT if not callable(getattr(module, key, None))]
        if not missing:
            return Plugin(name, root, *(getattr(module, key) for key in CONTRACT))
    lacking = ", ".join(missing)
    raise RtphysError(f"{where}: has no {lacking}; a plug-in defines {', '.join(CONTRACT)}")


def user_args(
    config: Path | None, run: Mapping[str, object], overrides: Mapping[str, object]
) -> dict[str, object]:
    """Arguments for `get_model`: those of the plug-in's YAML file.

    `run` fills in what the file lacks or leaves null; `overrides` take precedence over both.

    Raises `BadFile`: the YAML cannot be read.
    """
    args: dict[str, object] = dict(library.read_yaml(config)) if config else {}
    args |= {key: value for key, value in run.items() if args.get(key) is None}
    return {**args, **overrides}


class RoboTwinPolicy:
    """A plug-in as a policy. It runs in its root folder, because its paths may be relative to it.

    Raises `RtphysError`: `get_model` fails.
    """

    needs_images = True

    def __init__(self, plugin: Plugin, usr_args: dict[str, object]) -> None:
        self._plugin, self._args = plugin, usr_args
        self.env = TaskEnv()
        try:
            with chdir(plugin.root):
                self.model = plugin.get_model(usr_args)
        except Exception as error:
            problem = f"get_model: {type(error).__name__}: {error}"
            raise RtphysError(f"{plugin.name}: {problem}") from error

    def play(self, episode: PolicyEpisode) -> None:
        """Play one episode. Raises `RtphysError`, and whatever the plug-in raises."""
        self.env.begin_episode(episode)
        with chdir(self._plugin.root):
            self._plugin.play(self.model, self.env, bool(self._args.get(SKIP)))
        self.env.test_num += 1
        self.env.suc += episode.success

    def close(self) -> None:
        """Nothing to release: the model ends with the process."""


def open_robotwin(argument: str, setup: PolicySetup) -> RoboTwinPolicy:
    """Opener of `robotwin:PATH/deploy_policy.py[?key=value]`.

    Options override the plug-in's YAML (`deploy_policy.yml` beside it, or `?config=PATH`);
    `?policy_name=a.b.c` is the dotted name under which a launcher would import it.

    Raises `BadFile`: no such plug-in; `RtphysError`: it cannot be imported, or its model cannot be
    created.
    """
    path, texts = split_options(argument, setup.options)
    given = {key: literal(text) for key, text in texts.items()}
    # Launchers link a policy's folder into RoboTwin's root, so links must not be resolved.
    file = Path(os.path.abspath(path))  # noqa: PTH100 - Path has nothing that keeps links
    if not file.is_file():
        raise BadFile(file, "no such plug-in; give the path of its deploy_policy.py")
    name = str(given.get("policy_name") or file.parent.name)
    targets = {folder: folder.joinpath(*name.split(".")) for folder in file.parents}
    homes = [f for f, at in targets.items() if file in (at.with_suffix(".py"), at / file.name)]
    if not homes:
        raise BadFile(file, f"policy_name {name!r} does not lead to this file")
    plugin = plugin_named(name, homes[0].parent if homes[0].name == "policy" else homes[0], file)
    beside = file.with_suffix(".yml")
    named = given.pop("config", beside if beside.is_file() else "")
    config = Path(str(named)) if named else None
    run = {
        "task_name": setup.task,
        "task_config": setup.protocol,
        "ckpt_setting": None,
        "seed": setup.seed,
        "instruction_type": setup.split,
        "policy_name": plugin.name,
    }
    # The run's task takes precedence over the file's: RoboTwin's launchers override it too.
    more = {"task_name": setup.task, **given}
    arms = dict(zip(ARM_SIZES, setup.arm_joints, strict=True))
    return RoboTwinPolicy(plugin, {**user_args(config, run, more), **arms})
