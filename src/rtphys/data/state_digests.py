"""Whether a dataset is one that was made elsewhere: digests of all but its pictures.

A state digest covers an episode's seed, states, actions and label. It is the same on every machine,
with any number of workers, whatever draws the pictures. `manifests/NAME.digests.json` lists those
of a published collection.
"""

import hashlib
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import Field as Key

from rtphys.assets.embodiment import DEFAULT
from rtphys.core import library
from rtphys.core.errors import UnknownName, counted
from rtphys.data import schema
from rtphys.data.attempts import Rejected
from rtphys.data.check_episode import Problem
from rtphys.data.dataset import Dataset, Episode
from rtphys.data.json_text import Count, Model, compact

DIGITS = 16  # hexadecimal, that a list holds of an episode's digest
END = ".digests.json"
MACHINE = {"versions"}  # what a label says of the machine


Seed = Annotated[str, Key(pattern=r"^[0-9]{1,20}$")]
Digest = Annotated[str, Key(pattern=rf"^[0-9a-f]{{{DIGITS}}}$")]


class TaskDigests(Model):
    """A task dataset of a published collection, and what it cost."""

    config: str = Key(description="name of the folder, such as phys_random_all")
    embodiment: str = Key(DEFAULT, description="the robot")
    attempts: Count
    rejections: dict[str, Count] = Key(description="reason -> attempts")
    frames: Count
    sentences: Count = Key(description="different ones among those for training")
    bytes: Count
    cpu_seconds: float
    episodes: dict[Seed, Digest] = Key(description="seed -> state digest, in order")


class Digests(Model):
    """`manifests/NAME.digests.json`: a published collection."""

    what: str
    command: str = Key(description="what makes it again")
    dataset_version: str
    driver: str = Key(description="what drew the pictures")
    tasks: dict[str, TaskDigests]


def state_digest(episode: Episode, number: int | None = None) -> str:
    """Hexadecimal SHA-256 of an episode's seed, states, actions and label. Raises `BadFile`.

    `number`: that which the label would have elsewhere; default: its own.
    """
    episode = replace(episode)  # a copy, which takes what was read of it with it
    label = episode.meta.model_dump(mode="json", exclude=MACHINE)
    if number is not None:
        label["episode"] = number
    digest = hashlib.sha256(compact(label))
    for name, (array, _) in sorted(episode.frames.shapes().items()):
        data = np.ascontiguousarray(array)
        digest.update(f"\n{name} {data.dtype.str} {data.shape}\n".encode())
        digest.update(data.tobytes())
    return digest.hexdigest()


def find_digests(text: str) -> Digests:
    """Of a file, or of the collection of this name. Raises `UnknownName`, `BadFile`."""
    if (path := Path(text)).is_file():
        return schema.read(Digests, path)
    folders = [root / "manifests" for root in library.roots()]
    known = {
        path.name.removesuffix(END): path for folder in folders for path in folder.glob(f"*{END}")
    }
    if text not in known:
        raise UnknownName("published collection", text, known)
    return schema.read(Digests, known[text])


@dataclass
class Comparison:
    """What differs from a published collection, and how much was compared."""

    name: str
    problems: list[Problem] = field(default_factory=list)
    episodes: int = 0
    tasks: int = 0

    def __str__(self) -> str:
        equal = self.episodes - len(self.problems)
        many = f"{equal} of {counted(self.episodes, 'episodes')} of {counted(self.tasks, 'tasks')}"
        return f"{many} have the states, actions and labels of {self.name}"


def compare(dataset: Dataset, expected: Digests, name: str) -> Comparison:
    """Compares the seeds of each task that both have tried, such as a part's or a shard's.

    Raises `BadFile`.
    """
    found = Comparison(name)
    for task, listed in expected.tasks.items():
        robot = listed.embodiment
        both = robot in dataset.embodiments and listed.config in dataset.configs
        if both and task in dataset.tasks:
            part = dataset.where(task=task, config=listed.config, embodiment=robot)
            compared = [*_outcomes(part, listed, name)]
            found.problems += filter(None, compared)
            found.episodes += len(compared)
            found.tasks += bool(compared)
    return found


def _outcomes(part: Dataset, listed: TaskDigests, name: str) -> Iterator[Problem | None]:
    """What is wrong with each seed that gave an episode here or there, if both have tried it."""
    there = {int(seed): (n, one) for n, (seed, one) in enumerate(listed.episodes.items())}
    last = max(there, default=-1)
    for episode in part:
        path = episode.paths.phys_meta
        if episode.seed > last:
            continue  # was not tried there
        if episode.seed not in there:
            yield Problem(path, f"is of seed {episode.seed}, of which {name} has no episode")
            continue
        number, digest = there[episode.seed]
        if state_digest(episode, number)[:DIGITS] != digest:
            yield Problem(path, f"its states or its label are not those of {name}")
        else:
            yield None
    for entry in part.task_datasets:
        for row in entry.rows(part.path):
            if isinstance(row, Rejected) and row.seed in there:
                text = f"seed {row.seed} was rejected, of which {name} has an episode"
                yield Problem(entry.below(part.path).ledger, text)
