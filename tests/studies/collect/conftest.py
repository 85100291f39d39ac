"""One undisturbed collection for all tests of the folder, and collections without a robot."""

from pathlib import Path

import pytest
import robotless
from collecting import PLAN, complete
from quick_pool import QuickPool

from rtphys.campaign.local import LocalPool
from rtphys.studies import collect as collect_module
from rtphys.studies.collect import collect
from rtphys.studies.requests import Run


@pytest.fixture(scope="session")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two episodes by one worker."""
    out = tmp_path_factory.mktemp("undisturbed") / "data"
    assert complete(collect([PLAN], Run(out, workers=1)))
    return out


@pytest.fixture
def without_robot(monkeypatch: pytest.MonkeyPatch) -> None:
    """Collections and merges go their usual way, but for what a worker does, in this process."""
    _do_without_robot(monkeypatch)
    monkeypatch.setattr(collect_module, "CollectWorker", robotless.QuickCollector)
    monkeypatch.setattr(collect_module, "LocalPool", QuickPool)


@pytest.fixture
def slow_disk(monkeypatch: pytest.MonkeyPatch) -> None:
    """The same in worker processes, where a write takes long; after `without_robot`, too."""
    _do_without_robot(monkeypatch)
    monkeypatch.setattr(collect_module, "CollectWorker", robotless.SlowCollector)
    monkeypatch.setattr(collect_module, "LocalPool", LocalPool)


def _do_without_robot(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        collect_module, "check", lambda plans, run: {one.episode.task: one for one in plans}
    )
    monkeypatch.setattr(collect_module, "check_drawable", lambda shader: 0)
    monkeypatch.setattr(collect_module, "check_assets", lambda plans, tasks, pack: None)
    monkeypatch.setattr(collect_module, "default_pack", lambda progress: None)
    monkeypatch.setattr(collect_module, "header_of", robotless.header)
