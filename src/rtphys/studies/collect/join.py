"""Joining shards into the dataset that one machine would have made."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from rtphys.data.restage import restage
from rtphys.data.task_writer import TaskWriter
from rtphys.data.writer import DatasetWriter
from rtphys.studies.collect.deal import plan_of
from rtphys.studies.collect.pieces import Piece, pieces_of, shards_in
from rtphys.studies.collect.plan import BARREN, CollectPlan
from rtphys.studies.collect.run import Listener, collect
from rtphys.studies.collect.shard import Unit
from rtphys.studies.collect.tally import Tally
from rtphys.studies.collect.work import Results

Pieces = Mapping[str, Sequence[Piece]]


def merge(
    parts: Sequence[Path],
    out: Path,
    workers: int | None = None,
    listener: Listener | None = None,
) -> list[Tally]:
    """Writes what `collect` without shards would have written, byte for byte.

    Nothing is written before all shards are seen to be whole and to fit. Where they share a leaf,
    the seeds that none of them came to are tried here; all others need no simulator.

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
    told = listener or Listener()
    shards = shards_in(parts)
    pieces = pieces_of(shards)
    units = next(iter(shards.values())).units
    tallies = [Tally(str(unit.plan["task"]), unit.episodes) for unit in units]
    told.started(tallies)
    with DatasetWriter(out) as dataset:
        for unit, tally in zip(units, tallies, strict=True):
            _join(unit, pieces, dataset, tally)
            told.ticked()
    return [
        tally
        if tally.done or tally.stopped
        else _fill(pieces, unit, plan_of(unit, out, workers), told)
        for unit, tally in zip(units, tallies, strict=True)
    ]


def _join(unit: Unit, pieces: Pieces, dataset: DatasetWriter, tally: Tally) -> None:
    """Each leaf up to the first seed that no shard came to."""
    for name in unit.leaves:
        conditions = replace(pieces[name][0].conditions, stride=None)
        task = dataset.task(conditions, unit.episodes)
        tally.barren = _copy(pieces[name], task, dataset)
        tally.episodes = tally.found_episodes = task.episodes
        tally.attempts = tally.found_attempts = task.attempts
    if not tally.done and tally.barren >= BARREN:
        tally.stopped = f"none of the last {tally.barren} attempts was accepted"


def _copy(pieces: Sequence[Piece], task: TaskWriter, dataset: DatasetWriter) -> int:
    """Returns how many attempts in a row gave nothing at its end."""
    barren = number = 0
    while not task.done and barren < BARREN:
        seed = task.conditions.seed(number)
        piece = pieces[number % len(pieces)]
        entry = piece.entry(seed)
        if entry is None:
            break
        if seed >= task.next_seed:  # else an earlier call has done it
            task.record(restage(piece.leaf, entry, task.staging(seed)))
            dataset.checkpoint_if_due()
        barren = 0 if entry["verdict"] == "accepted" else barren + 1
        number += 1
    return barren


def _fill(pieces: Pieces, unit: Unit, plan: CollectPlan, told: Listener) -> Tally:
    """Goes on where the first shard has stopped, with what the others know."""

    def known(_: str, seed: int, folders: Sequence[Path]) -> Results | None:
        found = []
        for name, folder in zip(unit.leaves, folders, strict=True):
            number = seed - plan.first_seed
            piece = pieces[name][number % len(pieces[name])]
            entry = piece.entry(seed)
            if entry is None:
                return None
            found.append(restage(piece.leaf, entry, folder))
        return tuple(found)

    return collect(plan, told, known).tallies[0]
