"""Measure what the expert solves with a robot: `scripts/robots.py ROBOT [--suite NAME]`.

It tries every task under `clean`, then those solved by at least 80 % under `phys_random_all`, on
`--varied N` seeds. The actions of the first two accepted seeds of a task under `clean` are
replayed. All tasks get five seeds before one gets more. A run continues where
docs/results/robots.json (of a suite, robots_NAME.json) ends, also with more seeds. At the end it
prints the robot's row of the table in docs/robots.md.
"""

from collections import Counter
from collections.abc import Iterable, Mapping
from typing import Annotated

import rtphys.core.pinned  # noqa: F401  # isort: skip  (before numpy)
import typer

import results
from rtphys.assets.pack import Pack, default_pack
from rtphys.core import library
from rtphys.episode.control import actions_of, replay
from rtphys.episode.generate import attempt
from rtphys.plan.kinematics import check_robot
from rtphys.spec.episode import EpisodeSpec
from rtphys.task.spec import load_task, task_names

REPLAYED = 2  # accepted seeds of a task whose actions are tried again
BLOCK = 5  # seeds of a task in turn
SOLVED = 0.8  # share of seeds from which a task counts as solved
Counts = dict[str, int]  # seeds tried, accepted, by reason; "replayed", of which "again"


def tried(spec: EpisodeSpec, seeds: Iterable[int], known: Counts, replays: int, pack: Pack) -> None:
    """Add what comes of some seeds to what is known."""
    task, counts = load_task(spec.task), Counter(known)
    for seed in seeds:
        recipe = spec.at(seed)
        found = attempt(recipe, task, pack)
        counts["seeds"] += 1
        counts[found.reason or "accepted"] += 1
        if found.reason:
            print(f"{spec.task} {spec.protocol} {seed}: {found.reason}: {found.detail}")
        elif counts["replayed"] < replays and found.recording is not None:
            counts["replayed"] += 1
            counts["again"] += bool(replay(recipe, task, pack, actions_of(found.recording)))
    known.update(counts)


def solved(by_task: Mapping[str, Counts]) -> list[str]:
    """Tasks of which the expert solves enough."""
    return [
        t for t, counts in by_task.items() if counts.get("accepted", 0) >= SOLVED * counts["seeds"]
    ]


def row(robot: str, counts: Mapping[str, Mapping[str, Counts]]) -> str:
    """Solved tasks, and shares of successes: of all attempts, of solved tasks' varied ones."""
    clean, varied = counts["clean"], counts.get("phys_random_all", {})
    kept = solved(clean)

    def share(tasks: Mapping[str, Counts], of: str, among: str) -> str:
        done, all_ = (sum(c.get(key, 0) for c in tasks.values()) for key in (of, among))
        return f"{done / all_:.0%} ({done} of {all_})" if all_ else ""

    cells = (
        f"`{robot}`",
        f"{len(kept)} of {len(clean)}",
        share(clean, "accepted", "seeds"),
        share({t: varied[t] for t in kept if t in varied}, "accepted", "seeds"),
        share(clean, "again", "replayed"),
    )
    return f"| {' | '.join(cells)} |"


def main(
    robot: str,
    seeds: Annotated[int, typer.Option(help="Seeds of a task under clean.")] = 20,
    varied: Annotated[int, typer.Option(help="Seeds of a task under phys_random_all.")] = 10,
    suite: Annotated[str, typer.Option(help="Its tasks instead of RoboTwin's fifty.")] = "",
) -> None:
    """Measure, and save after every few attempts."""
    pack = default_pack()
    check_robot(pack, robot)
    file = f"robots_{suite}" if suite else "robots"
    known = results.load(file) if (results.RESULTS / f"{file}.json").exists() else {}

    def measure(protocol: str, tasks: list[str], count: int, replays: int) -> dict[str, Counts]:
        counts_of = known.setdefault(robot, {}).setdefault(protocol, {})
        for end in range(BLOCK, count + BLOCK, BLOCK):
            for name in tasks:
                counts = counts_of.setdefault(name, {"seeds": 0})
                missing = range(counts["seeds"], min(end, count))
                tried(EpisodeSpec(name, protocol, embodiment=robot), missing, counts, replays, pack)
                results.save(file, known)
        return counts_of

    tasks = library.suites()[suite] if suite else task_names()
    clean = measure("clean", tasks, seeds, REPLAYED)
    measure("phys_random_all", solved(clean), varied, 0)
    print(row(robot, known[robot]))


if __name__ == "__main__":
    typer.run(main)
