"""Twins: each seed under two protocols, recorded under both or under neither."""

import json
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from collecting import PLAN, complete, content

from rtphys.assets.pack import default_pack
from rtphys.data.attempts import Rejected, read_attempts
from rtphys.data.dataset import Dataset
from rtphys.data.faults import DatasetMismatch
from rtphys.data.json_text import compact
from rtphys.data.ledger import chained, read_lines
from rtphys.data.verify import verify
from rtphys.data.writer import DatasetWriter
from rtphys.episode.assemble import rejection
from rtphys.episode.generate import Attempt
from rtphys.spec.collection import CollectionSpec
from rtphys.spec.episode import EpisodeSpec
from rtphys.studies.collect import CollectionSeries, collect, header_of
from rtphys.studies.requests import Run
from rtphys.task.spec import load_task

pytestmark = [pytest.mark.sim, pytest.mark.render]

TWINNED = replace(PLAN, twin="clean")
OWN, TWIN = "phys_random/click_bell/aloha_agilex", "phys_random.twin=clean/click_bell/aloha_agilex"


@pytest.fixture(scope="module")
def pairs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("pairs") / "data"
    assert complete(collect([TWINNED], Run(out, workers=1)))
    return out


def test_a_pair_is_one_layout_under_two_physics(pairs: Path) -> None:
    assert verify(pairs).problems == []
    data = Dataset(pairs)
    assert len(data) == 4
    assert len(data.pairs()) == len(data.where(protocol="phys_random").pairs()) == 2
    assert data.where(config="phys_random.twin=clean").pairs() == ()
    for physical, nominal in data.pairs():
        assert physical.seed == nominal.seed
        assert physical.physics.varied
        assert not nominal.physics.varied
        assert nominal.meta.protocol == "clean"
        here, there = (e.poses("bell")[0, :2] for e in (physical, nominal))
        assert np.allclose(here, there, atol=0.005), "tilt, height and settling alone move it"


def test_its_two_halves_are_what_each_protocol_gives_alone(pairs: Path, undisturbed: Path) -> None:
    alone = Dataset(undisturbed)
    for (physical, _), single in zip(Dataset(pairs).pairs(), alone, strict=True):
        assert physical.meta.state_hash == single.meta.state_hash


@pytest.mark.processes
def test_resumed_with_other_workers_it_is_the_same(pairs: Path, tmp_path: Path) -> None:
    out = tmp_path / "data"
    assert complete(collect([replace(TWINNED, episodes=1)], Run(out, workers=1)))
    assert complete(collect([TWINNED], Run(out, workers=2)))
    assert content(out) == content(pairs)


@pytest.mark.parametrize("lacking", [OWN, TWIN])
def test_a_kill_between_the_two_commits_is_mended(
    pairs: Path, tmp_path: Path, lacking: str
) -> None:
    out = tmp_path / "data"
    shutil.copytree(pairs, out)
    journal = out / lacking / "ledger.jsonl"
    lines = journal.read_bytes().splitlines(keepends=True)
    journal.write_bytes(b"".join(lines[:-1]))
    (out / "manifest.json").unlink()
    assert complete(collect([TWINNED], Run(out, workers=1)))
    assert content(out) == content(pairs)


def test_a_leaf_without_twins_is_not_continued_with_them(undisturbed: Path, tmp_path: Path) -> None:
    out = tmp_path / "data"
    shutil.copytree(undisturbed, out)
    with pytest.raises(DatasetMismatch, match="twin was None, now 'clean'"):
        collect([TWINNED], Run(out, workers=1))
    assert content(out) == content(undisturbed)


def test_pairs_of_other_seeds_are_found(pairs: Path, tmp_path: Path) -> None:
    out = tmp_path / "data"
    shutil.copytree(pairs, out)
    ledger = out / TWIN / "ledger.jsonl"
    *kept, last = read_lines(ledger)
    text = compact({**json.loads(last.text), "seed": 99})
    check = chained(kept[-1].check, text).encode()
    ledger.write_bytes(ledger.read_bytes()[: kept[-1].end] + check + b" " + text + b"\n")
    problems = [str(problem) for problem in verify(out).problems]
    assert any("pair other seeds" in problem for problem in problems), problems


HARD = '''
"""A bell that can be rung under nominal physics alone."""
from dataclasses import replace
from rtphys.task import Infeasible, load_task

bell = load_task("click_bell")

def script(robot):
    if robot.scene.physics.varied:
        raise Infeasible("slipped", "as told")
    bell.script(robot)

task = replace(bell, script=script)
'''


@pytest.fixture
def hard(own_task) -> CollectionSpec:
    own_task("hard", HARD)
    return replace(TWINNED, episode=EpisodeSpec("hard", "phys_random"), max_attempts=2)


def test_half_a_pair_is_no_episode(hard: CollectionSpec, tmp_path: Path) -> None:
    out = tmp_path / "data"
    progresses = collect([hard], Run(out, workers=1))
    assert not complete(progresses)
    assert verify(out).problems == []
    reasons = {
        config: Dataset(out).manifest.task_datasets[f"{config}/hard/aloha_agilex"].rejections
        for config in ("phys_random", "phys_random.twin=clean")
    }
    assert reasons == {"phys_random": {"slipped": 2}, "phys_random.twin=clean": {"unpaired": 2}}
    first = next(read_attempts(out / "phys_random.twin=clean/hard/aloha_agilex/ledger.jsonl"))
    assert isinstance(first, Rejected) and first.detail == "under phys_random: slipped"


def test_an_attempt_that_comes_out_otherwise_is_an_error(pairs: Path, tmp_path: Path) -> None:
    """One half is committed; made again for the other half, it must be the same."""
    out = tmp_path / "data"
    shutil.copytree(pairs, out)
    journal = out / TWIN / "ledger.jsonl"
    journal.write_bytes(b"".join(journal.read_bytes().splitlines(keepends=True)[:-1]))
    task, pack = load_task("click_bell"), default_pack()
    with DatasetWriter(out) as data:
        writers = tuple(data.task(header_of(p, task, pack)) for p in TWINNED.sides)
        series = CollectionSeries([TWINNED], writers)
        assert series.progress.accepted == 1
        seed = series.begin()
        recipes = series.job(seed).recipes
        with pytest.raises(DatasetMismatch, match="was not before"):
            series.take(seed, tuple(rejection(Attempt(one, "worker_crash")) for one in recipes))
