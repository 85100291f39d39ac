"""Stored episodes are simulated again with the assets of their own task dataset."""

from dataclasses import replace

import pytest
import synthetic
from test_dataset_writer import collect

from rtphys.assets.action_layout import ActionLayout
from rtphys.assets.pack import Pack
from rtphys.data.dataset import Dataset
from rtphys.episode import prove
from rtphys.episode.generate import Attempt
from rtphys.setting.setting import Recipe
from rtphys.sim.recorder import Recording
from rtphys.task.spec import Task

DIGESTS = {"plain": "a" * 64, "other_assets": "b" * 64}


class Marked:
    """A pack of which only the digest matters."""

    def __init__(self, digest: str) -> None:
        self.digest = digest


@pytest.fixture(scope="module")
def dataset(tmp_path_factory: pytest.TempPathFactory) -> Dataset:
    """Twice the same task and seeds, collected with different asset packs."""
    out = tmp_path_factory.mktemp("two_packs")
    for config, digest in DIGESTS.items():
        assets = {"pack": "builtin", "digest": digest}
        collect(out, 2, what=replace(synthetic.conditions(), config=config, assets=assets))
    return Dataset(out)


def attempts_of(monkeypatch: pytest.MonkeyPatch, hash_of_seed: str) -> list[tuple[int, str]]:
    """(seed, digest of the pack) of every simulation that is asked for from now on."""
    asked: list[tuple[int, str]] = []

    def attempt(recipe: Recipe, _: Task, pack: Pack) -> Attempt:
        asked.append((recipe.seed, pack.digest))
        states = hash_of_seed.format(recipe.seed)
        return Attempt(recipe, recording=Recording((), ActionLayout(6), hash=states))

    monkeypatch.setattr(prove, "attempt", attempt)
    return asked


def test_each_episode_is_made_with_its_own_assets(
    dataset: Dataset, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = attempts_of(monkeypatch, "{:064x}")
    monkeypatch.setattr(prove, "pack_with", Marked)
    assert prove.replayed(dataset, 99) == []
    own = [DIGESTS[episode.protocol] for episode in dataset]
    assert set(own) == set(DIGESTS.values())
    assert [digest for _, digest in asked] == own
    assert [seed for seed, _ in asked] == [episode.seed for episode in dataset]


def test_other_states_and_absent_assets_are_told(
    dataset: Dataset, monkeypatch: pytest.MonkeyPatch
) -> None:
    attempts_of(monkeypatch, "another {}")
    monkeypatch.setattr(prove, "default_pack", lambda: Marked(DIGESTS["plain"]))
    monkeypatch.setattr(prove, "pack_with", lambda _: None)
    problems = prove.replayed(dataset, 99)
    assert [problem.path for problem in problems] == [e.paths.phys_meta for e in dataset]
    for episode, problem in zip(dataset, problems, strict=True):
        text = (
            f"simulated again it gives another {episode.seed}, not state_hash {episode.seed:064x}"
        )
        assert problem.text.startswith(text)
        absent = episode.protocol == "other_assets"
        assert problem.text.endswith(", with other assets than today's") == absent


@pytest.mark.parametrize("count", [1, 2, 3])
def test_no_more_are_made_than_asked_for(
    dataset: Dataset, monkeypatch: pytest.MonkeyPatch, count: int
) -> None:
    asked = attempts_of(monkeypatch, "{:064x}")
    monkeypatch.setattr(prove, "pack_with", Marked)
    prove.replayed(dataset, count)
    assert len(asked) == count


def test_a_recipe_that_is_not_whole_is_a_problem(
    dataset: Dataset, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(_: object) -> Recipe:
        raise KeyError("seed")

    monkeypatch.setattr(prove, "pack_with", Marked)
    monkeypatch.setattr(prove.Recipe, "from_json", refuse)
    (problem,) = prove.replayed(dataset, 1)
    assert problem.text == "its recipe is not whole ('seed')"
