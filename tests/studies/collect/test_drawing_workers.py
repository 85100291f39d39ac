"""Drawing workers give what workers give that do all, whoever is killed."""

import os
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest
from collecting import Striker, complete, content, kill_one, worker_processes
from robotless import variants

from rtphys.assets.pack import default_pack
from rtphys.campaign.local import LocalPool
from rtphys.campaign.two_stages import TwoStagePool
from rtphys.doctor import Finding
from rtphys.spec.collection import CollectionSpec
from rtphys.spec.episode import EpisodeSpec
from rtphys.spec.recording import RecordingSpec
from rtphys.studies import collect as collect_module
from rtphys.studies import resources
from rtphys.studies.collect import collect, pool_of
from rtphys.studies.collect_worker import CollectWorker, Drawer
from rtphys.studies.requests import Run

pytestmark = [pytest.mark.sim, pytest.mark.render, pytest.mark.processes]

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


@pytest.mark.parametrize(("found", "asked"), [(0, None), (2, 0), (1, None), (1, 2)])
def test_drawing_workers_are_chosen_where_gpus_draw(
    found: int, asked: int | None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(collect_module, "check_drawable", lambda shader: found)
    worker, told = CollectWorker(default_pack()), Striker(lambda: True)
    pool = pool_of(Run(tmp_path, gpus=asked), worker, [BELL, MIXED[1]], 4, told)
    gpus = found if asked is None else asked
    assert isinstance(pool, TwoStagePool if gpus else LocalPool) and pool.size == 4
    many = f"4 workers simulate, {4 * gpus} draw on {gpus} GPU{'s' * (gpus > 1)}, 16 at a time"
    assert told.told == [many] * (gpus > 0)


def test_how_many_gpus_draw_is_remembered(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(resources, "user_cache", lambda: tmp_path)
    drawing = Finding("renderer", "ok", "ok", "it draws", gpus=2)
    monkeypatch.setattr(resources, "check_renderer", lambda command: drawing)
    with monkeypatch.context() as strange:
        strange.setenv("VK_DRIVER_FILES", "/no/text/\udcfc.json")
        assert resources.check_drawable() == 2, "only not remembered"
    assert resources.check_drawable() == 2
    monkeypatch.setattr(resources, "check_renderer", lambda command: 1 / 0)
    assert resources.check_drawable() == 2


@pytest.mark.parametrize(("gpu", "shown", "chosen"), [(1, "", "1"), (1, "4,7", "7"), (0, "", "0")])
def test_a_drawing_worker_sees_its_own_gpu(
    gpu: int, shown: str, chosen: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CUDA_VISIBLE_DEVICES", shown)
    Drawer(CollectWorker(default_pack()), gpu)()
    assert os.environ["CUDA_VISIBLE_DEVICES"] == chosen


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
