"""Physics and look of every label are drawn again from its seed; where not, the check says so."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest
from audited import stored

from rtphys.assets.pack import default_pack
from rtphys.data.check_draws import DrawCheck
from rtphys.data.schema import PhysMeta, VisualLabel
from rtphys.episode.generate import prepare
from rtphys.spec.collection import CollectionSpec, Resolved, TaskHeader
from rtphys.spec.episode import EpisodeSpec
from rtphys.spec.protocol import OFFICIAL, VisualRandomization
from rtphys.task.spec import load_task

pytestmark = pytest.mark.sim
SEED = 6  # with pictures on table and wall, and clutter
SPEC = EpisodeSpec("click_bell", "official_random")


def check(spec: EpisodeSpec = SPEC, **changes: Any) -> DrawCheck:
    """Of a manifest that holds this spec."""
    look, task, pack = spec.visual(), load_task("click_bell"), default_pack()
    visual = None if look is None else look.to_json()
    own = {"task": task.digest}, {"digest": pack.digest}
    resolved = Resolved(spec.domain.to_json(), visual, *own)
    header = TaskHeader(CollectionSpec(spec), replace(resolved, **changes))
    return DrawCheck(SimpleNamespace(spec=header.spec, resolved=header.resolved, header=header))  # type: ignore[arg-type] - a manifest's entry counts too


def label(spec: EpisodeSpec = SPEC, **changes: object) -> PhysMeta:
    """As `collect` writes it, with a look that is changed."""
    meta = stored(prepare(spec.at(SEED), load_task("click_bell"), default_pack()))
    assert meta.visual is not None
    visual = VisualLabel.model_validate({**meta.visual.model_dump(), **changes})
    return meta.model_copy(update={"visual": visual})


def test_the_true_label_is_sound() -> None:
    assert (check().gap, check().problems(label())) == ("", [])
    unseen = replace(SPEC, split="unseen")
    assert check(unseen).problems(label(unseen)) == []
    assert check(unseen).problems(label()) != []


def test_another_picture_or_piece_of_the_same_split_is_found() -> None:
    true = label().visual
    assert true is not None
    for key, place in (("table_texture", "table"), ("wall_texture", "wall")):
        others = default_pack().textures("seen", place)
        own = getattr(true, key)
        assert own is not None
        other = next(f"seen/{name}" for name in others if f"seen/{name}" != own)
        (text,) = check().problems(label(**{key: other}))
        assert text == f"visual.{key} is {other!r}, the seed gives {own!r}"
        assert check().problems(label(**{key: None})) != []
    pieces = true.clutter
    assert pieces
    for wrong in (pieces[:-1], [{**pieces[0], "model": 99}, *pieces[1:]]):
        (text,) = check().problems(label(clutter=wrong))
        assert text.startswith("visual.clutter is ")


def test_lights_need_no_pack() -> None:
    without = check(assets={"digest": "0" * 64})
    assert "the asset pack 000000000000 is not on this machine" in without.gap
    assert without.problems(label()) == []
    for changes in ({"flickers": True}, {"lights": {"ambient": [0.5, 0.5, 0.5]}}):
        (text,) = without.problems(label(**changes))
        assert "the seed gives" in text


def test_another_version_of_the_task_is_told() -> None:
    assert "is another version of the task" in check(versions={"task": "0" * 16}).gap


@pytest.mark.parametrize("rules", [None, replace(OFFICIAL, clutter=2)])
def test_rules_that_are_not_those_of_the_collection(rules: VisualRandomization | None) -> None:
    visual = None if rules is None else rules.to_json()
    assert check(visual=visual).problems(label()) != []
