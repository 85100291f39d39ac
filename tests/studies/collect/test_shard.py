"""What a shard remembers, and which shards are not merged."""

import shutil
from dataclasses import fields, replace
from pathlib import Path

import pytest
import sharding
from sharding import collect, plan, shards
from typer.testing import CliRunner

from rtphys.cli.main import app
from rtphys.core.errors import BadFile, BadValue
from rtphys.data.conditions import Conditions
from rtphys.data.faults import DatasetMismatch
from rtphys.physics.load import load_domain
from rtphys.studies.collect import CollectPlan, dealt, merge
from rtphys.studies.collect.deal import TOLD, plan_of
from rtphys.studies.collect.pieces import CannotMerge
from rtphys.studies.collect.shard import Shard, claim, read_shard

pytestmark = pytest.mark.usefixtures("merging_needs_no_robot")


# ---- what a shard remembers ----------------------------------------------------------------------

PLACE = {"tasks", "episodes", "out", "twin_of", "workers", "runner", "address", "shard", "resume"}
"""Fields of a plan that say where and how fast, or that a unit says in other words."""


def test_a_shard_remembers_all_that_decides_what_is_collected() -> None:
    assert set(TOLD) == {f.name for f in fields(CollectPlan)} - PLACE - {"limits"}


def test_a_plan_is_remembered_as_it_was(tmp_path: Path) -> None:
    told = replace(
        plan(1),
        out=tmp_path,
        only=("friction",),
        overrides={"center_of_mass": (0.0, 0.0, 0.01), "friction": 0.2},
        ranges=load_domain("global"),
        twin="phys_random",
        assets=Path("/some/pack"),
        fallback="builtin",
        most_attempts=7,
        recovery=False,
    )
    claim(tmp_path, dealt([told], "1/1")[0].shard)
    stored = read_shard(tmp_path)
    assert stored is not None
    again = plan_of(stored.units[0], tmp_path, workers=1)
    for one in fields(CollectPlan):
        assert getattr(again, one.name) == getattr(told, one.name), one.name


# ---- what is refused -----------------------------------------------------------------------------


@pytest.mark.parametrize("text", ["0/2", "3/2", "2", "a/b", "-1/2", "1/0"])
def test_a_shard_is_one_of_n(text: str) -> None:
    with pytest.raises(BadValue, match="from 1/n to n/n"):
        dealt([plan()], text)


def test_shards_that_do_not_belong_together(tmp_path: Path) -> None:
    one, two, three = shards(plan(2), 3, tmp_path / "a")
    other = collect(dealt([plan(2, 13)], "3/3"), tmp_path / "b")
    half = collect(dealt([plan(2)], "1/2"), tmp_path / "c")
    none = collect((plan(2),), tmp_path / "d")
    again = Path(shutil.copytree(two, tmp_path / "again"))
    wrong = {
        "missing: shard 2/3": [one, three],
        "both are shard 2/3": [one, two, again, three],
        "12 episodes of .*, 13 in the other": [one, two, other],
        "of another division": [one, two, half],
        "it is no shard": [one, two, none],
    }
    for told, parts in wrong.items():
        with pytest.raises(CannotMerge, match=told):
            merge(parts, tmp_path / "joined")
    assert not (tmp_path / "joined").exists()


def test_shards_made_by_different_versions(tmp_path: Path, monkeypatch) -> None:
    one = collect(dealt([plan(1)], "1/2"), tmp_path / "one")
    known = sharding.conditions

    def newer(plan: CollectPlan, task: str) -> Conditions:
        return replace(known(plan, task), versions={"rtphys": "0.2.0"})

    monkeypatch.setattr(sharding, "conditions", newer)
    two = collect(dealt([plan(1)], "2/2"), tmp_path / "two")
    with pytest.raises(CannotMerge, match=r"versions.rtphys was '0.1.0', now '0.2.0'"):
        merge([one, two], tmp_path / "joined")


def test_an_unfinished_shard(tmp_path: Path) -> None:
    shards(plan(1, 6), 2, tmp_path)
    one = collect(dealt([plan(1, 8)], "1/2"), tmp_path / "1-2")
    two = tmp_path / "2-2"
    path = two / "shard.json"
    path.write_text(path.read_text().replace('"episodes": 6', '"episodes": 8'))
    with pytest.raises(CannotMerge, match=r"shard 2/2 has 3 of its 4 episodes .* repeat"):
        merge([one, two], tmp_path / "joined")


def test_a_damaged_shard(tmp_path: Path) -> None:
    parts = shards(plan(1), 2, tmp_path)
    victim = next(parts[1].rglob("*.hdf5"))
    victim.write_bytes(b"x" * victim.stat().st_size)
    with pytest.raises(BadFile, match="is not what its journal says"):
        merge(parts, tmp_path / "joined")


def test_a_shards_folder_is_no_other_shards(tmp_path: Path) -> None:
    out = collect(dealt([plan()], "1/2"), tmp_path / "out")
    with pytest.raises(DatasetMismatch, match="it was shard 1/2, now shard 2/2"):
        collect(dealt([plan()], "2/2"), out)
    with pytest.raises(DatasetMismatch, match="it was shard 1/2, now no shard"):
        collect((plan(),), out)
    with pytest.raises(DatasetMismatch, match="other tasks"):
        collect(dealt([plan(3)], "1/2"), out)
    whole = collect((plan(),), tmp_path / "whole")
    with pytest.raises(DatasetMismatch, match="it was no shard, now shard 1/2"):
        collect(dealt([plan()], "1/2"), whole)


def test_the_division_is_even_and_whole() -> None:
    """Every unit is worked on, by as many shards as any other or by one."""
    for tasks in range(1, 8):
        units = dealt([replace(plan(), tasks=tuple("abcdefg"[:tasks]))], "1/1")[0].shard.units  # type: ignore[union-attr]
        for of in range(1, 9):
            work = [(u.leaf, s.stride[0]) for s in _all(units, of) for u in s.own]
            sharing = Shard(1, of, units).stride[1]
            assert sorted(work) == [(u.leaf, k) for u in units for k in range(sharing)]
            assert all(shard.own for shard in _all(units, of))


def _all(units, of: int) -> list[Shard]:
    return [Shard(index, of, units) for index in range(1, of + 1)]


def test_the_command_says_what_is_wrong(tmp_path: Path) -> None:
    one, _ = shards(plan(1), 2, tmp_path)
    done = CliRunner().invoke(app, ["merge", str(one), "--out", str(tmp_path / "joined")])
    assert done.exit_code == 2
    assert "missing: shard 2/2" in done.stderr
    done = CliRunner().invoke(app, ["merge", str(one), "--out", str(one)])
    assert "it is one of the shards" in done.stderr
