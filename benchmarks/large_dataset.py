"""What a large dataset costs its writer and its readers, by number of episodes.

The episodes are made up: real lines in the ledger, and placeholders for files, which are names of
a few small ones. So all is measured but what the content of an episode costs.

    python benchmarks/large_dataset.py 1000 10000 100000 --out build/large
"""

import argparse
import itertools
import multiprocessing
import os
import resource
import shutil
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

from rtphys.data import verify as verifying
from rtphys.data.attempts import ATTEMPT, Accepted, Rejected
from rtphys.data.dataset import Dataset
from rtphys.data.files import FileFacts
from rtphys.data.json_text import compact
from rtphys.data.layout import TaskDataset
from rtphys.data.ledger import START, chained
from rtphys.data.writer import DatasetWriter, Rejection
from rtphys.physics import attributes
from rtphys.spec.collection import CollectionSpec, Resolved, TaskHeader
from rtphys.spec.episode import EpisodeSpec
from rtphys.spec.stored import adapter, stored

EPISODE = EpisodeSpec("click_bell", "phys_random")
LINKS = 60_000  # names that one file may have on ext4
EVERY = 4  # one attempt in so many is rejected
TRIALS = 20


class Took(NamedTuple):
    """Seconds; on a machine that others use too, those of the processor say more."""

    cpu: float
    wall: float

    @staticmethod
    def since(began: "Took | None" = None) -> "Took":
        """The time since then, or a beginning."""
        cpu, wall = began or (0.0, 0.0)
        return Took(time.process_time() - cpu, time.perf_counter() - wall)


def header(episodes: int) -> TaskHeader:
    """Of a collection of so many."""
    spec = CollectionSpec(EPISODE, episodes=episodes)
    return TaskHeader(spec, Resolved(EPISODE.domain.to_json(), None, {"rtphys": "0"}, {}))


def rows(place: TaskDataset, episodes: int) -> Iterator[Accepted | Rejected]:
    """Attempts with one rejection in `EVERY`, of sizes as in real ledgers."""
    facts, number = FileFacts.of(b"placeholder"), 0
    for seed in itertools.count():
        physics = {key: (seed * 0.618 + n) % 1 for n, key in enumerate(attributes())}
        if seed % EVERY == EVERY - 1:
            yield Rejected(seed=seed, reason="slipped", detail="bell: 0.1", physics=physics)
            continue
        if number == episodes:
            return
        names = [path.relative_to(place.folder).as_posix() for path in place.episode(number).all()]
        yield Accepted(
            seed=seed,
            episode=number,
            frames=100,
            scene_info={"info": {"{A}": "050_bell/base0", "{a}": "left"}, "texture_info": {}},
            physics=physics,
            files=dict.fromkeys(names, facts),
        )
        number += 1


def make(out: Path, episodes: int) -> None:
    """Writes a ledger and the names of the files it lists; the writer makes the rest of it."""
    place = TaskDataset.of(out, header(episodes).spec)
    for path in place.episode(0).all():
        path.parent.mkdir(parents=True)
    check, dump = START, adapter(ATTEMPT).dump_python
    with place.ledger.open("wb", buffering=2**20) as file:
        lines = (dump(row, mode="json") for row in rows(place, episodes))
        for text in map(compact, itertools.chain([stored(header(episodes))], lines)):
            check = chained(check, text)
            file.write(check.encode() + b" " + text + b"\n")
    for number in range(episodes):
        for path in place.episode(number).all():
            source = path.with_name(f"episode_{number // LINKS * LINKS:07d}{path.suffix}")
            if source == path:
                path.write_bytes(b"placeholder")
            else:
                os.link(source, path)
    with DatasetWriter(out) as dataset:
        dataset.task(header(episodes))


def checkpoints(out: Path, episodes: int) -> dict[str, Took]:
    """Of a run that goes on: the usual one, and the slowest."""
    with DatasetWriter(out) as dataset:
        began = Took.since()
        task = dataset.task(header(episodes + 1))
        took = {"continuing": Took.since(began)}
        times: list[Took] = []
        for _ in range(TRIALS):
            task.record(Rejection(task.next_seed, "slipped"))
            began = Took.since()
            dataset.checkpoint()
            times.append(Took.since(began))
    usual = sorted(times)[len(times) // 2]
    return {**took, "checkpoint": usual, "slowest checkpoint": max(times)}


def opening(out: Path, episodes: int) -> dict[str, Took]:
    """Of a reader: the dataset, and its last episode."""
    began = Took.since()
    dataset = Dataset(out)
    opened, began = Took.since(began), Took.since()
    assert dataset[len(dataset) - 1].number == episodes - 1
    return {"Dataset()": opened, "its episodes": Took.since(began)}


def verifying_all(out: Path, episodes: int) -> dict[str, Took]:
    """All of `verify --quick` but what is inside the files."""
    verifying.check_episode = lambda *_: (None, [])
    began = Took.since()
    report = verifying.verify(out, verifying.Effort.QUICK)
    assert report.sound and report.episodes == episodes, report.problems[:3]
    return {"verify --quick": Took.since(began)}


Measure = Callable[[Path, int], dict[str, Took]]
MEASURES: tuple[Measure, ...] = (checkpoints, opening, verifying_all)


def measured(measure: Measure, out: Path, episodes: int) -> None:
    """Prints a measure and the memory that its process took."""
    for name, took in measure(out, episodes).items():
        print(f"  {name:20} {took.cpu * 1e3:10.1f} ms of CPU {took.wall * 1e3:10.1f} ms")
    megabytes = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(f"  {measure.__name__ + ', memory':20} {megabytes:10.0f} MB", flush=True)


def main() -> None:
    """Makes a dataset of each size, measures, and removes it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("episodes", type=int, nargs="+")
    parser.add_argument("--out", type=Path, default=Path("build/large"))
    given = parser.parse_args()
    processes = multiprocessing.get_context("spawn")
    for episodes in given.episodes:
        shutil.rmtree(given.out, ignore_errors=True)
        began = time.perf_counter()
        make(given.out, episodes)
        print(f"{episodes} episodes, made in {time.perf_counter() - began:.0f} s", flush=True)
        for measure in MEASURES:
            one = processes.Process(target=measured, args=(measure, given.out, episodes))
            one.start()
            one.join()
            if one.exitcode:
                sys.exit(1)
        shutil.rmtree(given.out)


if __name__ == "__main__":
    main()
