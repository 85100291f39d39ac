"""Collections without a robot: an episode is three small files, so that many can be made."""

import os
import shutil
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from numpy.random import Generator

from rtphys.core.seeds import stream
from rtphys.core.untrusted import JSON
from rtphys.data import files
from rtphys.data.staging import HDF5, INSTRUCTION, VIDEO, StagedEpisode
from rtphys.data.writer import Rejection
from rtphys.spec.collection import CollectionSpec, Resolved, TaskHeader
from rtphys.spec.episode import EpisodeSpec, Recipe
from rtphys.spec.sweep import swept
from rtphys.studies.collect import collect as collect_plans
from rtphys.studies.collect_worker import CollectionTask, Results
from rtphys.studies.requests import Run, specs_for

TASKS = ("click_bell", "lift_pot", "stamp_seal")
RARE = TASKS[0]
HARD = "place_shoe"  # rarely succeeds
EPISODES = 12
MADE: list[int] = []
"""Seeds that were tried."""


def plans(tasks: int = 2, episodes: int = EPISODES) -> tuple[CollectionSpec, ...]:
    return specs_for(
        CollectionSpec(EpisodeSpec(protocol="clean"), episodes=episodes, first_seed=3),
        TASKS[:tasks],
    )


def header(spec: CollectionSpec, task: object, pack: object) -> TaskHeader:
    """In the place of `header_of`."""
    versions, assets = {"rtphys": "0.1.0"}, {"digest": "a" * 64}
    return TaskHeader(spec, Resolved({}, None, versions, assets))


def variants(specs: Sequence[CollectionSpec]) -> dict[str, Sequence[CollectionSpec]]:
    """What may keep files of attempts that nobody needs."""
    return {
        "plain": specs,
        "failures": tuple(replace(spec, keep_failures="2") for spec in specs),
        "twin": tuple(replace(spec, twin="phys_random") for spec in specs),
        "sweep": tuple(one for spec in specs for one in swept(spec, "friction=0.1,0.2,1")),
        "sweep with failures": tuple(
            one
            for spec in specs
            for one in swept(replace(spec, keep_failures="all"), "friction=0.1,0.2,1")
        ),
    }


@dataclass
class QuickCollector:
    """In the place of `CollectWorker`."""

    pack: object
    shader: str

    def __call__(self) -> Callable[[CollectionTask], Results]:
        return self.do

    def do(self, job: CollectionTask) -> Results:
        MADE.append(job.recipes[0].seed)
        solved = [_chance(recipe)[1] for recipe in job.recipes]
        return tuple(
            _staged(recipe, folder, {})
            if (all(solved) if job.paired else own)
            else _rejected(recipe, folder, draw and not own)
            for recipe, folder, draw, own in zip(
                job.recipes, job.folders, job.keep, solved, strict=True
            )
        )


class SlowCollector(QuickCollector):
    """As on a network disk, where the files of a rare task take longest."""

    def __call__(self) -> Callable[[CollectionTask], Results]:
        self.delay, really = 0.0, os.fsync

        def fsync(file: int) -> None:
            time.sleep(self.delay)
            really(file)

        os.fsync = fsync
        return self.do

    def do(self, job: CollectionTask) -> Results:
        self.delay = 0.3 if job.recipes[0].task == RARE else 0.02
        return super().do(job)


def _chance(recipe: Recipe) -> tuple[Generator, bool]:
    """Whether a recipe succeeds, and what else of it is random."""
    chance = stream(recipe.seed, recipe.task, *map(str, recipe.spec.overrides.values()))
    return chance, chance.random() <= (0.2 if recipe.task == HARD else 0.7)


def _rejected(recipe: Recipe, folder: Path, draw: bool) -> Rejection:
    seed, chance = recipe.seed, _chance(recipe)[0]
    failure = {"failure": {"event": "grip_slip", "time": 1.5}}
    kept = _staged(recipe, folder, failure) if draw else None
    return Rejection(seed, "grip_slip", "need 14 N", {"friction": chance.random()}, kept)


def _staged(recipe: Recipe, folder: Path, more: Mapping[str, JSON]) -> StagedEpisode:
    seed, chance = recipe.seed, _chance(recipe)[0]
    shutil.rmtree(folder, ignore_errors=True)  # of a worker that was killed
    folder.mkdir(parents=True)
    names = (HDF5, VIDEO, INSTRUCTION)
    facts = {name: files.write_synced(folder / name, chance.bytes(99)) for name in names}
    attributes = {"friction": {"value": chance.random(), "could_act": True}}
    meta = {"seed": seed, "verdict": {}, "attributes": attributes, **more}
    return StagedEpisode(seed, folder, 7, facts, meta, {"info": {"{b}": 1, "{a}": "left"}})


def collect(plans: tuple[CollectionSpec, ...], out: Path, shard: str = "") -> Path:
    """Collects; returns the folder. Needs the fixture `without_robot`."""
    collect_plans(plans, Run(out, workers=3, shard=shard))
    return out


def shards(whole: tuple[CollectionSpec, ...], of: int, folder: Path) -> list[Path]:
    """Folders of all shards of a collection."""
    names = [f"{index}/{of}" for index in range(1, of + 1)]
    return [collect(whole, folder / name.replace("/", "-"), name) for name in names]
