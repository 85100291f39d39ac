"""What must hold of every task, whoever wrote it."""

import pytest

from rtphys.assets.pack import Pack
from rtphys.core import library
from rtphys.core.poses import Pose
from rtphys.episode.generate import attempt, prepare
from rtphys.physics import disagreements
from rtphys.physics.reach import split
from rtphys.spec.episode import EpisodeSpec
from rtphys.studies.check import solves
from rtphys.task.instructions import check_templates, scene_info
from rtphys.task.spec import Task, load_task

pytestmark = pytest.mark.sim

PROTOCOLS = ("clean", "phys_random")
QUICK = ("click_bell", "grab_roller", "open_laptop")  # the others are simulated by `make test-all`
EVERY = list(library.names("tasks", None))
SIMULATED = [pytest.param(name, marks=[] if name in QUICK else pytest.mark.slow) for name in EVERY]


def layout(task: Task, seed: int) -> list[tuple[object, ...]]:
    """Props as plain values, since poses do not compare."""
    return [
        tuple(
            (v.p.tolist(), v.q.tolist()) if isinstance(v, Pose) else v for v in vars(prop).values()
        )
        for prop in task.props(seed)
    ]


@pytest.mark.parametrize("name", EVERY)
def test_a_layout_depends_on_the_seed_alone(name: str) -> None:
    task = load_task(name)
    layouts = [layout(task, seed) for seed in range(8)]
    assert layouts == [layout(load_task(name), seed) for seed in range(8)]
    assert any(other != layouts[0] for other in layouts[1:]), "every seed gives the same"


@pytest.mark.parametrize("name", EVERY)
def test_what_a_task_states_is_whole(name: str) -> None:
    task = load_task(name)
    assert task.doc, "the docstring says what the task is"
    assert 0 < task.step_limit <= 2000
    check_templates(task.sentences(), task.info, name)
    assert set(scene_info(task, 0)) == {f"{{{letter}}}" for letter in task.info}
    names = [prop.name for prop in task.props(0)]
    assert len(names) == len(set(names))
    assert task.condition(task.props(0)).text


@pytest.mark.parametrize("protocol", PROTOCOLS)
@pytest.mark.parametrize("name", EVERY)
def test_draws_are_in_force(name: str, protocol: str, pack: Pack) -> None:
    task = load_task(name)
    for seed in range(2):
        instance = prepare(EpisodeSpec(name, protocol).at(seed), task, pack)
        assert disagreements(instance.world, instance.physics) == []
        drawn_for_all = {key for key in instance.physics.varied if not split(key)[1]}
        assert bool(drawn_for_all) == (protocol != "clean")


@pytest.mark.parametrize("name", SIMULATED)
def test_a_seed_gives_the_same_states_twice(name: str, pack: Pack) -> None:
    task, recipe = load_task(name), EpisodeSpec(name, "phys_random").at(0)
    first, other, again = (
        attempt(r, task, pack) for r in (recipe, EpisodeSpec(name, "phys_random").at(1), recipe)
    )
    assert (first.reason, first.detail) == (again.reason, again.detail)
    if first.recording is not None and again.recording is not None:
        assert first.recording.hash == again.recording.hash
        assert other.recording is None or other.recording.hash != first.recording.hash


@pytest.mark.parametrize("name", SIMULATED)
def test_the_expert_solves_a_nominal_seed_by_moving(name: str, pack: Pack) -> None:
    task = load_task(name)
    tried = [attempt(EpisodeSpec(name, "clean").at(seed), task, pack) for seed in range(2)]
    solved = [a for a in tried if a.accepted]
    assert solved, [(a.reason, a.detail) for a in tried]
    for one in solved:
        assert one.outcome is not None
        assert one.outcome.first_success is not None
        assert one.outcome.first_success > 0.1, "it held before anyone acted"


@pytest.mark.parametrize("protocol", PROTOCOLS)
@pytest.mark.parametrize("name", SIMULATED)
def test_nothing_comes_of_idling(name: str, protocol: str, pack: Pack) -> None:
    for seed in range(2):
        assert not solves(EpisodeSpec(name, protocol).at(seed), load_task(name), pack, "idle")
