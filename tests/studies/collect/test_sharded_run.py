"""Shards of real tasks, joined."""

from dataclasses import replace
from pathlib import Path

import pytest
from collecting import content

from rtphys.data.verify import verify
from rtphys.studies.collect import CollectPlan, collect, dealt, merge

pytestmark = [pytest.mark.sim, pytest.mark.render, pytest.mark.slow]

PLAN = CollectPlan(("click_bell", "stamp_seal"), 3, Path(), protocol="phys_random", workers=2)


@pytest.fixture(scope="module")
def alone(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Without shards."""
    out = tmp_path_factory.mktemp("alone") / "data"
    assert collect(replace(PLAN, out=out)).complete
    return out


@pytest.mark.parametrize("of", [2, 3])
def test_shards_of_two_tasks_join_to_the_same_files(alone: Path, tmp_path: Path, of: int) -> None:
    """Two shards have a task each; three share both, and merging tries what they lack."""
    parts = [tmp_path / str(index) for index in range(1, of + 1)]
    for index, part in enumerate(parts, start=1):
        for plan in dealt([PLAN], f"{index}/{of}"):
            assert collect(replace(plan, out=part)).complete
        assert verify(part).sound
    tallies = merge(parts, tmp_path / "joined", workers=2)
    assert all(tally.done for tally in tallies)
    assert content(tmp_path / "joined") == content(alone)
