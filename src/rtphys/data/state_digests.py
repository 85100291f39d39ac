"""Whether a dataset is one that was made elsewhere: digests of all but its pictures.

A state digest covers an episode's seed, states, actions and label. It is the same on every machine,
with any number of workers, whatever draws the pictures. `manifests/NAME.digests.json` lists those
of a published collection.
"""

import hashlib
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import Field as Key

from rtphys.core import library
from rtphys.core.errors import UnknownName, counted
from rtphys.data import schema
from rtphys.data.check_episode import Problem
from rtphys.data.dataset import Dataset, Episode
from rtphys.data.json_text import Count, Model, compact

DIGITS = 16  # hexadecimal, that a list holds of an episode's digest
END = ".digests.json"
MACHINE = {"versions"}  # what a label says of the machine


Digest = Annotated[str, Key(pattern=rf"^[0-9a-f]{{{DIGITS}}}$")]


class TaskDigests(Model):
    """A task dataset of a published collection, and what it cost."""

    config: str = Key(description="name of the folder, such as phys_random_all")
    dataset: str = Key(description="digest of the whole dataset, pictures included")
    attempts: Count
    rejections: dict[str, Count] = Key(description="reason -> attempts")
    frames: Count
    sentences: Count = Key(description="different ones among those for training")
    bytes: Count
    cpu_seconds: float
    episodes: dict[str, Digest] = Key(description="seed -> state digest, in order")


class Digests(Model):
    """`manifests/NAME.digests.json`: a published collection."""

    what: str
    command: str = Key(description="what makes it again")
    dataset_version: str
    driver: str = Key(description="what drew the pictures of `dataset`")
    tasks: dict[str, TaskDigests]


def state_digest(episode: Episode) -> str:
    """Hexadecimal SHA-256 of an episode's seed, states, actions and label. Raises `BadFile`."""
    label = episode.meta.model_dump(mode="json", exclude=MACHINE)
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
    """Compares of each task as many episodes as there are here, from the first on.

    Raises `BadFile`.
    """
    found = Comparison(name)
    for task, listed in expected.tasks.items():
        if task in dataset.tasks and listed.config in dataset.configs:
            part = dataset.where(task=task, config=listed.config)
            found.problems += _differences(part, listed, name)
            found.episodes += min(len(part), len(listed.episodes))
            found.tasks += bool(len(part))
    return found


def _differences(part: Dataset, listed: TaskDigests, name: str) -> Iterator[Problem]:
    for episode, (seed, digest) in zip(part, listed.episodes.items(), strict=False):
        path = episode.paths.phys_meta
        if str(episode.seed) != seed:
            yield Problem(path, f"is of seed {episode.seed}, that of {name} is of seed {seed}")
        elif state_digest(episode)[:DIGITS] != digest:
            yield Problem(path, f"its states or its label are not those of {name}")
