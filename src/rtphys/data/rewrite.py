"""Datasets made of datasets: converted to the other layout, merged, or a part of one.

Each reads committed attempts in the order of their seeds and commits them to a new folder, where
episodes get new numbers. Repeated after an interruption, the same call continues.
"""

import heapq
import shutil
from collections import Counter, deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from operator import itemgetter
from pathlib import Path

from rtphys.core.bounds import LARGEST_EPISODE
from rtphys.core.errors import BadFile, BadValue, UnknownName, counted
from rtphys.core.untrusted import JSON, parse_mapping
from rtphys.data import files, jpeg, staging
from rtphys.data.attempts import Accepted, KeptFailure, Row
from rtphys.data.dataset import Dataset, Part
from rtphys.data.faults import OTHER_SEEDS, DatasetMismatch, PartsMismatch
from rtphys.data.files import FileFacts
from rtphys.data.hdf5_episode import read_episode
from rtphys.data.layout import FAILURES, EpisodePaths, TaskDataset
from rtphys.data.schema import FailureMeta, Instructions, PhysMeta, SceneEntry
from rtphys.data.staging import EncodedEpisode, StagedEpisode, stage_encoded
from rtphys.data.writer import DatasetWriter, Rejection
from rtphys.spec.collection import TaskHeader
from rtphys.spec.recording import LAYOUTS
from rtphys.spec.stored import differences, problems_of, stored

Progress = Callable[[int, int], None]  # episodes done, episodes in all
OnDisk = Accepted | KeptFailure
Stage = Callable[[TaskDataset, OnDisk, int, Path], StagedEpisode]
"""(where it lies, what is on disk of an attempt, its seed, a folder) -> the same, staged there."""


@dataclass(frozen=True)
class _Target:
    """A task dataset to be written, and what it is made of."""

    header: TaskHeader
    sources: Sequence[Part]
    stage: Stage

    def episodes(self) -> int:
        """How many are taken."""
        if not any(part.tests for part in self.sources):
            return sum(part.entry.episodes for part in self.sources)
        return sum(isinstance(row, Accepted) for _, row in self.rows())

    def rows(self) -> Iterator[tuple[TaskDataset, Row]]:
        """Every attempt that is taken, in the order of the seeds, and where it lies."""
        places = [part.place for part in self.sources]
        last: tuple[int, int] | None = None  # seed, and number of its source
        streams = (_rows_of(number, part) for number, part in enumerate(self.sources))
        for seed, number, row in heapq.merge(*streams, key=itemgetter(0, 1)):
            if last is not None and last[0] == seed:
                both = f"{places[last[1]].folder} and {places[number].folder}"
                raise PartsMismatch(places[number].folder, [f"seed {seed} is in {both}"])
            last = seed, number
            yield places[number], row


def _rows_of(number: int, part: Part) -> Iterator[tuple[int, int, Row]]:
    """Seed, `number` and attempt, of those that are taken; the seeds of all are checked."""
    part.place.check_links()
    spec, last = part.entry.spec, -1
    for attempt, row in enumerate(part.entry.rows(part.path)):
        collected = spec.made_by == "collect"
        if row.seed != spec.seed(attempt) if collected else row.seed <= last:
            raise BadFile(part.place.ledger, f"attempt {attempt} cannot be of seed {row.seed}")
        last = row.seed
        if part.takes(row):
            yield row.seed, number, row


def convert(source: Path, out: Path, layout: str, progress: Progress | None = None) -> list[str]:
    """Writes every task dataset in another layout, attempts included.

    All but pictures comes back with the same bits. Where the layout changes, pictures are encoded
    again: native files hold marked standard RGB, legacy ones red and blue exchanged without a mark,
    and JPEG mixes the channels, so levels differ a little. A stream of the right kind is kept.

    Returns:
        Names of the task datasets written.

    Raises:
        UnknownName: no such layout.
        BadFile: the source is damaged; names the file.
        BadValue: `out` is the source itself; folders of two robots have one name in the layout.
        DatasetMismatch: `out` holds something else.
    """
    if layout not in LAYOUTS:
        raise UnknownName("layout", layout, LAYOUTS)
    targets: list[_Target] = []
    for part in Dataset(source).parts:
        recording = replace(part.entry.spec.recording, layout=layout)
        header = replace(part.entry.header, spec=replace(part.entry.spec, recording=recording))
        targets.append(_Target(header, [part], partial(_encoded_again, layout)))
    names = Counter(TaskDataset.of(out, target.header.spec).name for target in targets)
    if several := next((name for name, count in names.items() if count > 1), None):
        allowed = f"two robots would share {several}: convert a `rtphys subset` of each"
        raise BadValue("layout", layout, allowed)
    return _write(targets, [source], out, progress)


def merge(parts: Sequence[Path], out: Path, progress: Progress | None = None) -> list[str]:
    """Joins datasets of this version: shards of one collection, or any others.

    Task datasets that only one part has are taken over as they are. Those that several have must
    have been collected alike, with different seeds; shards that share one must all be there.

    Raises:
        BadFile: a part is damaged.
        PartsMismatch: parts do not fit; names the task dataset and each field that differs.
        BadValue: `out` is one of them.
        DatasetMismatch: `out` holds something else.
    """
    groups: dict[str, list[Part]] = {}
    for part in (part for folder in parts for part in Dataset(folder).parts):
        groups.setdefault(part.place.name, []).append(part)
    joined = [_Target(_joined(group), group, _copied) for group in groups.values()]
    for target in joined:
        if len(target.sources) > 1:  # a seed that two have is refused before anything is written
            deque(target.rows(), maxlen=0)
    return _write(joined, parts, out, progress)


def unfinished(parts: Sequence[Path]) -> list[str]:
    """A clause for each task dataset of these parts that seems to lack episodes.

    That is one whose run was killed or goes on, or a shard with fewer episodes than another of the
    same task. A dataset does not know how many it should have, so a run that ended in order, as by
    Ctrl-C, shows in no other way. Raises `BadFile`: there is no dataset.
    """
    found = [(one.place, one.entry) for folder in parts for one in Dataset(folder).parts]
    most = Counter[str]()  # episodes of a shard, by task dataset
    for place, entry in found:
        most[place.name] = max(most[place.name], entry.episodes if entry.spec.shard else 0)
    clauses: list[str] = []
    for place, entry in found:
        spec, there = entry.spec, entry.episodes
        size = place.ledger.stat().st_size if place.ledger.exists() else 0
        killed = size > entry.ledger.bytes or entry.listed < entry.attempts
        if killed or place.staging.exists():
            clauses.append(f"{place.folder}: its run was killed, or goes on")
        elif spec.shard and there < most[place.name]:
            of = f"{counted(there, 'episodes')}, another shard has {most[place.name]}"
            clauses.append(f"{place.folder}: shard {spec.shard} of {spec.shards} has {of}")
    return clauses


def _joined(group: Sequence[Part]) -> TaskHeader:
    """The header of a task dataset that several parts have. Raises `PartsMismatch`."""
    folder, first = group[0].place.folder, group[0].entry
    merged = [replace(part.entry.spec, shard=0, made_by="merge") for part in group]
    # What parts of one task dataset may differ in, made equal.
    alike = [
        stored(replace(part.entry.header, spec=replace(spec, first_seed=0)))
        for part, spec in zip(group, merged, strict=True)
    ]
    for part, header in zip(group, alike, strict=True):
        if clauses := differences(alike[0], header):
            raise PartsMismatch(part.place.folder, clauses)
    shards = [part.entry.spec.shard for part in group if part.entry.spec.shard]
    if len(set(shards)) < len(shards):
        raise PartsMismatch(folder, ["two of the parts are the same shard"])
    if shards and (missing := set(range(1, first.spec.shards + 1)) - set(shards)):
        clause = f"shard {min(missing)} of {first.spec.shards} is not among the parts"
        raise PartsMismatch(folder, [clause])
    if len(group) == 1:
        return first.header
    return replace(first.header, spec=min(merged, key=lambda spec: spec.first_seed))


def subset(chosen: Dataset, out: Path, progress: Progress | None = None) -> list[str]:
    """Copies a part of a dataset, as `Dataset.where` chooses it: whole task datasets as they are.

    Raises:
        BadFile: the source is damaged, or holds no such episode.
        BadValue: it is a sum of datasets, or in `out`.
        DatasetMismatch: `out` holds something else.
    """
    targets: list[_Target] = []
    for part in chosen.parts:
        header = part.entry.header
        if part.tests:
            header = replace(header, spec=replace(header.spec, made_by="subset"))
        targets.append(_Target(header, [part], _copied))
    if not any(not part.tests or any(row.on_disk for row in part.rows()) for part in chosen.parts):
        raise BadFile(chosen.path, "the dataset holds no such episode")
    return _write(targets, [chosen.path], out, progress)


def _write(
    targets: Sequence[_Target], read: Sequence[Path], out: Path, progress: Progress | None
) -> list[str]:
    if out.resolve() in [path.resolve() for path in read]:
        raise BadValue("out", str(out), "it is a dataset that is read; name another folder")
    episodes, done = [target.episodes() for target in targets], 0
    total = sum(episodes)
    names: list[str] = []
    with DatasetWriter(out) as dataset:
        for target, wanted in zip(targets, episodes, strict=True):
            writer = dataset.task(target.header, wanted)
            names.append(writer.task_dataset.name)
            there = writer.seeds()  # of an earlier call
            for place, row in target.rows():
                done += isinstance(row, Accepted)
                if (before := next(there, None)) is not None:
                    if before != row.seed:
                        raise DatasetMismatch(writer.task_dataset.folder, [OTHER_SEEDS])
                    continue
                held, folder = row.on_disk, writer.staging(row.seed)
                outcome = held and target.stage(place, held, row.seed, folder)
                if not isinstance(row, Accepted):
                    outcome = Rejection(row.seed, row.reason, row.detail, row.physics, outcome)
                assert outcome is not None
                writer.record(outcome)
                dataset.checkpoint_if_due()
                if progress:
                    progress(done, total)
            if next(there, None) is not None:
                raise DatasetMismatch(writer.task_dataset.folder, [OTHER_SEEDS])
    return names


def _copied(place: TaskDataset, held: OnDisk, seed: int, folder: Path) -> StagedEpisode:
    """The same bytes. Raises `BadFile`: a file is not what the ledger says."""
    paths = held.paths(place)
    by_folder = {Path(name).parent.name: facts for name, facts in held.files.items()}

    def sound(path: Path) -> bytes:
        data = files.read(path, LARGEST_EPISODE)
        if FileFacts.of(data) != by_folder.get(path.parent.name):
            raise BadFile(path, "is not what its ledger says")
        return data

    meta = parse_mapping(sound(paths.phys_meta), paths.phys_meta)
    # What the ledger will say of it must be there.
    attributes = meta.get("attributes")
    labels = attributes.values() if isinstance(attributes, Mapping) else [None]
    complete = [isinstance(one, Mapping) and {"value", "could_act"} <= one.keys() for one in labels]
    parts = [meta.get("verdict"), *([meta.get("failure")] if isinstance(held, KeptFailure) else [])]
    if not ("episode" in meta and all(isinstance(p, Mapping) for p in parts) and all(complete)):
        raise BadFile(paths.phys_meta, "episode, verdict, attributes or failure are missing")
    del meta["episode"]  # its number changes
    shutil.rmtree(folder, ignore_errors=True)
    files.make_folder(folder)
    written = {
        name: files.write_synced(folder / name, sound(path))
        for name, path in staging.targets(paths).items()
        if name != staging.PHYS_META
    }
    return StagedEpisode(seed, folder, held.frames, written, meta, held.scene_info)


def _encoded_again(
    layout: str, place: TaskDataset, held: OnDisk, seed: int, folder: Path
) -> StagedEpisode:
    paths = held.paths(place)
    episode = encoded_episode(paths, place.layout, held.scene_info)
    for name, streams in episode.images.jpegs.items():
        episode.images.jpegs[name] = [jpeg.for_layout(stream, layout) for stream in streams]
    if episode.phys_meta["seed"] != seed:
        raise BadFile(paths.phys_meta, f"seed is not {seed}, as the ledger says")
    return stage_encoded(folder, episode, layout)


def encoded_episode(paths: EpisodePaths, layout: str, scene: Mapping[str, JSON]) -> EncodedEpisode:
    """An episode as its files hold it. Raises `BadFile`."""
    frames, images, sensed = read_episode(paths.hdf5, layout)
    images.video = files.read(paths.video)
    failed = paths.phys_meta.parents[1].name == FAILURES
    content: list[dict[str, JSON]] = []
    for kind, path in (
        (FailureMeta if failed else PhysMeta, paths.phys_meta),
        (Instructions, paths.instruction),
    ):
        content.append(parse_mapping(files.read(path), path))
        with problems_of(path):
            kind.model_validate(content[-1])
    with problems_of(paths.hdf5):
        SceneEntry.model_validate(scene)
    meta, words = content
    return EncodedEpisode(frames, images, meta, scene, words, sensed)
