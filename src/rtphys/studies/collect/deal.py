"""Dealing the leaves and seeds of a collection out to shards."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from rtphys.core.errors import BadValue
from rtphys.data.episode import JSON
from rtphys.data.json_text import plain
from rtphys.physics.domain import Domain
from rtphys.physics.values import plain_value
from rtphys.studies.collect.plan import CollectPlan
from rtphys.studies.collect.shard import Shard, Unit, parse_shard

# All that decides what is collected; the rest is where and how fast.
TOLD = ("first_seed", "protocol", "only", "overrides", "cameras", "layout", "split", "config")
TOLD += ("ranges", "recovery", "twin", "assets", "fallback", "shader", "most_attempts")


def dealt(plans: Sequence[CollectPlan], text: str) -> tuple[CollectPlan, ...]:
    """What one shard has to do of several plans.

    Args:
        text: "i/n", from "1/n" to "n/n".

    Raises:
        BadValue: it is none, or two plans collect the same leaf.
    """
    index, of = parse_shard(text)
    units = sorted((unit(plan, t) for plan in plans for t in plan.tasks), key=lambda u: u.leaf)
    leaves = [one.leaf for one in units]
    if twice := next((leaf for leaf in leaves if leaves.count(leaf) > 1), None):
        raise BadValue("--shard", text, f"{twice} is collected twice")
    shard = Shard(index, of, tuple(units))
    own = {one.leaf for one in shard.own}
    found = []
    for plan in plans:
        tasks = tuple(task for task in plan.tasks if plan.leaf_name(task) in own)
        if tasks:
            found.append(replace(plan, tasks=tasks, shard=shard))
    return tuple(found)


def unit(plan: CollectPlan, task: str) -> Unit:
    """One task of a plan."""
    twin = plan.twin_plan
    other = None if twin is None else twin.leaf_name(task)
    told = {key: getattr(plan, key) for key in TOLD}
    if plan.assets is not None:
        told["assets"] = str(plan.assets)
    if plan.ranges is not None:
        told["ranges"] = plan.ranges.to_json()
    content = plain({"task": task, **told})
    assert isinstance(content, dict)
    return Unit(plan.leaf_name(task), other, plan.episodes, content)


def plan_of(unit: Unit, out: Path, workers: int | None) -> CollectPlan:
    """Inverse of `unit`, for one task and without shards."""
    told = dict(unit.plan)
    task, held = str(told.pop("task")), told.pop("overrides")
    assets, ranges = told.pop("assets"), told.pop("ranges")
    assert isinstance(held, Mapping)
    return CollectPlan(
        (task,),
        unit.episodes,
        out,
        overrides={key: plain_value(value) for key, value in held.items()},
        assets=None if assets is None else Path(str(assets)),
        ranges=Domain.from_json(ranges) if isinstance(ranges, Mapping) else None,
        workers=workers,
        **{key: _tuple(value) for key, value in told.items()},  # type: ignore[arg-type]
    )


def _tuple(value: JSON) -> object:
    return tuple(value) if isinstance(value, list) else value
