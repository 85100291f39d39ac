"""Reproducing makes episodes and rejected seeds again; whatever was forged differs from them."""

import json
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest
import synthetic
from collected import write
from forger import Forger, forge
from forgeries import FORGERIES

from rtphys.assets.pack import Pack
from rtphys.campaign.pool import WorkerFailure
from rtphys.data.attempts import Rejected
from rtphys.data.check_episode import Effort, Problem
from rtphys.data.dataset import Dataset
from rtphys.data.manifest import read_manifest
from rtphys.data.rewrite import convert, subset
from rtphys.data.staging import stage_episode
from rtphys.data.verify import verify
from rtphys.data.writer import DatasetWriter, Rejection
from rtphys.episode import reproduce as reproducing
from rtphys.episode.generate import Attempt
from rtphys.physics import load_domain
from rtphys.spec.collection import CollectionSpec
from rtphys.spec.episode import EpisodeSpec, Recipe
from rtphys.spec.recording import RecordingSpec
from rtphys.spec.stored import stored
from rtphys.studies.collect import collect
from rtphys.studies.render import render
from rtphys.studies.reproduce import (
    Reproduction,
    lost,
    recorded_attempts,
    reproduced,
    reproducer,
)
from rtphys.studies.requests import RenderSpec, Run
from rtphys.task.spec import Task

pytestmark = [pytest.mark.sim, pytest.mark.render]
Forge = Callable[[Callable[[Forger], None]], Path]


@pytest.fixture(scope="module")
def once(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Simulates and draws each recipe once: what is made again depends on no forgery."""
    tried: dict[str, Attempt] = {}
    made: dict[str, reproducing.RegeneratedEpisode] = {}
    attempt, regenerated = reproducing.attempt, reproducing.regenerated

    def attempt_once(
        recipe: Recipe, task: Task, pack: Pack, touch: bool = False, happened: bool = False
    ) -> Attempt:
        key = json.dumps([stored(recipe), touch, happened], sort_keys=True)
        if key not in tried:
            tried[key] = attempt(recipe, task, pack, touch=touch, happened=happened)
        return tried[key]

    def made_once(done: Attempt, scene: reproducing.Scene) -> reproducing.RegeneratedEpisode:
        of = stored(done.recipe), stored(scene.recorded.header.spec.recording)
        key = json.dumps([*of, reproducing.pictures_ready()], sort_keys=True)
        if key not in made:
            made[key] = regenerated(
                done, replace(scene, folder=tmp_path_factory.mktemp("made") / "0")
            )
        return made[key]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(reproducing, "attempt", attempt_once)
        patch.setattr(reproducing, "regenerated", made_once)
        yield


def reproduce_here(out: Path) -> Reproduction:
    """As `reproduced`, everything, without a process of its own."""
    found, worker = Reproduction(), reproducer("slim")
    attempts = [*recorded_attempts(out, read_manifest(out), found)]
    found.judge(attempts, [worker(attempt) for attempt in attempts])
    return found


def words(problems: list[Problem]) -> str:
    return "\n".join(map(str, problems))


@pytest.fixture
def forged(honest: Path, tmp_path: Path) -> Forge:
    """A copy of the honest dataset after a change, of which every digest is renewed."""

    def make(change: Callable[[Forger], None]) -> Path:
        out = Path(shutil.copytree(honest, tmp_path / "forged"))
        forge(out, change)
        return out

    return make


def test_forging_nothing_is_found_by_nobody(honest: Path, once: None, forged: Forge) -> None:
    out = forged(lambda _: None)
    assert (out / "manifest.json").read_bytes() == (honest / "manifest.json").read_bytes()
    found = reproduce_here(out)
    assert (found.problems, found.notes) == ([], [])
    assert (len(found.episodes), len(found.rejections)) == (2, 1)


QUICK = 6  # every so many forgeries are tried in the quick tests


@pytest.mark.parametrize(
    "name",
    [
        name if number % QUICK == 1 else pytest.param(name, marks=pytest.mark.slow)
        for number, name in enumerate(FORGERIES)
    ],
)
def test_a_forgery_is_found(name: str, once: None, forged: Forge) -> None:
    change, text = FORGERIES[name]
    assert text in words(reproduce_here(forged(change)).problems)


def test_a_removed_attempt_leaves_a_gap(forged: Forge) -> None:
    out = forged(lambda forger: forger.entries.pop(1))
    assert "attempt 0 is of seed 1, not of 0: one is missing" in words(verify(out).problems)


def test_other_versions_and_assets_are_named(once: None, forged: Forge) -> None:
    def change(forger: Forger) -> None:
        forger.header["resolved"]["versions"]["sapien"] = "2.0"
        forger.header["resolved"]["assets"]["digest"] = "0" * 64
        for number in (0, 1):
            forger.label(number, lambda label: label["versions"].update(sapien="2.0"))
        forger.label(1, lambda label: label.update(state_hash="0" * 64))

    found = reproduce_here(forged(change))
    (problem,) = found.problems
    assert "state_hash is" in problem.text
    assert problem.text.endswith("(others here than in the collection: sapien, assets.digest)")
    assert "sapien was '2.0', now" in found.notes[0]


def test_what_cannot_be_made_again_is_named(forged: Forge) -> None:
    def change(forger: Forger) -> None:
        forger.header["resolved"]["visual"]["clutter"] = 3

    text = words(reproduce_here(forged(change)).problems)
    assert text.count("cannot be made again") == 3
    assert "visual = " in text and "protocol phys_random_all has" in text


def test_an_episode_under_another_look_is_made_again_under_it(honest: Path, tmp_path: Path) -> None:
    """It was never the same: the label tells the look, and the recipe does not."""
    for look in ("official_random", "clean"):
        plan = RenderSpec(data=honest, out=tmp_path / look, look=look, workers=1)
        render(plan)
        assert reproduce_here(plan.out).problems == []


def test_what_a_policy_did_is_left_out(tmp_path: Path) -> None:
    write(tmp_path, synthetic.episode(0), what=synthetic.header(policy="random"))
    found = Reproduction()
    assert not [*recorded_attempts(tmp_path, read_manifest(tmp_path), found)]
    assert not found.problems and "what random did cannot be made again" in found.notes[0]


@pytest.mark.parametrize("part", ["all", "one side", "some seeds"])
def test_an_unpaired_seed_is_tried_again_with_its_twin_alone(part: str, tmp_path: Path) -> None:
    """Without it the seed succeeds, which was called a problem of a sound part of a dataset."""
    main = synthetic.header(twin="phys_random_all")
    with DatasetWriter(tmp_path / "data") as dataset:
        for side in main.spec.sides:
            task = dataset.task(replace(main, spec=side))
            task.record(Rejection(0, "unpaired"))
            task.record(stage_episode(task.staging(1), synthetic.episode(1)))
    whole = Dataset(tmp_path / "data")
    parts = {"all": whole, "one side": whole.where(config=main.spec.name)}
    subset(parts.get(part) or whole.where(seeds=[0, 1]), tmp_path / "part")
    found = Reproduction()
    tried = [*recorded_attempts(tmp_path / "part", read_manifest(tmp_path / "part"), found)]
    seeds = [one.row.seed for one in tried]
    assert seeds == {"all": [0, 1, 0, 1], "one side": [1], "some seeds": [1, 1]}[part]
    assert len(found.notes) == {"all": 0, "one side": 1, "some seeds": 2}[part]


def test_another_renderer_is_told_from_a_change(once: None, forged: Forge) -> None:
    """Every picture of both episodes a little different: nobody can tell who drew them."""

    def change(forger: Forger) -> None:
        for number in (0, 1):
            forger.pictures(number, lambda _, rgb: np.maximum(rgb, 2))

    found = reproduce_here(forged(change))
    assert found.problems == []
    assert len(found.notes) == 4
    assert (
        "drawn or encoded by another program, by `convert`, or changed a little" in found.notes[0]
    )


def test_without_a_renderer_the_rest_is_compared(
    honest: Path, forged: Forge, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(reproducing, "pictures_ready", lambda: False)
    found = reproduce_here(honest)
    assert found.problems == []
    assert "were not drawn again: no device to draw with" in found.notes[0]
    out = forged(FORGERIES["effort scaled"][0])
    assert "effort from frame" in words(reproduce_here(out).problems)


def test_a_lost_worker_is_a_problem_unless_the_collection_lost_it_too(honest: Path) -> None:
    first, *_ = recorded_attempts(honest, read_manifest(honest), Reproduction())
    loss = WorkerFailure("worker_crash", "ended with exit code 1")
    (_, text), *_ = lost(first, loss).problems
    assert text.endswith("its worker was lost (worker_crash: ended with exit code 1)")
    assert isinstance(first.row, Rejected)
    known = replace(first, row=first.row.model_copy(update={"reason": "worker_crash"}))
    assert lost(known, loss).problems == []


@pytest.fixture(scope="module")
def with_failure(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("failure")
    spec = EpisodeSpec("place_empty_cup", "phys_random", overrides={"friction": 0.08})
    recording = RecordingSpec(("head",), ("touch",))
    plan = CollectionSpec(
        spec, recording, episodes=9, first_seed=700, max_attempts=1, keep_failures="all"
    )
    collect([plan], Run(out, workers=1))
    (failure,) = Dataset(out).failures()
    assert failure.failure is not None
    assert (failure.seed, failure.failure.reason) == (700, "slipped")
    return out


@pytest.mark.slow
def test_a_failure_that_was_kept_is_made_again(with_failure: Path, tmp_path: Path) -> None:
    """All of its files, touch included; a forger who renews every digest is found."""
    found = reproduce_here(with_failure)
    assert (found.problems, found.notes, len(found.rejections)) == ([], [], 1)
    out = Path(shutil.copytree(with_failure, tmp_path / "forged"))
    (failure,) = Dataset(out).failures()
    label = json.loads(failure.paths.phys_meta.read_text())
    label["failure"]["frame"] -= 5
    failure.paths.phys_meta.write_text(json.dumps(label))
    assert "failure.frame is" in words(reproduce_here(out).problems)
    with h5py.File(failure.paths.hdf5, "r+") as file:
        file["rtphys/measured/effort"][7] += 0.1
    assert "effort from frame 7" in words(reproduce_here(out).problems)


@pytest.mark.slow
def test_an_untouched_dataset_is_equal_to_the_last_bit(honest: Path, tmp_path: Path) -> None:
    """By processes of their own; of converted episodes, all but the pictures."""
    found = reproduced(honest, 99, workers=1)
    assert (found.problems, found.notes) == ([], [])
    assert (len(found.episodes), len(found.rejections)) == (2, 1)
    convert(honest, tmp_path / "legacy", "legacy")
    found = reproduced(tmp_path / "legacy", 99, workers=1)
    assert found.problems == []
    pictures = "pictures of head_camera are not those made again"
    assert len(found.notes) == 2
    assert all(pictures in note and "in 0.00% of its pixels" in note for note in found.notes)


PLAN = CollectionSpec(recording=RecordingSpec(("head",)), episodes=2)
BELL = EpisodeSpec("click_bell", "phys_random")
KINDS = {
    "twin": replace(PLAN, episode=EpisodeSpec("place_phone_stand", "phys_random"), twin="clean"),
    "only": replace(BELL, protocol="clean", only=("friction",), recovery=False),
    "held": replace(BELL, overrides={"friction": 0.3}, pair_tasks=True),
    "own domain": replace(BELL, ranges=load_domain("global")),
    "unseen": replace(BELL, protocol="official_random", split="unseen"),
}


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_of_dataset_can_be_made_again(kind: str, tmp_path: Path) -> None:
    spec = KINDS[kind]
    config = "own" if kind == "unseen" else None
    plan = replace(PLAN, episode=spec, config=config) if isinstance(spec, EpisodeSpec) else spec
    collect([plan], Run(tmp_path / "data", workers=1))
    assert verify(tmp_path / "data", Effort.DEEP).sound
    found = reproduced(tmp_path / "data", 99, workers=1)
    assert (found.problems, found.notes) == ([], [])


@pytest.mark.slow
def test_what_another_shader_drew_can_be_made_again(tmp_path: Path) -> None:
    """In processes of their own: this one draws with one shader for ever."""
    chosen = ("click_bell", "--shader", "default", "--episodes", "1", "--cameras", "head")
    for command in (
        ("collect", *chosen, "--out", "data"),
        ("verify", "data", "--deep", "--reproduce", "1"),
    ):
        rtphys = (sys.executable, "-m", "rtphys", *command)
        done = subprocess.run(rtphys, cwd=tmp_path, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        assert "note:" not in done.stderr
    assert "1 episode made again" in done.stdout + done.stderr
