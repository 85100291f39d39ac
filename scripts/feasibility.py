"""Try tasks that have a domain of their own under it and under the global one.

`scripts/feasibility.py OUT.json [--seeds N] [--settle] [--again TASK]`: the same seeds under both
domains, without pictures and replays; with `--settle` only until things lie still, which is quick.
A run goes on where the file stops; `--again` counts a task anew on the file's seeds, after its
expert or domain changed. `scripts/tables.py` makes the table of docs/domains.md of
docs/settling.json and docs/feasibility.json.
"""

import json
from collections import Counter
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Annotated

import typer

from rtphys.assets.pack import Pack, default_pack
from rtphys.core import library
from rtphys.core.errors import Infeasible
from rtphys.episode.generate import attempt
from rtphys.episode.instance import prepare, settle
from rtphys.physics import load_domain
from rtphys.setting.setting import Recipe, Setting
from rtphys.task.spec import load_task

PROTOCOL = "phys_random"
DOMAINS = ("own", "global")
SAVED = 10  # [seeds] between two files


def recipe_of(task: str, seed: int, domain: str) -> Recipe:
    """One seed under the task's own domain or another."""
    return Setting(task, PROTOCOL, ranges=load_domain(task if domain == "own" else domain)).at(seed)


def settled(recipe: Recipe, pack: Pack) -> str:
    """Why the episode cannot begin; "accepted" if it can."""
    try:
        settle(prepare(recipe, load_task(recipe.task), pack))
    except Infeasible as problem:
        return problem.reason
    return "accepted"


def solved(recipe: Recipe, pack: Pack) -> str:
    """Why the expert does not solve it; "accepted" if it does."""
    return attempt(recipe, load_task(recipe.task), pack).reason or "accepted"


def counted(
    task: str, seeds: Iterable[int], pack: Pack, judge: Callable[[Recipe, Pack], str]
) -> dict[str, dict[str, int]]:
    """Seeds by outcome under the task's own domain and the global one."""
    return {
        domain: dict(Counter(judge(recipe_of(task, seed, domain), pack) for seed in seeds))
        for domain in DOMAINS
    }


def save(found: dict[str, object], out: Path) -> None:
    out.write_text(json.dumps(found, indent=1, sort_keys=True) + "\n")


def main(
    out: Path,
    seeds: Annotated[int, typer.Option(help="Of each task and domain.")] = 200,
    only_settle: Annotated[
        bool, typer.Option("--settle", help="Only until things lie still.")
    ] = False,
    again: Annotated[list[str] | None, typer.Option(help="A task to count anew.")] = None,
) -> None:
    """Writes the counts."""
    pack, judge = default_pack(), settled if only_settle else solved
    found = json.loads(out.read_text()) if out.exists() else {"seeds": 0, "tasks": {}}
    tasks = [name for name in library.names("domains") if name in library.names("tasks")]
    for task in again or []:
        found["tasks"][task] = counted(task, range(found["seeds"]), pack, judge)
        save(found, out)
    for seed in range(found["seeds"], seeds):
        for task in tasks:
            row = found["tasks"].setdefault(task, {domain: {} for domain in DOMAINS})
            for domain, counts in counted(task, [seed], pack, judge).items():
                row[domain] = dict(Counter(row[domain]) + Counter(counts))
        found["seeds"] = seed + 1
        if (seed + 1) % SAVED == 0 or seed + 1 == seeds:
            save(found, out)


if __name__ == "__main__":
    typer.run(main)
