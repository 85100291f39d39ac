"""A recipe survives the label that stores it."""

import json
from dataclasses import replace

import pytest

from rtphys.core.errors import BadFile, UnknownName
from rtphys.physics.load import load_domain
from rtphys.spec.episode import EpisodeSpec, Recipe
from rtphys.spec.protocol import PAPER
from rtphys.spec.stored import load, stored

RECIPES = (
    EpisodeSpec("click_bell", "clean").at(3),
    EpisodeSpec("open_laptop", "phys_random", only=("friction", "table_tilt"), split="unseen").at(
        7
    ),
    EpisodeSpec(
        "stack_blocks_two",
        "phys_random_all",
        overrides={"friction": 0.2, "center_of_mass": (0.0, 0.0, 0.01), "camera_mode": "orbit"},
        ranges=load_domain("global"),
        recovery=False,
    ).at(0),
)


@pytest.mark.parametrize("recipe", RECIPES, ids=lambda recipe: recipe.task)
def test_json_and_back(recipe: Recipe) -> None:
    found = json.loads(json.dumps(stored(recipe)))
    assert load(Recipe, found, "label") == recipe
    assert stored(load(Recipe, found, "label")) == stored(recipe)


def test_the_order_of_held_values_is_no_difference() -> None:
    """JSON is stored with sorted keys, and the folder has the spec's name."""
    one = EpisodeSpec("click_bell", "clean", overrides={"object_mass": 3.0, "friction": 0.9})
    other = replace(one, overrides={"friction": 0.9, "object_mass": 3.0})
    assert one.variation == other.variation == "clean.friction=0.9.object_mass=3"
    kept = json.loads(json.dumps(stored(one), sort_keys=True))
    assert load(EpisodeSpec, kept, "label").variation == one.variation


def test_a_mistake_names_file_and_key() -> None:
    spec = stored(RECIPES[0])["spec"]
    assert isinstance(spec, dict)
    for wrong, problem in (
        ({"spec": spec}, "label: seed: field required"),
        ({"spec": {**spec, "overrides": 3}, "seed": 1}, r"label: spec\.overrides"),
        ({"spec": {**spec, "frction": 3}, "seed": 1}, r"label: spec\.frction: unexpected"),
        ({"spec": {**spec, "split": "sen"}, "seed": 1}, "did you mean 'seen'"),
    ):
        with pytest.raises(BadFile, match=problem):
            load(Recipe, wrong, "label")


def test_only_without_a_protocol_keeps_the_looks() -> None:
    """One attribute is its one-factor protocol; several are picked under nominal looks."""
    assert EpisodeSpec("click_bell").protocol == PAPER
    one = EpisodeSpec("click_bell", only=("friction",))
    assert one == EpisodeSpec("click_bell", "only_friction")
    assert EpisodeSpec("click_bell", only=("friction", "table_tilt")).protocol == "clean"
    assert EpisodeSpec("click_bell", PAPER, only=("friction",)).protocol == PAPER


def test_another_protocol_keeps_what_makes_sense_under_it() -> None:
    varied = RECIPES[2].spec
    assert varied.under("phys_random") == replace(varied, protocol="phys_random")
    plain = varied.under("clean")
    assert (plain.only, plain.overrides, plain.ranges) == (None, {}, None)
    assert plain.domain.rules == {}
    assert not plain.recovery, "what is no physics stays"


def test_a_spec_is_checked_when_it_is_made() -> None:
    with pytest.raises(UnknownName, match="did you mean 'seen'"):
        EpisodeSpec("click_bell", "clean", split="sen")
    with pytest.raises(UnknownName, match="did you mean 'global'"):
        EpisodeSpec("click_bell", "phys_random", ranges="globl")  # type: ignore[arg-type] - a name is loaded
