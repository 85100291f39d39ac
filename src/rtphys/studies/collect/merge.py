"""Merging shards into the dataset that one machine would have made."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from rtphys.campaign.engine import Listener
from rtphys.campaign.series import FRUITLESS, Tally
from rtphys.core.errors import BadFile
from rtphys.data.conditions import Conditions, differences
from rtphys.data.episode import JSON
from rtphys.data.faults import DatasetError
from rtphys.data.journal import read_journal
from rtphys.data.layout import SHARD, TaskDataset
from rtphys.data.manifest import journals_below, task_dataset_of
from rtphys.data.restage import restage
from rtphys.data.writer import DatasetWriter
from rtphys.studies.collect.run import collect
from rtphys.studies.collect.shard import Shard, Unit, read_shard
from rtphys.studies.collect.work import Results

Entry = Mapping[str, JSON]


class CannotMerge(DatasetError):
    """The folders are not the shards of one collection."""


@dataclass(frozen=True)
class ShardJournal:
    """One shard's journal of one task dataset."""

    shard: Shard
    task_dataset: TaskDataset
    conditions: Conditions
    header: Entry
    entries: tuple[Entry, ...]  # attempts

    def entry(self, seed: int) -> Entry | None:
        """The attempt of a seed that is this shard's; None: it never came to that."""
        number = self.conditions.attempt(seed)
        return self.entries[number] if number < len(self.entries) else None


Journals = Mapping[str, Sequence[ShardJournal]]
"""Folder of a task dataset -> journals of those that share it, by their first attempts."""


def merge(
    parts: Sequence[Path],
    out: Path,
    workers: int | None = None,
    listener: Listener | None = None,
) -> list[Tally]:
    """Writes what `collect` without shards would have written, byte for byte.

    Nothing is written before all shards are seen to be whole and to fit. Where they share a task
    dataset, the seeds that none of them came to are tried here; all others need no simulator.

    Args:
        workers: for those seeds; None: one a core.

    Returns:
        One tally a task, twins left out; its new attempts are those that were made here.

    Raises:
        CannotMerge: a shard is missing, given twice, unfinished, or of another collection.
        BadFile: one is damaged.
        DatasetMismatch: `out` holds something else, or what is missing would be made under other
            conditions here.
    """
    listener = listener or Listener()
    shards = read_shards(parts)
    journals = read_journals(shards)
    units = next(iter(shards.values())).units
    tallies = [Tally(str(unit.plan["task"]), unit.episodes) for unit in units]
    listener.started(tallies)
    with DatasetWriter(out) as dataset:
        for number, unit in enumerate(units):
            tallies[number] = _copy_unit(unit, journals, dataset)
            listener.ticked()
    for number, unit in enumerate(units):
        if not (tallies[number].done or tallies[number].stopped):
            known = _results_elsewhere(unit, journals)
            run = unit.run(out, workers)
            tallies[number] = collect([unit.task_plan()], run, listener, known).tallies[0]
    return tallies


def _copy_unit(unit: Unit, journals: Journals, dataset: DatasetWriter) -> Tally:
    """Copies each task dataset up to the first seed that no shard came to."""
    tally = Tally(str(unit.plan["task"]), unit.episodes)
    for folder in unit.folders:
        pieces = journals[folder]
        writer = dataset.task(pieces[0].conditions.unsharded(), unit.episodes)
        while not writer.done and writer.fruitless < FRUITLESS:
            seed = writer.next_seed
            piece = pieces[(seed - writer.conditions.first_seed) % len(pieces)]
            entry = piece.entry(seed)
            if entry is None:
                break
            writer.record(restage(piece.task_dataset, entry, writer.staging(seed)))
            dataset.checkpoint_if_due()
        writer.discard()
        tally = Tally(str(unit.plan["task"]), unit.episodes, writer.episodes, writer.attempts)
        tally.fruitless = writer.fruitless
    tally.judge(exhausted=False)
    return tally


def _results_elsewhere(unit: Unit, journals: Journals):
    """What the shards know, for `collect`, which goes on where the first of them has stopped."""

    def known(_: str, seed: int, folders: Sequence[Path]) -> Results | None:
        results = []
        for name, folder in zip(unit.folders, folders, strict=True):
            pieces = journals[name]
            piece = pieces[(seed - pieces[0].conditions.first_seed) % len(pieces)]
            entry = piece.entry(seed)
            if entry is None:
                return None
            results.append(restage(piece.task_dataset, entry, folder))
        return tuple(results)

    return known


# ---- reading the shards, and refusing those that do not fit --------------------------------------


def read_shards(parts: Sequence[Path]) -> dict[Path, Shard]:
    """Folder -> the shard that it holds.

    Raises:
        CannotMerge: they are not all of one collection, each once.
    """
    found: dict[Path, Shard] = {}
    for part in parts:
        shard = read_shard(part)
        if shard is None:
            raise CannotMerge(f"{part}: it is no shard, for it has no {SHARD}")
        found[part] = shard
    places: dict[int, Path] = {}
    first, whole = next(iter(found.items()))
    for part, shard in found.items():
        if shard.of != whole.of:
            raise CannotMerge(f"{first} is {whole}, and {part} is {shard}: of another division")
        if shard.index in places:
            raise CannotMerge(f"{places[shard.index]} and {part} both are {shard}")
        if clause := _other_units(whole, shard):
            raise CannotMerge(f"{first} and {part} are shards of two collections: {clause}")
        places[shard.index] = part
    missing = [str(replace(whole, index=i)) for i in range(1, whole.of + 1) if i not in places]
    if missing:
        raise CannotMerge(f"missing: {', '.join(missing)}")
    return found


def _other_units(first: Shard, other: Shard) -> str:
    if first.units == other.units:
        return ""
    ours, theirs = ({unit.folder: unit for unit in shard.units} for shard in (first, other))
    for folder in sorted(ours.keys() | theirs.keys()):
        a, b = ours.get(folder), theirs.get(folder)
        if a is None or b is None:
            return f"only one of them collects {folder}"
        if a.episodes != b.episodes:
            return f"{a.episodes} episodes of {folder} in the one, {b.episodes} in the other"
        if clauses := differences(a.plan, b.plan):
            return f"{folder}: {'; '.join(clauses)}"
    return "their twins differ"


def read_journals(shards: Mapping[Path, Shard]) -> Journals:
    """All journals of the shards.

    Raises:
        CannotMerge: a shard is unfinished, or was collected differently.
        BadFile: a journal is damaged.
    """
    found: dict[str, list[ShardJournal]] = {}
    for part, shard in sorted(shards.items(), key=lambda item: item[1].index):
        journals = {path.parent.relative_to(part).as_posix(): path for path in journals_below(part)}
        for unit in shard.own:
            for name in unit.folders:
                if name not in journals:
                    raise CannotMerge(f"{part}: {shard} has not begun {name}; run it first")
                piece = _read_journal(part, shard, journals[name])
                _check_finished(piece, unit)
                _check_alike(found.setdefault(name, []), piece)
                found[name].append(piece)
    return found


def _read_journal(part: Path, shard: Shard, journal: Path) -> ShardJournal:
    header, *lines = read_journal(journal).lines
    conditions = Conditions.from_json(header.entry)
    if (conditions.stride or (0, 1)) != shard.stride:
        raise BadFile(journal, f"is not of {shard}, as {SHARD} says")
    entries = tuple(line.entry for line in lines)
    return ShardJournal(
        shard, task_dataset_of(part, header.entry), conditions, header.entry, entries
    )


def _check_finished(piece: ShardJournal, unit: Unit) -> None:
    verdicts = [entry["verdict"] for entry in piece.entries]
    accepted, share = verdicts.count("accepted"), piece.shard.share(unit.episodes)
    hopeless = len(verdicts) >= FRUITLESS and "accepted" not in verdicts[-FRUITLESS:]
    next_seed = piece.conditions.seed(len(piece.entries))
    most = unit.plan.get("most_attempts")
    exhausted = isinstance(most, int) and next_seed >= piece.conditions.first_seed + most
    if accepted < share and not hopeless and not exhausted:
        counts = f"{accepted} of its {share} episodes of {unit.folder}"
        raise CannotMerge(
            f"{piece.task_dataset.out}: {piece.shard} has {counts}; repeat its command to finish it"
        )


def _check_alike(others: Sequence[ShardJournal], piece: ShardJournal) -> None:
    if not others:
        return
    headers = [{**journal.header, "stride": None} for journal in (others[0], piece)]
    if clauses := differences(*headers):
        places = f"{others[0].task_dataset.folder} and {piece.task_dataset.folder}"
        raise CannotMerge(f"{places} were collected differently: {'; '.join(clauses)}")
