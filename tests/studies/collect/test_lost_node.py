"""A cluster of two nodes, one of which is lost."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

ray = pytest.importorskip("ray")


from collecting import PLAN, Striker, complete, content, worker_processes  # noqa: E402
from ray.cluster_utils import Cluster  # noqa: E402

from rtphys.studies.collect import collect  # noqa: E402
from rtphys.studies.requests import Run  # noqa: E402

pytestmark = [pytest.mark.sim, pytest.mark.render, pytest.mark.slow]


@pytest.fixture
def cluster() -> Iterator[Cluster]:
    """Two nodes of one CPU each; this process joins them as a user would."""
    assert not ray.is_initialized()
    made = Cluster()
    for _ in range(2):
        made.add_node(num_cpus=1, object_store_memory=100_000_000, include_dashboard=False)
    yield made
    ray.shutdown()
    made.shutdown()


def test_a_lost_node_loses_nothing_and_doubles_nothing(cluster: Cluster, tmp_path: Path) -> None:
    """The second one, when an attempt is done and both nodes have a worker."""

    def strike() -> bool:
        if len(worker_processes()) < 2:
            return False
        cluster.remove_node(next(iter(cluster.worker_nodes)), allow_graceful=False)
        return True

    striker, out, alone = Striker(strike), tmp_path / "data", tmp_path / "alone"
    plan, run = replace(PLAN, episodes=6), Run(out, 2, "ray", cluster.address)
    assert complete(collect([plan], run, striker))
    assert complete(collect([plan], Run(alone, 2)))
    assert striker.struck
    assert any("lost a worker" in text for text in striker.told)
    assert content(out) == content(alone)
