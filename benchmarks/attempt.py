"""CPU-seconds of a physics-only attempt, by task and phase: `benchmarks/attempt.py [SEEDS]`.

The first attempt of each task is not counted: it fills caches that a run fills once. Wall time on
a shared machine says little; CPU time of this process is what is printed.
"""

import sys
import time
from collections.abc import Callable

import numpy as np
from lib.tables import write

from rtphys.assets.pack import default_pack
from rtphys.errors import Infeasible
from rtphys.expert.robot import ExpertRobot
from rtphys.generate import start
from rtphys.instance import prepare, settle
from rtphys.recipe import Recipe
from rtphys.seeds import stream
from rtphys.sim.rollout import Rollout
from rtphys.task.spec import Task, load_task, task_names

PROTOCOL = "phys_random"
PHASES = ("build", "settle", "plan", "simulate", "sum")


class Clock:
    """CPU-seconds by phase."""

    def __init__(self) -> None:
        self.spent = dict.fromkeys(PHASES, 0.0)

    def time(self, phase: str, step: Callable[[], object]) -> object:
        began = time.process_time()
        try:
            return step()
        finally:
            self.spent[phase] += time.process_time() - began


def attempt(task: Task, seed: int) -> dict[str, float]:
    """One attempt, as `rtphys.generate.attempt` makes it."""
    clock = Clock()
    clock.time("sum", lambda: _phases(Recipe(task.name, seed, PROTOCOL), task, clock))
    return clock.spent


def _phases(recipe: Recipe, task: Task, clock: Clock) -> None:
    try:
        instance = clock.time("build", lambda: prepare(recipe, task, default_pack()))
        clock.time("settle", lambda: settle(instance))  # type: ignore[arg-type]
        rollout = start(instance)  # type: ignore[arg-type]
        clock.time("plan", lambda: _script(rollout, recipe, task, clock))
        clock.time("simulate", rollout.finish)
    except Infeasible:
        pass
    clock.spent["plan"] -= clock.spent.get("ticks", 0.0)
    clock.spent["simulate"] += clock.spent.pop("ticks", 0.0)


def _script(rollout: Rollout, recipe: Recipe, task: Task, clock: Clock) -> None:
    tick, clock.spent["ticks"] = rollout.tick, 0.0
    rollout.tick = lambda: clock.time("ticks", tick)  # type: ignore[method-assign,assignment]
    try:
        task.script(ExpertRobot(rollout, stream(recipe.seed, "expert")))
    finally:
        rollout.tick = tick  # type: ignore[method-assign]


def main(seeds: int = 10) -> None:
    rows: dict[str, dict[str, float]] = {}
    for name in task_names():
        task = load_task(name)
        attempt(task, 0)
        spent = [attempt(task, seed) for seed in range(seeds)]
        rows[name] = {phase: float(np.mean([s[phase] for s in spent])) for phase in PHASES}
    rows["mean"] = {p: float(np.mean([row[p] for row in rows.values()])) for p in PHASES}
    write("attempt", f"CPU-seconds an attempt, {PROTOCOL}, {seeds} seeds", rows)


if __name__ == "__main__":
    main(*map(int, sys.argv[1:2]))
