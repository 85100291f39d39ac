"""One part of a collection that several machines make without talking to each other.

Whole leaves are dealt out when there are at least as many as shards. Otherwise the shards form as
many equal groups as possible, and the m of a group share each of their leaves seed by seed: every
m-th seed each, until each has 1/m of the episodes. They then have tried different numbers of seeds;
what is missing below the last seed needed is collected when they are merged. What a shard has to do
depends on the command and on i and n alone.
"""

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

from rtphys.core.errors import BadFile, BadValue
from rtphys.data import files, schema
from rtphys.data.episode import JSON
from rtphys.data.faults import DatasetMismatch
from rtphys.data.json_text import parse_mapping, plain, pretty
from rtphys.data.layout import SHARD
from rtphys.data.manifest import journals_below


@dataclass(frozen=True)
class Unit:
    """A leaf, with its twin if it has one, as the whole collection wants it."""

    leaf: str  # its folder below `out`
    twin: str | None
    episodes: int
    plan: Mapping[str, JSON]  # what else `collect` was told about it

    @property
    def leaves(self) -> tuple[str, ...]:
        return (self.leaf,) if self.twin is None else (self.leaf, self.twin)


@dataclass(frozen=True)
class Shard:
    """Part `index` (from 1) of `of`, of a collection of `units`, sorted by leaf."""

    index: int
    of: int
    units: tuple[Unit, ...]

    def __str__(self) -> str:
        return f"shard {self.index}/{self.of}"

    @property
    def groups(self) -> int:
        """Of shards; each has its own units."""
        count = len(self.units)
        return self.of if count >= self.of else math.gcd(count, self.of)

    @property
    def stride(self) -> tuple[int, int]:
        """First attempt and step of this shard, in each of its leaves."""
        sharing = self.of // self.groups
        return (self.index - 1) % sharing, sharing

    @property
    def own(self) -> tuple[Unit, ...]:
        """What this shard works on, alone or with others of its group."""
        _, sharing = self.stride
        return self.units[(self.index - 1) // sharing :: self.groups]

    def to_json(self) -> JSON:
        return plain(asdict(self))

    @staticmethod
    def from_json(data: Mapping[str, JSON], where: Path) -> "Shard":
        """Raises `BadFile`."""
        try:
            known = schema.check("shard", data)
        except schema.SchemaError as error:
            raise BadFile(where, "; ".join(error.problems)) from error
        assert isinstance(known, schema.ShardFile)
        units = (Unit(u.leaf, u.twin, u.episodes, dict(u.plan)) for u in known.units)
        return Shard(known.index, known.of, tuple(units))


def parse_shard(text: str) -> tuple[int, int]:
    """`"2/8"` -> (2, 8).

    Raises:
        BadValue: it is not i/n with 1 <= i <= n.
    """
    index, _, of = text.partition("/")
    if not (index.isdecimal() and of.isdecimal() and 1 <= int(index) <= int(of)):
        raise BadValue("--shard", text, "write i/n, from 1/n to n/n")
    return int(index), int(of)


def read_shard(out: Path) -> Shard | None:
    """Which shard a folder holds; None: it is no shard. Raises `BadFile`."""
    path = out / SHARD
    if not path.exists():
        return None
    return Shard.from_json(parse_mapping(files.read(path), path), path)


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
        if [unit.leaves for unit in stored.units] != [unit.leaves for unit in shard.units]:
            raise DatasetMismatch(out, ["it was a shard of other tasks or configurations"])
    if shard is not None and stored != shard:
        files.replace_file(out / SHARD, pretty(shard.to_json()))
