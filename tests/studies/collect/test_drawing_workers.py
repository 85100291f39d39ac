"""Drawing workers give what workers give that do all, whoever is killed."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest
from collecting import Striker, complete, content, kill_one, worker_processes
from robotless import variants

from rtphys.spec.collection import CollectionSpec
from rtphys.spec.episode import EpisodeSpec
from rtphys.spec.recording import RecordingSpec
from rtphys.studies.collect import collect
from rtphys.studies.collect_request import Run

pytestmark = [pytest.mark.sim, pytest.mark.render]

SMALL = RecordingSpec(("head", "left"), size="32x32")
BELL = CollectionSpec(EpisodeSpec("click_bell", "phys_random_all"), episodes=3, recording=SMALL)
SENSES = replace(SMALL, senses=("depth", "segmentation", "touch"))
MIXED = (
    replace(BELL, episodes=4),
    replace(BELL, episode=EpisodeSpec("lift_pot", "clean"), recording=SENSES),
    replace(BELL, episode=EpisodeSpec("dump_bin_bigbin", "clean"), episodes=2),
)


def drawn(specs: Sequence[CollectionSpec], folder: Path, gpus: int, workers: int = 2) -> Path:
    """`gpus`: as if there were so many; the CPU driver stands in for them."""
    assert complete(collect(specs, Run(folder / str(gpus), workers=workers, gpus=gpus)))
    return folder / str(gpus)


def test_a_dataset_is_the_same_with_drawing_workers(tmp_path: Path) -> None:
    one, other = (drawn([BELL], tmp_path, gpus) for gpus in (0, 1))
    assert content(one) == content(other)


@pytest.mark.slow
@pytest.mark.parametrize("variant", variants(MIXED))
def test_many_workers_give_what_one_gives(variant: str, tmp_path: Path) -> None:
    specs = variants(MIXED)[variant]
    one, other = drawn(specs, tmp_path, 0, 1), drawn(specs, tmp_path, 1, 8)
    assert content(one) == content(other)


@pytest.mark.slow
@pytest.mark.parametrize("which", [0, -1])
def test_any_worker_may_be_killed(which: int, tmp_path: Path) -> None:
    """The first one, or the last, which draws, as soon as there is one that does."""

    def strike() -> bool:
        workers = sorted(worker_processes())
        return len(workers) > 2 and kill_one(workers[which:])

    striker, run = Striker(strike, early=True), Run(tmp_path / "killed", workers=2, gpus=1)
    assert complete(collect([BELL], run, striker))
    assert any("SIGKILL" in text for text in striker.told) or which == 0
    assert striker.struck
    assert content(run.out) == content(drawn([BELL], tmp_path, 0, 1))
