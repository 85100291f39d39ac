"""The same datasets on a real Ray cluster of this machine, whoever is killed."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

ray = pytest.importorskip("ray")


from collecting import Striker, complete, content, kill_one, processes  # noqa: E402

from rtphys.assets.pack import default_pack  # noqa: E402
from rtphys.campaign.ray import connect  # noqa: E402
from rtphys.spec.collection import CollectionSpec  # noqa: E402
from rtphys.spec.episode import EpisodeSpec  # noqa: E402
from rtphys.studies.collect import collect  # noqa: E402
from rtphys.studies.collect_worker import CollectWorker, OtherMachine, RemoteWorker  # noqa: E402
from rtphys.studies.requests import Run, specs_for  # noqa: E402

pytestmark = [pytest.mark.sim, pytest.mark.render, pytest.mark.slow]

PLANS = specs_for(
    CollectionSpec(EpisodeSpec(protocol="phys_random"), episodes=2), ("click_bell", "lift_pot")
)


@pytest.fixture(scope="module")
def cluster() -> Iterator[None]:
    """A private cluster of two CPUs."""
    connect("local", 2)
    yield
    ray.shutdown()


@pytest.fixture(scope="module")
def alone(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The local pool's dataset."""
    out = tmp_path_factory.mktemp("alone") / "data"
    assert complete(collect(PLANS, Run(out, 2)))
    return out


# ---- datasets ------------------------------------------------------------------------------------


def test_the_dataset_is_the_local_pools(cluster: None, alone: Path, tmp_path: Path) -> None:
    out = tmp_path / "data"
    assert complete(collect(PLANS, Run(out, 2, "ray")))
    assert content(out) == content(alone)


@pytest.mark.parametrize("word", ["ray::WorkerActor", "rtphys-worker"])
def test_a_killed_worker_loses_nothing_and_doubles_nothing(
    cluster: None, alone: Path, tmp_path: Path, word: str
) -> None:
    striker, out = Striker(lambda: kill_one(processes(word))), tmp_path / "data"
    assert complete(collect(PLANS, Run(out, 2, "ray"), striker))
    assert striker.struck
    assert striker.told, "somebody is told"
    assert content(out) == content(alone)


def test_one_runner_continues_the_other(cluster: None, alone: Path, tmp_path: Path) -> None:
    out = tmp_path / "data"
    begun = [replace(plan, episodes=1) for plan in PLANS]
    assert complete(collect(begun, Run(out, 2)))
    progresses = collect(PLANS, Run(out, 2, "ray"))
    assert [progress.accepted - progress.new_accepted for progress in progresses] == [1, 1]
    assert content(out) == content(alone)


# ---- what is refused -----------------------------------------------------------------------------


def test_a_node_with_other_assets_or_versions_is_refused() -> None:
    pack = default_pack()
    remote = RemoteWorker.of(CollectWorker(pack), [CollectionSpec(EpisodeSpec("click_bell"))])
    with pytest.raises(OtherMachine, match="its assets are"):
        replace(remote, digest="0" * 64)()
    ((key, found),) = remote.versions.items()
    older = {key: {**found, "sapien": "2.2.0"}}
    with pytest.raises(OtherMachine, match=r"click_bell: sapien was '2.2.0'"):
        replace(remote, versions=older)()
