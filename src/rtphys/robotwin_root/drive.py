"""Stand-in for RoboTwin's `script/eval_policy.py`: evaluates one policy in one task."""

import argparse
import importlib
import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from datetime import UTC, datetime
from itertools import count
from pathlib import Path

from rtphys.assets.pack import default_pack
from rtphys.core import library
from rtphys.core.errors import BadValue, RtphysError, UnknownName
from rtphys.episode.fingerprint import fingerprint_of
from rtphys.policies.registry import literal
from rtphys.policies.robotwin_plugin import ARM_SIZES, SKIP, Plugin, plugin_named, user_args
from rtphys.results.instances import FIRST_SEED, BenchmarkInstance, benchmark_file, read_list
from rtphys.results.official import write_result
from rtphys.robotwin_root.base_task import (
    SEED,
    Base_Task,
    UnStableError,
    generate_episode_descriptions,
    protocol_of,
    robot_of,
)
from rtphys.spec.episode import SPLITS
from rtphys.task.spec import load_task

MAX_INFEASIBLE = 200  # consecutive infeasible seeds after which the run ends


def parse_args_and_config(words: Sequence[str] | None = None) -> dict[str, object]:
    """Parse RoboTwin's command line, `--config FILE --overrides --key value ...`, into `usr_args`.

    Raises `BadFile`, `BadValue`: the file cannot be read, or a key has no value.
    """
    parser = argparse.ArgumentParser()
    parser.add_argument("--config", type=Path, required=True)
    parser.add_argument("--overrides", nargs=argparse.REMAINDER, default=[])
    given = parser.parse_args(words)
    run = {"task_config": "clean", "ckpt_setting": "default", "seed": 0}
    run |= {"instruction_type": "unseen"}
    return user_args(given.config, run, pairs(given.overrides))


def pairs(words: Sequence[str]) -> dict[str, object]:
    """The words of RoboTwin's override option, `--key value --key value`, as a mapping.

    Values are Python literals, or text. (RoboTwin evaluates them as code; we do not.)

    Raises `BadValue`: a key without a value.
    """
    if len(words) % 2:
        raise BadValue("overrides", words[-1], "it is a key without a value")
    keys = (word.lstrip("-") for word in words[::2])
    return dict(zip(keys, map(literal, words[1::2]), strict=True))


def evaluate(usr_args: dict[str, object], test_num: int) -> Path:
    """Run the episodes in this process; returns the `_result_*.txt` written below `eval_result/`.

    Seed 0 uses the certified instances if there are any, and they are not stale. Other seeds,
    protocols without such a list, and more episodes than a list has, let the expert search for
    feasible seeds from `100000 * (1 + seed)`, or from the end of the list, as RoboTwin does.
    Textures are always the unseen ones; `instruction_type` chooses the sentences. What the policy
    raises ends the run without a result.

    `eval_num_episodes` or `test_num` in `usr_args` override the number of episodes; the result is
    also written to its `eval_output_dir`.

    Raises `BadFile`, `UnknownName`: the configuration, task, policy or kind of instruction does not
    exist; `BadValue`: no task or policy is named; `RtphysError`: a plug-in that cannot be imported,
    or too few feasible seeds.
    """
    split = str(usr_args["instruction_type"])
    if split not in SPLITS:
        raise UnknownName("instruction type", split, SPLITS)
    for key in ("task_name", "policy_name"):
        if not usr_args.get(key):
            why = f"the policy's configuration or `--overrides --{key} NAME` states it"
            raise BadValue(key, usr_args.get(key), why)
    wanted = int(str(usr_args.get("eval_num_episodes") or usr_args.get("test_num") or test_num))
    root, task, config = Path.cwd(), str(usr_args["task_name"]), str(usr_args["task_config"])
    args = dict(library.read_yaml(root / "task_config" / f"{config}.yml"))
    args |= {"task_name": task, "task_config": config, "eval_mode": True}
    plugin = plugin_named(str(usr_args["policy_name"]), root)
    env = getattr(importlib.import_module(f"envs.{task}"), task)()
    assert isinstance(env, Base_Task)
    per_arm = default_pack().embodiment(robot_of(args)).action_layout.per_arm
    usr_args = {**usr_args, **dict(zip(ARM_SIZES, per_arm, strict=True))}
    run = Run(usr_args, args, env, plugin, plugin.get_model(usr_args))
    for seed in run.seeds():
        run.roll_out(seed)
        if env.test_num >= wanted:
            break
    # As text, because a checkpoint named by an absolute path must not lead out of eval_result.
    where = f"{task}/{plugin.name}/{config}/{usr_args['ckpt_setting']}"
    place = root / f"eval_result/{where}/{datetime.now(UTC):%Y%m%d_%H%M%S}"
    counts = (env.test_num, run.tried, env.suc)
    path = write_result(place, protocol_of(args), split, counts)
    if more := usr_args.get("eval_output_dir"):
        write_result(root / str(more), protocol_of(args), split, counts)
    print(f"Data has been saved to {os.path.relpath(path, root)}")
    return path


@dataclass
class Run:
    """State of evaluating one policy in one task under one configuration."""

    usr_args: Mapping[str, object]
    args: dict[str, object]  # of the task configuration
    env: Base_Task
    plugin: Plugin
    model: object
    tried: int = 0  # number of seeds so far, infeasible ones included

    def seeds(self) -> Iterator[int]:
        """Seeds that the expert solves; the others are only counted.

        Raises `RtphysError`: it solves none of `MAX_INFEASIBLE` in a row.
        """
        first = int(str(self.usr_args["seed"]))
        known = self._certified() if first == 0 else ()
        for one in known:
            self.tried += 1
            if one.feasible:
                yield one.seed
        infeasible = 0  # in a row
        for seed in count(FIRST_SEED * (1 + first) + len(known)):
            self.tried += 1
            solved = False
            with suppress(UnStableError):
                self.env.setup_demo(self.env.test_num, seed, True, **self.args)
                self.env.play_once()
                solved = self.env.check_success()
            infeasible = 0 if solved else infeasible + 1
            if solved:
                yield seed
            elif infeasible >= MAX_INFEASIBLE:  # a rate would pass for one of all episodes
                text = f"the expert solves none of the {infeasible} seeds up to {seed}"
                raise RtphysError(f"{self.env.task_name}: {text}; no result is written")

    def _certified(self) -> tuple[BenchmarkInstance, ...]:
        """The benchmark's seeds; none where this robot, code or pack gives other episodes."""
        task, protocol = self.env.task_name, protocol_of(self.args)
        path = benchmark_file(protocol, task)
        if not path.is_file() or (listed := read_list(path, task)) is None:
            return ()
        now = fingerprint_of(load_task(task), protocol, default_pack(), robot_of(self.args))
        if clauses := listed.fingerprint.changes(now):
            print(f"The expert searches for seeds, since the list is stale: {'; '.join(clauses)}")
            return ()
        return listed.instances

    def roll_out(self, seed: int) -> None:
        """Play one episode with the policy. What it raises passes through, as in RoboTwin."""
        env = self.env
        env.setup_demo(env.test_num, seed, True, **self.args)
        (said,) = generate_episode_descriptions(env.task_name, [{SEED: seed}], 1)
        env.set_instruction(said[str(self.usr_args["instruction_type"])][0])
        self.plugin.play(self.model, env, bool(self.usr_args.get(SKIP)))
        env.suc += env.eval_success
        env.test_num += 1
        env.close_env()
        header = f"{env.task_name} | {self.plugin.name} | {self.args['task_config']}"
        rate = 100 * env.suc / env.test_num
        print(f"{header}\nSuccess rate: {env.suc}/{env.test_num} => {rate:.1f}%, seed {seed}")
