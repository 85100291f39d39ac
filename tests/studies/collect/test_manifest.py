"""Manifests and sweeps: one description of what to collect, the plans of many task datasets."""

from dataclasses import replace
from pathlib import Path

import pytest
from collecting import PLAN

from rtphys.core import library
from rtphys.core.errors import BadFile, BadValue, UnknownName
from rtphys.data.layout import TaskDataset
from rtphys.physics.load import domain_for_task
from rtphys.spec.collection import CollectionSpec
from rtphys.spec.episode import EpisodeSpec
from rtphys.spec.recording import RecordingSpec
from rtphys.spec.sweep import swept
from rtphys.studies.requests import find_collection, read_specs, specs_for
from rtphys.task.spec import task_names


def plans(text: str, tmp_path: Path) -> tuple[CollectionSpec, ...]:
    path = tmp_path / "own.yaml"
    path.write_text(text)
    return read_specs(path)


# ---- what ships ----------------------------------------------------------------------------------


def test_the_training_set_is_the_papers() -> None:
    plans = read_specs(find_collection("training_v1"))
    assert [plan.episode.task for plan in plans] == task_names()
    assert len(plans) == 50
    found = {(plan.episodes, plan.episode.protocol, plan.twin) for plan in plans}
    assert found == {(100, "phys_random_all", None)}
    domains = [plan.episode.domain.name for plan in plans]
    assert domains == [domain_for_task(plan.episode.task).name for plan in plans]
    assert sum(name != "global" for name in domains) == 9


def test_the_manifest_for_smoke_can_be_read() -> None:
    protocols = [plan.episode.protocol for plan in read_specs(find_collection("smoke"))]
    assert list(dict.fromkeys(protocols)) == ["phys_random_all", "clean"]


def test_tables_of_measurements_are_no_manifests() -> None:
    with pytest.raises(UnknownName, match=r"unknown manifest 'costs'.*Known: smoke, training_v1$"):
        find_collection("costs")


# ---- a user's own --------------------------------------------------------------------------------

OWN = """
what: frictions
collect:
  - tasks: [click_*, lift_pot]
    episodes: 3
    protocol: phys_random
    first_seed: 7
    only: [friction]
    set: {object_mass: 0.2, center_of_mass: [0, 0, 0.01]}
    cameras: [head]
    layout: legacy
    max_attempts: 9
  - tasks: [lift_pot]
    episodes: 2
    sweep: friction=0.1,0.2
"""


def test_a_run_is_what_the_options_would_be(tmp_path: Path) -> None:
    *first, low, high = plans(OWN, tmp_path)
    spec = EpisodeSpec(
        protocol="phys_random",
        only=("friction",),
        overrides={"object_mass": 0.2, "center_of_mass": (0.0, 0.0, 0.01)},
    )
    recording = RecordingSpec(cameras=("head",), layout="legacy")
    template = CollectionSpec(spec, recording, episodes=3, first_seed=7, max_attempts=9)
    tasks = ("click_alarmclock", "click_bell", "lift_pot")
    assert tuple(first) == specs_for(template, tasks)
    assert [low.name, high.name] == [f"phys_random_all.friction={mu}" for mu in (0.1, 0.2)]
    assert {(plan.episode.task, plan.episodes) for plan in (low, high)} == {("lift_pot", 2)}


RUN = "collect: [{tasks: [lift_pot], episodes: 1%s}]"
WRONG = {
    "colect: []": (UnknownName, "did you mean 'collect'"),
    "what: nothing": (BadFile, "collect: a list of runs"),
    "collect: []": (BadFile, "collect: a list of runs"),
    "collect: 3": (BadFile, "collect: a list of runs"),
    "collect: [{tasks: [lift_pot]}]": (BadFile, "collect.0.episodes"),
    "collect: [{tasks: [lift_pt], episodes: 1}]": (UnknownName, "did you mean 'lift_pot'"),
    "collect: [{tasks: [], episodes: 1}]": (BadFile, "collect.0.tasks"),
    RUN % ", episods: 2": (
        UnknownName,
        r"own.yaml: collect.0: unknown key 'episods'; did you mean 'episodes'",
    ),
    RUN % ", made_by: merge": (UnknownName, "unknown key 'made_by'"),
    RUN % ", policy: pi0": (UnknownName, "unknown key 'policy'"),
    RUN % ", task: lift_pot": (UnknownName, "unknown key 'task'"),
    RUN % ", senses: [depth]": (UnknownName, "did you mean 'sense'"),
    RUN % ", split: sen": (BadFile, "did you mean 'seen'"),
    RUN % ", set: 3": (BadFile, r"episode\.overrides"),
    RUN % ", first_seed: -1": (BadFile, r"collect.0: first_seed"),
    "collect: [{tasks: [lift_pot], episodes: many}]": (BadFile, "collect.0: episodes"),
    RUN % ", episodes: 2": (BadFile, "line 1, column 44: key 'episodes' occurs twice"),
    "collect: [{tasks: [lift_pot], episodes: 1000000000000}]": (
        BadFile,
        "collect.0: episodes = 1000000000000",
    ),
    RUN % ", domain: globl": (BadFile, "did you mean 'global'"),
    RUN % ", recovery: perhaps": (BadFile, "collect.0: episode.recovery"),
    RUN % ", layout: natve": (BadFile, "collect.0.*did you mean 'native'"),
    RUN % ", set: {frction: 1}": (UnknownName, "did you mean 'friction'"),
    RUN % ", sweep: friction": (BadValue, "key=value,value"),
}


@pytest.mark.parametrize("text", WRONG)
def test_a_mistake_is_named_with_its_place(text: str, tmp_path: Path) -> None:
    kind, told = WRONG[text]
    with pytest.raises(kind, match=told):
        plans(text, tmp_path)


def test_every_manifest_that_collects_has_tasks_that_exist() -> None:
    for path in library.names("manifests").values():
        if "collect" in library.read_yaml(path):
            assert read_specs(path)


# ---- sweeps --------------------------------------------------------------------------------------


def test_each_value_is_a_plan_with_a_folder_of_its_own() -> None:
    plans = swept(PLAN, "friction=0.05, 0.4")
    assert [plan.name for plan in plans] == [
        "phys_random.friction=0.05",
        "phys_random.friction=0.4",
    ]
    assert [plan.episode.overrides for plan in plans] == [{"friction": 0.05}, {"friction": 0.4}]
    assert len({TaskDataset.of(Path(), plan).name for plan in plans}) == 2


def test_only_the_swept_attribute_differs() -> None:
    drawn = [dict(plan.episode.draw(7)) for plan in swept(PLAN, "friction=0.05,0.4")]
    assert [d.pop("friction") for d in drawn] == [0.05, 0.4]
    assert drawn[0] == drawn[1]


def test_what_is_swept_varies_where_little_else_does() -> None:
    narrow = replace(PLAN, episode=replace(PLAN.episode, only=("object_mass",)))
    (plan,) = swept(narrow, "friction=0.05")
    assert plan.episode.only == ("object_mass", "friction")


def test_every_task_is_swept() -> None:
    plans = specs_for(PLAN, ("lift_pot", "click_bell"), "friction=0.1,0.2")
    assert len({TaskDataset.of(Path(), plan).name for plan in plans}) == 4


def test_a_vector_is_swept_with_semicolons() -> None:
    plans = swept(PLAN, "center_of_mass=0,0,0;0,0,0.01")
    held = [plan.episode.overrides["center_of_mass"] for plan in plans]
    assert held == [(0, 0, 0), (0, 0, 0.01)]


def test_what_is_held_is_not_swept() -> None:
    held = replace(PLAN, episode=replace(PLAN.episode, overrides={"friction": 0.3}))
    with pytest.raises(BadValue, match=r"sweep = 'friction' .*held at a value already"):
        swept(held, "friction=0.1,0.2")
