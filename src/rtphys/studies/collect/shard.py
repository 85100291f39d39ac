"""One part of a collection that several machines make without talking to each other.

Whole task datasets are given to shards when there are at least as many as shards. Otherwise the
shards form as many equal groups as possible, and the m shards of a group share each of their task
datasets seed by seed: every m-th seed each, until each has 1/m of the episodes. They have then
tried different numbers of seeds; the seeds that are missing are tried when the shards are merged.
What a shard has to do depends on the command and on i and n alone.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from rtphys.core.errors import BadFile, BadValue
from rtphys.data import files, schema
from rtphys.data.episode import JSON
from rtphys.data.faults import DatasetMismatch
from rtphys.data.json_text import parse_mapping, plain, pretty
from rtphys.data.layout import SHARD
from rtphys.data.manifest import journals_below
from rtphys.setting.setting import Setting
from rtphys.studies.collect.plan import Run, TaskPlan

# What a shard's file keeps of a setting, of a plan and of a run, by field.
OF_SETTING = ("task", "protocol", "only", "overrides", "split", "ranges", "recovery", "pair_tasks")
OF_PLAN = ("first_seed", "cameras", "layout", "config", "twin", "most_attempts")
OF_RUN = ("assets", "fallback", "shader")


@dataclass(frozen=True)
class Unit:
    """A task dataset, with its twin if it has one, as the whole collection wants it."""

    folder: str  # below `out`
    twin: str | None
    episodes: int
    plan: Mapping[str, JSON]  # what else decides it

    @staticmethod
    def of(plan: TaskPlan, run: Run) -> "Unit":
        """What the whole collection wants of one plan."""
        setting = {"ranges": None, "recovery": True, "pair_tasks": False, **plan.setting.to_json()}
        content = {key: setting[key] for key in OF_SETTING}
        content |= {key: getattr(plan, key) for key in OF_PLAN}
        content |= {"assets": None if run.assets is None else str(run.assets)}
        content |= {"fallback": run.fallback, "shader": run.shader}
        folders = [side.folder for side in plan.sides]
        kept = {key: plain(value, key) for key, value in content.items()}
        return Unit(folders[0], folders[1] if plan.twin else None, plan.episodes, kept)

    def task_plan(self) -> TaskPlan:
        """The plan that it was made from."""
        kept = {key: self.plan[key] for key in OF_SETTING if key in self.plan}
        setting = Setting(**kept)  # type: ignore[arg-type] - validated
        rest = {key: self.plan[key] for key in OF_PLAN}
        return TaskPlan(setting, self.episodes, **rest)  # type: ignore[arg-type] - likewise

    def run(self, out: Path, workers: int | None) -> Run:
        """A run that makes what is missing of it."""
        kept = {key: self.plan[key] for key in OF_RUN}
        return Run(out, workers, **kept)  # type: ignore[arg-type] - validated

    def to_json(self) -> dict[str, object]:
        """As `shard.json` holds it."""
        return {
            "leaf": self.folder,
            "twin": self.twin,
            "episodes": self.episodes,
            "plan": self.plan,
        }

    @property
    def folders(self) -> tuple[str, ...]:
        """Folders of the task dataset and of its twin."""
        return (self.folder,) if self.twin is None else (self.folder, self.twin)


@dataclass(frozen=True)
class Shard:
    """Part `index` (from 1) of `of`, of a collection of `units`, sorted by folder."""

    index: int
    of: int
    units: tuple[Unit, ...]

    @staticmethod
    def parse(plans: Sequence[TaskPlan], run: Run) -> "Shard":
        """The shard that `run.shard` names: "i/n", from "1/n" to "n/n". Raises `BadValue`."""
        index, _, of = run.shard.partition("/")
        if not (index.isdecimal() and of.isdecimal() and 1 <= int(index) <= int(of)):
            raise BadValue("shard", run.shard, "write i/n, from 1/n to n/n")
        units = sorted((Unit.of(plan, run) for plan in plans), key=lambda unit: unit.folder)
        return Shard(int(index), int(of), tuple(units))

    def __str__(self) -> str:
        return f"shard {self.index}/{self.of}"

    @property
    def groups(self) -> int:
        """Number of groups of shards; each group has its own units."""
        count = len(self.units)
        return self.of if count >= self.of else math.gcd(count, self.of)

    @property
    def stride(self) -> tuple[int, int]:
        """First attempt and step of this shard, in each of its task datasets."""
        sharing = self.of // self.groups
        return (self.index - 1) % sharing, sharing

    @property
    def own(self) -> tuple[Unit, ...]:
        """What this shard works on, alone or with others of its group."""
        _, sharing = self.stride
        return self.units[(self.index - 1) // sharing :: self.groups]

    def share(self, episodes: int) -> int:
        """This shard's part of a number of episodes, rounded up."""
        return math.ceil(episodes / self.stride[1])

    @property
    def plans(self) -> tuple[TaskPlan, ...]:
        """What this shard makes: its units, with its share of their episodes."""
        return tuple(
            replace(unit.task_plan(), episodes=self.share(unit.episodes)) for unit in self.own
        )


def own_plans(plans: Sequence[TaskPlan], run: Run) -> Sequence[TaskPlan]:
    """What a run makes of a collection: all of it, or its shard. Raises `BadValue`."""
    return Shard.parse(plans, run).plans if run.shard else plans


def read_shard(out: Path) -> Shard | None:
    """The shard that a folder holds; None if it is no shard. Raises `BadFile`."""
    path = out / SHARD
    if not path.exists():
        return None
    try:
        known = schema.check("shard", parse_mapping(files.read(path), path))
    except schema.SchemaError as error:
        raise BadFile(path, "; ".join(error.problems)) from error
    assert isinstance(known, schema.ShardFile)
    units = (Unit(unit.leaf, unit.twin, unit.episodes, dict(unit.plan)) for unit in known.units)
    return Shard(known.index, known.of, tuple(units))


def claim(out: Path, shard: Shard | None) -> None:
    """Makes a folder that of a shard, or checks that it is.

    More episodes than before may be asked for, as without shards.

    Raises:
        DatasetMismatch: it is another shard's, or that of another collection.
    """
    stored = read_shard(out)
    if stored is None and shard is None:
        return
    if stored is None and journals_below(out):
        raise DatasetMismatch(out, [f"it was no shard, now {shard}"])
    if stored is not None:
        if shard is None or (stored.index, stored.of) != (shard.index, shard.of):
            raise DatasetMismatch(out, [f"it was {stored}, now {shard or 'no shard'}"])
        if [unit.folders for unit in stored.units] != [unit.folders for unit in shard.units]:
            raise DatasetMismatch(out, ["it was a shard of other tasks or configurations"])
    if shard is not None and stored != shard:
        content = {"index": shard.index, "of": shard.of}
        units = [unit.to_json() for unit in shard.units]
        files.replace_file(out / SHARD, pretty(plain({**content, "units": units})))
