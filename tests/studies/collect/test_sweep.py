"""A sweep: the same seeds, one attribute held at each value in turn."""

from pathlib import Path

import pytest

from rtphys.assets.pack import default_pack
from rtphys.core.errors import BadValue, UnknownName
from rtphys.studies.collect import CollectPlan, swept
from rtphys.task.spec import load_task

PLAN = CollectPlan(("click_bell",), 2, Path("data"), first_seed=5, protocol="phys_random")


def test_each_value_is_a_plan_with_a_leaf_of_its_own() -> None:
    plans = swept(PLAN, "friction=0.05, 0.4")
    assert [plan.config for plan in plans] == [
        "phys_random.friction=0.05",
        "phys_random.friction=0.4",
    ]
    assert [plan.overrides for plan in plans] == [{"friction": 0.05}, {"friction": 0.4}]
    task, pack = load_task("click_bell"), default_pack()
    leaves = {plan.conditions(task, pack).task_dataset(plan.out).name for plan in plans}
    assert len(leaves) == 2


def test_only_the_swept_attribute_differs() -> None:
    drawn = []
    for plan in swept(PLAN, "friction=0.05,0.4"):
        recipe = plan.recipe("click_bell", 7)
        drawn.append(dict(recipe.domain().sample(7, recipe.only, recipe.overrides)))
    assert [d.pop("friction") for d in drawn] == [0.05, 0.4]
    assert drawn[0] == drawn[1]


def test_a_vector_is_swept_with_semicolons() -> None:
    plans = swept(PLAN, "center_of_mass=0,0,0;0,0,0.01")
    assert [plan.overrides["center_of_mass"] for plan in plans] == [(0, 0, 0), (0, 0, 0.01)]


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("friction", BadValue),
        ("friction=", BadValue),
        ("friction=0.1,0.1", BadValue),
        ("friction=0.1,-3", BadValue),
        ("frction=0.1", UnknownName),
    ],
)
def test_what_no_sweep_is(text: str, error: type[Exception]) -> None:
    with pytest.raises(error):
        swept(PLAN, text)
