"""Measure how often tasks with their own domain are feasible under it and under the global domain.

`scripts/feasibility.py --seeds N` tries the same seeds under both domains, without pictures, and
writes docs/results/feasibility.json task by task. `scripts/tables.py` makes a table of it. Tasks
that the file has with so many seeds and this code are not tried again.
"""

from collections import Counter
from typing import Annotated

import rtphys.core.pinned  # noqa: F401  # isort: skip  (before numpy)
import typer

import results
from rtphys.assets.pack import default_pack
from rtphys.core import library
from rtphys.episode import fingerprint
from rtphys.episode.generate import attempt
from rtphys.physics import load_domain
from rtphys.spec.episode import EpisodeSpec
from rtphys.task.spec import load_task

PROTOCOL, DOMAINS = "phys_random", ("own", "global")


def outcomes(task: str, domain: str, seeds: int) -> dict[str, int]:
    """Number of seeds by outcome: "accepted", or why the expert fails."""
    ranges = load_domain(task if domain == "own" else domain)
    spec, loaded = EpisodeSpec(task, PROTOCOL, ranges=ranges), load_task(task)
    tried = (attempt(spec.at(seed), loaded, default_pack()) for seed in range(seeds))
    return dict(Counter(one.reason or "accepted" for one in tried))


def main(seeds: Annotated[int, typer.Option(help="Number of seeds per task and domain.")]) -> None:
    """Count outcomes of every task that has its own domain."""
    known = results.load("feasibility")
    made = {"seeds": seeds, "code": fingerprint.code()}
    tasks = dict(known.get("tasks", {})) if made.items() <= known.items() else {}
    for task in library.names("domains"):
        if task in library.names("tasks") and task not in tasks:
            tasks[task] = {domain: outcomes(task, domain, seeds) for domain in DOMAINS}
            results.save("feasibility", {**made, "tasks": tasks})


if __name__ == "__main__":
    typer.run(main)
