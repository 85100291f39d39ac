"""One undisturbed collection for all tests of the folder."""

from dataclasses import replace
from pathlib import Path

import pytest
import sharding
from collecting import PLAN

from rtphys.studies.collect import collect


@pytest.fixture(scope="session")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two episodes by one worker."""
    out = tmp_path_factory.mktemp("undisturbed") / "data"
    summary = collect(replace(PLAN, out=out))
    assert summary.complete
    return out


@pytest.fixture
def merging_needs_no_robot(monkeypatch: pytest.MonkeyPatch) -> None:
    """Seeds that no shard reached are tried as the shards' were."""
    monkeypatch.setattr("rtphys.studies.collect.join.collect", sharding.work)
