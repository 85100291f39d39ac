"""A recipe survives the label that stores it."""

import json

import pytest

from rtphys.physics.load import load_domain
from rtphys.setting.setting import Recipe, Setting

RECIPES = (
    Setting("click_bell").at(3),
    Setting("open_laptop", "phys_random", only=("friction", "table_tilt"), split="unseen").at(7),
    Setting(
        "stack_blocks_two",
        "phys_random_all",
        overrides={"friction": 0.2, "center_of_mass": (0.0, 0.0, 0.01), "camera_mode": "orbit"},
        ranges=load_domain("global"),
        recovery=False,
    ).at(0),
)


@pytest.mark.parametrize("recipe", RECIPES, ids=lambda recipe: recipe.task)
def test_json_and_back(recipe: Recipe) -> None:
    stored = json.loads(json.dumps(recipe.to_json()))
    assert Recipe.from_json(stored) == recipe
    assert Recipe.from_json(stored).to_json() == recipe.to_json()


@pytest.mark.parametrize("key", ["task", "seed", "protocol", "embodiment"])
def test_a_missing_key_is_named(key: str) -> None:
    stored = RECIPES[0].to_json()
    del stored[key]
    with pytest.raises(KeyError, match=key):
        Recipe.from_json(stored)
