"""Masses of the tasks' objects, as docs/masses.md shows them."""

import masses
import pytest

import results
from rtphys.assets.pack import default_pack
from rtphys.core.poses import Pose
from rtphys.task.props import Ball, Box, Mesh

pytestmark = pytest.mark.sim

HERE = Pose((0, 0, 0))


def test_a_push_measures_what_a_thing_weighs() -> None:
    box = Box(name="x", pose=HERE, half_size=(0.01, 0.02, 0.05), density=700.0)
    ball = Ball(name="x", pose=HERE, radius=0.008, density=1000.0)
    can = Mesh(name="x", pose=HERE, category="071_can", model=0, mass_kg=0.123)
    mark = Box(name="x", pose=HERE, half_size=(0.01, 0.02, 0.0005), visual_only=True)
    pack = default_pack()
    assert masses.weigh(box, pack) == pytest.approx([700 * 8e-5])
    assert masses.weigh(ball, pack) == pytest.approx([1000 * 4.18879 * 0.008**3])
    assert masses.weigh(can, pack) == pytest.approx([0.123])
    assert masses.weigh(mark, pack) == []


@pytest.mark.parametrize("task", ["beat_block_hammer", "put_object_cabinet", "place_can_basket"])
def test_what_is_published_is_what_things_weigh(task: str) -> None:
    found: dict[str, list[float]] = {}
    for name, prop in masses.objects(task).items():
        parts = masses.weigh(prop, default_pack())
        found.setdefault(name.partition(" ")[0], []).extend(parts)
    shown = {kind: of[task] for kind, of in results.load("masses").items() if task in of}
    assert shown == {
        kind: [len(parts), *(pytest.approx(f(parts), rel=0.006) for f in (min, max))]
        for kind, parts in found.items()
        if parts
    }


def test_masses_of_robotwin_are_of_things_that_are_weighed() -> None:
    """A name with a mistake in it would leave the object at RoboTwin's 10 g."""
    measured = results.load("masses")
    named = [(kind, task) for task, kinds in masses.THEIRS.items() for kind in kinds]
    assert [pair for pair in named if pair[1] not in measured.get(pair[0], {})] == []
    of_fifty = {task for by_task in measured.values() for task in by_task}
    assert of_fifty >= {*masses.ALL_FIFTY_GRAMS}
    assert masses.theirs("beat_block_hammer", "020_hammer") == 0.001
    assert masses.theirs("stack_blocks_two", "box") == 0.01
