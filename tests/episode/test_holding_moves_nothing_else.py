"""`--set` of one attribute leaves the values of all others as they were drawn."""

import pytest

from rtphys.assets.pack import default_pack
from rtphys.episode.generate import Instance, prepare
from rtphys.physics import Physics, attributes
from rtphys.physics.distribution import Distribution, SameAs, extremes
from rtphys.physics.hull import Solid, inside
from rtphys.physics.values import Value
from rtphys.spec.episode import EpisodeSpec
from rtphys.task.spec import load_task, task_names

pytestmark = pytest.mark.sim

CAMERA = {"camera_distance", "camera_angle"}  # a camera mode has one of them: the other is 0
SCALE = "object_scale"
DRAWN = "phys_random"


def instance(task: str, seed: int, held: dict[str, Value]) -> Instance:
    recipe = EpisodeSpec(task, DRAWN, overrides=held).at(seed)
    return prepare(recipe, load_task(task), default_pack())


def values(task: str, key: str) -> list[Value]:
    """Values to hold an attribute at: the ends of its range."""
    if attributes()[key].size > 1:
        return [(0.0, 0.0, 0.001)]
    rules = EpisodeSpec(task, DRAWN).rules.domain.rules
    rule: Distribution = rules[key]
    if isinstance(rule, SameAs):
        rule = rules[rule.source]
    return [v for v in dict.fromkeys(extremes(rule)) if key not in CAMERA or v]


def moved(physics: Physics, drawn: Physics, key: str) -> set[str]:
    others = attributes().keys() - {key}
    changed = {k for k in others if physics[k] != drawn[k]}
    return {k for k in changed if not (key in CAMERA and k in CAMERA and physics[k] == 0.0)}


# Objects so thin that the scale decided a draw: 10 of 40 seeds of the first.
@pytest.mark.parametrize("task", ["place_phone_stand", "turn_switch", "open_laptop"])
def test_holding_an_attribute_moves_no_other(task: str) -> None:
    for seed in range(1, 9):
        drawn = instance(task, seed, {}).physics
        for key in attributes() if seed < 3 else [SCALE]:
            for value in values(task, key):
                held = instance(task, seed, {key: value}).physics
                assert held[key] == value
                assert not moved(held, drawn, key), (seed, key, value)


def test_what_a_held_size_does_not_hold_is_rejected() -> None:
    with pytest.raises(Exception, match="lies outside a body"):
        for seed in range(1, 30):
            instance("move_playingcard_away", seed, {SCALE: 0.5})


@pytest.mark.slow
@pytest.mark.parametrize("task", task_names())
def test_in_every_task(task: str) -> None:
    """Only the scale changes the bodies in which the centre of mass must lie."""
    for seed in range(1, 41):
        whole = instance(task, seed, {})
        solids = {b.name: Solid(b.hull, b.nominal_com) for b in whole.world.bodies}
        smallest = whole.domain.smallest_scale / whole.world.blueprint.object_scale
        for key in attributes():
            for value in values(task, key):
                if key == SCALE:
                    held = instance(task, seed, {key: value}).physics
                else:
                    spec = EpisodeSpec(task, DRAWN, overrides={key: value})
                    held = spec.draw(seed, inside(solids, smallest))
                assert not moved(held, whole.physics, key), (seed, key, value)
