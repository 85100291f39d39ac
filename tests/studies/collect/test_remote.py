"""The same datasets on a real Ray cluster of this machine, whoever is killed."""

import os
import signal
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

ray = pytest.importorskip("ray")

from collecting import content, processes  # noqa: E402
from pool_jobs import Trouble, setup  # noqa: E402

from rtphys.campaign.workers.pool import Done, Limits, Lost, WorkerFailed  # noqa: E402
from rtphys.campaign.workers.ray import RayCrew  # noqa: E402
from rtphys.campaign.workers.ray_cluster import NoCluster, connect  # noqa: E402
from rtphys.studies.collect import CollectPlan, Listener, Tally, collect  # noqa: E402
from rtphys.studies.collect.remote import OtherMachine, RemoteDesk  # noqa: E402

pytestmark = [pytest.mark.sim, pytest.mark.render, pytest.mark.slow]

PLAN = CollectPlan(("click_bell", "lift_pot"), 2, Path(), protocol="phys_random", workers=2)


@pytest.fixture(scope="module")
def cluster() -> Iterator[None]:
    """A private cluster of two CPUs; workers must be able to import `pool_jobs`."""
    here = str(Path(__file__).parents[2] / "campaign" / "workers")
    before = os.environ.get("PYTHONPATH", "")
    os.environ["PYTHONPATH"] = os.pathsep.join([here, *([before] if before else [])])
    connect("local", 2)
    yield
    ray.shutdown()
    os.environ["PYTHONPATH"] = before


@pytest.fixture(scope="module")
def alone(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The local pool's dataset."""
    out = tmp_path_factory.mktemp("alone") / "data"
    assert collect(replace(PLAN, out=out)).complete
    return out


class Killer(Listener):
    """Kills -9 one process with `word` in its command line, once an attempt is done."""

    def __init__(self, word: str) -> None:
        self.word = word
        self.killed = 0
        self.told: list[str] = []
        self.tallies: list[Tally] = []

    def started(self, tallies: list[Tally]) -> None:
        self.tallies = tallies

    def ticked(self) -> None:
        begun = any(tally.attempts for tally in self.tallies)
        if begun and not self.killed and (found := processes(self.word)):
            self.killed = found[0]
            os.kill(found[0], signal.SIGKILL)

    def noticed(self, text: str) -> None:
        self.told.append(text)


# ---- datasets ------------------------------------------------------------------------------------


def test_the_dataset_is_the_local_pools(cluster: None, alone: Path, tmp_path: Path) -> None:
    out = tmp_path / "data"
    assert collect(replace(PLAN, out=out, runner="ray")).complete
    assert content(out) == content(alone)


@pytest.mark.parametrize("word", ["ray::Foreman", "rtphys.campaign.workers.worker"])
def test_a_killed_worker_loses_nothing_and_doubles_nothing(
    cluster: None, alone: Path, tmp_path: Path, word: str
) -> None:
    killer = Killer(word)
    out = tmp_path / "data"
    assert collect(replace(PLAN, out=out, runner="ray"), killer).complete
    assert killer.killed
    assert killer.told, "somebody is told"
    assert content(out) == content(alone)


def test_one_runner_continues_the_other(cluster: None, alone: Path, tmp_path: Path) -> None:
    out = tmp_path / "data"
    assert collect(replace(PLAN, out=out, episodes=1)).complete
    summary = collect(replace(PLAN, out=out, runner="ray"))
    assert [tally.found_episodes for tally in summary.tallies] == [1, 1]
    assert content(out) == content(alone)


# ---- the crew itself -----------------------------------------------------------------------------


def run(jobs: list[Trouble], limits: Limits) -> dict[int, Done | Lost]:
    found: dict[int, Done | Lost] = {}
    with RayCrew[Trouble, int](setup, 2, limits) as crew:
        waiting = list(enumerate(jobs))
        while waiting or crew.busy:
            while waiting and crew.room:
                crew.submit(*waiting.pop(0))
            found |= {int(str(event.name)): event for event in crew.wait()}
    return found


def test_crashes_and_hangs_end_as_in_the_local_pool(cluster: None) -> None:
    found = run([Trouble(), Trouble("abort"), Trouble("hang"), Trouble()], Limits(seconds=3))
    assert [type(found[n]) for n in range(4)] == [Done, Lost, Lost, Done]
    assert isinstance(found[1], Lost)
    assert isinstance(found[2], Lost)
    assert (found[1].reason, found[2].reason) == ("worker_crash", "worker_hang")


def test_a_bug_comes_out_with_its_traceback(cluster: None) -> None:
    with pytest.raises(WorkerFailed, match="0: TypeError: a cat is no dog") as caught:
        run([Trouble("bug")], Limits())
    assert "pool_jobs.py" in caught.value.trace


# ---- what is refused -----------------------------------------------------------------------------


def test_a_node_with_other_assets_or_versions_is_refused() -> None:
    desk = RemoteDesk.of(PLAN, _desk())
    with pytest.raises(OtherMachine, match="its assets are"):
        replace(desk, digest="0" * 64)()
    older = {"click_bell": {**desk.tasks["click_bell"], "sapien": "2.2.0"}}
    with pytest.raises(OtherMachine, match=r"click_bell: sapien was '2.2.0'"):
        replace(desk, tasks=older)()


def _desk():
    from rtphys.assets.pack import default_pack
    from rtphys.studies.collect.work import Desk

    return Desk(default_pack(), ("head",), "native", "slim")


def test_without_a_cluster_the_cure_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ray, "is_initialized", lambda: False)
    with pytest.raises(NoCluster, match="ray start --head"):
        connect("127.0.0.1:1")
