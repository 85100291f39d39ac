"""The same jobs on a real Ray cluster of this machine."""

import os
from collections.abc import Iterator
from pathlib import Path

import pytest

ray = pytest.importorskip("ray")

from pool_jobs import Outcome, Trouble, outcomes, setup  # noqa: E402

from rtphys.campaign.pool import Limits, WorkerError, WorkerFailure  # noqa: E402
from rtphys.campaign.ray import NoCluster, RayPool, connect  # noqa: E402


@pytest.fixture(scope="module")
def cluster() -> Iterator[None]:
    """A private cluster of two CPUs; workers must be able to import `pool_jobs`."""
    before = os.environ.get("PYTHONPATH", "")
    os.environ["PYTHONPATH"] = os.pathsep.join(
        [str(Path(__file__).parent), *([before] if before else [])]
    )
    connect("local", 2)
    yield
    ray.shutdown()
    os.environ["PYTHONPATH"] = before


def run(jobs: list[Trouble], limits: Limits) -> dict[int, Outcome]:
    with RayPool[Trouble, int](setup, 2, limits) as pool:
        return outcomes(pool, jobs)


@pytest.mark.slow
def test_crashes_and_hangs_end_as_in_the_local_pool(cluster: None) -> None:
    found = run([Trouble(), Trouble("abort"), Trouble("spin"), Trouble()], Limits(seconds=3))
    assert [type(found[n]) for n in range(4)] == [int, WorkerFailure, WorkerFailure, int]
    assert isinstance(found[1], WorkerFailure)
    assert isinstance(found[2], WorkerFailure)
    assert (found[1].reason, found[2].reason) == ("worker_crash", "worker_hang")


@pytest.mark.slow
def test_a_bug_comes_out_with_its_traceback(cluster: None) -> None:
    raised = run([Trouble("bug")], Limits())[0]
    assert isinstance(raised, WorkerError) and str(raised) == "0: TypeError: a cat is no dog"
    assert "pool_jobs.py" in raised.trace


def test_a_ray_that_does_not_start_here_is_no_missing_cluster(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise ValueError("The object store needs 75 MB\nof shared memory")

    monkeypatch.setattr(ray, "is_initialized", lambda: False)
    monkeypatch.setattr(ray, "init", refuse)
    with pytest.raises(NoCluster, match=r"does not start here: The object store needs 75 MB$"):
        connect("local")


@pytest.mark.slow  # Ray takes its time to find out
def test_without_a_cluster_the_cure_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ray, "is_initialized", lambda: False)
    with pytest.raises(NoCluster, match="ray start --head"):
        connect("127.0.0.1:1")
