"""Reading shards that are to be merged, and refusing those that do not fit."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from rtphys.core.errors import BadFile
from rtphys.data.conditions import Conditions, differences
from rtphys.data.episode import JSON
from rtphys.data.faults import DatasetError
from rtphys.data.journal import read_journal
from rtphys.data.layout import SHARD, TaskDataset
from rtphys.data.manifest import journals_below, task_dataset_of
from rtphys.studies.collect.plan import BARREN
from rtphys.studies.collect.shard import Shard, Unit, read_shard

Entry = Mapping[str, JSON]


class CannotMerge(DatasetError):
    """The folders are not the shards of one collection."""


@dataclass(frozen=True)
class Piece:
    """One shard's journal of one leaf."""

    shard: Shard
    leaf: TaskDataset
    conditions: Conditions
    entries: tuple[Entry, ...]  # attempts

    def entry(self, seed: int) -> Entry | None:
        """Of a seed that is this shard's; None: it never came to that."""
        number = self.conditions.attempt(seed)
        return self.entries[number] if number < len(self.entries) else None


def shards_in(parts: Sequence[Path]) -> dict[Path, Shard]:
    """Which shard lies where.

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


def _other_units(one: Shard, other: Shard) -> str:
    if one.units == other.units:
        return ""
    ours, theirs = ({unit.leaf: unit for unit in shard.units} for shard in (one, other))
    for leaf in sorted(ours.keys() | theirs.keys()):
        a, b = ours.get(leaf), theirs.get(leaf)
        if a is None or b is None:
            return f"only one of them collects {leaf}"
        if a.episodes != b.episodes:
            return f"{a.episodes} episodes of {leaf} in the one, {b.episodes} in the other"
        if clauses := differences(a.plan, b.plan):
            return f"{leaf}: {'; '.join(clauses)}"
    return "their twins differ"


def pieces_of(shards: Mapping[Path, Shard]) -> dict[str, list[Piece]]:
    """By leaf, those that share it in the order of their first attempts.

    Raises:
        CannotMerge: a shard is unfinished, or was collected differently.
        BadFile: a journal is damaged.
    """
    found: dict[str, list[Piece]] = {}
    for part, shard in sorted(shards.items(), key=lambda item: item[1].index):
        journals = {path.parent.relative_to(part).as_posix(): path for path in journals_below(part)}
        for unit in shard.own:
            for name in unit.leaves:
                if name not in journals:
                    raise CannotMerge(f"{part}: {shard} has not begun {name}; run it first")
                piece = _piece(part, shard, journals[name])
                _check_finished(piece, unit)
                _check_alike(found.setdefault(name, []), piece)
                found[name].append(piece)
    return found


def _piece(part: Path, shard: Shard, journal: Path) -> Piece:
    header, *lines = read_journal(journal).lines
    conditions = Conditions.from_json(header.entry)
    if (conditions.stride or (0, 1)) != shard.stride:
        raise BadFile(journal, f"is not of {shard}, as {SHARD} says")
    entries = tuple(line.entry for line in lines)
    return Piece(shard, task_dataset_of(part, header.entry), conditions, entries)


def _check_finished(piece: Piece, unit: Unit) -> None:
    accepted = sum(entry["verdict"] == "accepted" for entry in piece.entries)
    share = math.ceil(unit.episodes / piece.shard.stride[1])
    tail = [entry["verdict"] for entry in piece.entries[-BARREN:]]
    hopeless = len(tail) == BARREN and "accepted" not in tail
    next_seed = piece.conditions.seed(len(piece.entries))
    most = unit.plan.get("most_attempts")
    exhausted = isinstance(most, int) and next_seed >= piece.conditions.first_seed + most
    if accepted < share and not hopeless and not exhausted:
        told = f"{accepted} of its {share} episodes of {unit.leaf}"
        where = piece.leaf.out
        raise CannotMerge(f"{where}: {piece.shard} has {told}; repeat its command to finish it")


def _check_alike(others: Sequence[Piece], piece: Piece) -> None:
    if not others:
        return
    first = others[0]
    alone = [replace(one.conditions, stride=None).to_json() for one in (first, piece)]
    if found := differences(*alone):
        places = f"{first.leaf.folder} and {piece.leaf.folder}"
        raise CannotMerge(f"{places} were collected differently: {'; '.join(found)}")
