"""An audit repeats demonstrations: what it says of a true label, and of false ones."""

from pathlib import Path
from typing import Any

import pytest
from audited import audited, stored

from rtphys.assets.pack import default_pack
from rtphys.data.schema import PhysMeta
from rtphys.episode.assemble import assemble, other_restitution
from rtphys.episode.audit import repeated, watched
from rtphys.episode.generate import Attempt, Instance, attempt, prepare
from rtphys.physics import Physics
from rtphys.spec.episode import EpisodeSpec
from rtphys.task.spec import load_task

pytestmark = pytest.mark.sim
CUP, SWITCH = ("place_empty_cup", 201), ("turn_switch", 3)


def tried(task: str, seed: int) -> Attempt:
    recipe = EpisodeSpec(task, "phys_random_all").at(seed)
    found = attempt(recipe, load_task(task), default_pack(), happened=True)
    assert found.accepted
    return found


def label(of: Attempt, acted: bool) -> PhysMeta:
    assert of.instance is not None and of.recording is not None
    meta = stored(of.instance, state_hash=of.recording.hash)
    restitution = meta.attributes["restitution"].model_copy(update={"acted": acted})
    attributes = {**meta.attributes, "restitution": restitution}
    return meta.model_copy(update={"attributes": attributes})


@pytest.mark.parametrize(("name", "impact"), [(CUP, True), (SWITCH, False)])
def test_what_did_not_act_leaves_every_bit(name: tuple[str, int], impact: bool) -> None:
    """A cup that is let go bounces; nothing does where a switch is pressed."""
    found = tried(*name)
    assert found.recording is not None and found.recording.happened is not None
    assert found.recording.happened.impact == impact
    assert not repeated(label(found, impact), default_pack())
    problems = repeated(label(found, False), default_pack())
    assert bool(problems) == impact
    assert all("restitution: the label says that it did not act" in one for one in problems)


DROPPED = '''
"""Lift a hand while a block lies where it fell."""
from rtphys.task import *


def layout(draw):
    at = Pose((0.15, -0.1, 0.805))
    yield Box(name="block", pose=at, half_size=(0.02, 0.02, 0.02), resting=False)


def script(robot):
    robot.do(robot.right.shift(z=0.02))


task = Task(layout=layout, script=script, success=on_table("block"), step_limit=50)
'''


def acted(task: str, seed: int, **held: float) -> tuple[object, str]:
    """What the label says of restitution, and the hash of the states."""
    recipe = EpisodeSpec(task, "clean", overrides=held).at(seed)
    found = attempt(recipe, load_task(task), default_pack(), happened=True)
    meta: Any = assemble(found, default_pack()).phys_meta
    return meta["attributes"]["restitution"]["acted"], meta["state_hash"]


def test_what_falls_while_the_world_settles_has_met_something(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nobody watches then, and the block comes to lie elsewhere under another restitution."""
    (tmp_path / "tasks").mkdir()
    (tmp_path / "tasks" / "dropped.py").write_text(DROPPED)
    monkeypatch.setenv("RTPHYS_LIBRARY", str(tmp_path))
    assert acted("dropped", 0)[0] is True
    assert acted("dropped", 0)[1] != acted("dropped", 0, restitution=0.5)[1]


@pytest.mark.parametrize(
    ("spec", "seed"),
    [
        # From 1 mm nothing falls fast enough, but a shoe turns, and its toe is faster.
        (EpisodeSpec("place_shoe", "clean"), 9),
        # Two blocks in grips: their poses hardly change.
        pytest.param(EpisodeSpec("stack_blocks_two", "phys_random_all"), 4, marks=pytest.mark.slow),
        # A finger meets a heavy lid.
        pytest.param(
            EpisodeSpec("open_laptop", "phys_random_all", embodiment="franka-panda"),
            8,
            marks=pytest.mark.slow,
        ),
    ],
    ids=lambda value: getattr(value, "task", value),
)
def test_an_impact_that_nobody_saw_is_found(spec: EpisodeSpec, seed: int) -> None:
    recipe = spec.at(seed)
    found = attempt(recipe, load_task(spec.task), default_pack(), happened=True)
    assert found.recording is not None and found.recording.happened is not None
    assert not found.recording.happened.impact
    meta: Any = assemble(found, default_pack()).phys_meta
    assert meta["attributes"]["restitution"]["acted"] is True


def test_every_object_gets_another_restitution() -> None:
    physics = Physics({"friction": 0.5, "restitution": 0.2, "restitution@block": 0.0})
    assert other_restitution(physics) == {"restitution": 0.0, "restitution@block": 0.5}


def test_another_demonstration_is_told() -> None:
    meta = label(tried(*SWITCH), False).model_copy(update={"state_hash": "0" * 64})
    (problem,) = repeated(meta, default_pack())
    assert problem == "the expert demonstrates it otherwise now: other states"


def test_fingers_do_not_sink_into_what_is_light() -> None:
    """A slice of bread of 2 g between fingers that press with 39 N."""
    recipe = EpisodeSpec("place_bread_skillet", "phys_random_all").at(4)
    tried, rollout, seen = watched(recipe, default_pack())
    assert rollout.finish().held
    bread = tried.world.object("bread").bodies[0]
    assert bread.mass < 0.0025
    assert not seen.problems()


def instance() -> Instance:
    recipe = EpisodeSpec("place_container_plate", "phys_random_all").at(1)
    return prepare(recipe, load_task(recipe.task), default_pack())


def test_what_lies_in_the_table_at_the_start_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """A world in which a plate is built 4 mm too low."""
    one = instance()
    assert not audited(one, default_pack()).problems
    rebuild = prepare

    def lower(*given: object) -> Instance:
        made = rebuild(*given)  # type: ignore[arg-type]
        plate = made.world.object("plate").root
        pose = plate.entity_pose
        pose.set_p(pose.p - [0.0, 0.0, 0.004])
        plate.entity.set_pose(pose)
        return made

    monkeypatch.setattr("rtphys.episode.audit.prepare", lower)
    (problem,) = audited(one, default_pack()).problems
    assert problem == "plate lies 4.0 mm deep in table at the start"
