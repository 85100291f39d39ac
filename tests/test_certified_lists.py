"""The certified lists that come with rtphys: they are of this version's tasks, domains and pack."""

from pathlib import Path

import pytest
from evaluations import FINGERPRINT

from rtphys import doctor
from rtphys.assets.pack import Pack
from rtphys.core import library
from rtphys.episode.fingerprint import fingerprint_of, packages
from rtphys.episode.generate import attempt
from rtphys.physics import attributes
from rtphys.results.instances import BENCHMARK, FIRST_SEED, InstanceList, read_lists
from rtphys.spec.episode import EpisodeSpec
from rtphys.studies.evaluate import certified, other_versions
from rtphys.studies.requests import CertificationRun, CertificationSpec, EvaluationRun
from rtphys.task.spec import load_task

FOLDER = library.bundled() / "manifests"
Lists = dict[str, dict[str, InstanceList]]  # by protocol and task


def lists_in(folder: str) -> Lists:
    return {path.stem: read_lists(path) for path in sorted((FOLDER / folder).glob("*.jsonl"))}


LISTS, SUITES = lists_in(BENCHMARK), {suite: lists_in(suite) for suite in library.suites()}
CELLS = [
    (protocol, task)
    for of in (LISTS, *SUITES.values())
    for protocol, lists in of.items()
    for task in lists
]
QUICK = ("click_alarmclock", "place_shoe")


@pytest.fixture(scope="module")
def other_meshes() -> bool:
    """Whether this machine's packages may build other meshes."""
    return bool(doctor.other_versions())


MAIN = ("clean", "official_random", "phys_random", "phys_random_all")
CERTIFIED = 100  # feasible instances of each list of these
NARROWER = {"severity": 25, "only": 20}  # of each other list, by the kind of its protocol


def test_every_protocol_has_its_list() -> None:
    narrower = {
        *(f"only_{key}" for key in attributes()),
        "severity_25",
        "severity_50",
        "severity_100",
    }
    assert LISTS.keys() == {*MAIN, *narrower}


@pytest.mark.parametrize("protocol", MAIN)
def test_fifty_tasks_have_as_many_each(protocol: str) -> None:
    lists = LISTS[protocol]
    assert len(lists) >= 50  # a new task may be certified later, but then under every protocol
    assert lists.keys() == {task for of in LISTS.values() for task in of}
    assert min(len(found.feasible) for found in lists.values()) >= CERTIFIED


@pytest.mark.parametrize("protocol", sorted(LISTS.keys() - {*MAIN}))
def test_narrower_protocols_have_every_task_on_which_they_act(protocol: str) -> None:
    lists, tasks = LISTS[protocol], tuple(sorted({task for of in LISTS.values() for task in of}))
    acting = CertificationRun(tasks, (protocol,), Path("bench")).specs(CertificationSpec())
    assert lists.keys() == {spec.episode.task for spec in acting}
    least = NARROWER[protocol.split("_")[0]]
    assert min(len(found.feasible) for found in lists.values()) >= least


@pytest.mark.parametrize("suite", SUITES)
def test_a_suite_has_lists_of_its_own(suite: str) -> None:
    lists = SUITES[suite]
    assert lists.keys() == {"clean", "phys_random", "phys_random_all"}
    for of in lists.values():
        assert of.keys() == set(library.suites()[suite])
        assert min(len(found.feasible) for found in of.values()) >= CERTIFIED


def shipped(protocol: str, task: str) -> InstanceList:
    return next(
        of[protocol][task] for of in (LISTS, *SUITES.values()) if task in of.get(protocol, {})
    )


@pytest.mark.parametrize(("protocol", "task"), CELLS)
def test_no_list_is_stale(protocol: str, task: str, pack: Pack, other_meshes: bool) -> None:
    run, loaded = EvaluationRun((task,), (protocol,)), load_task(task)
    now = fingerprint_of(loaded, protocol, pack)
    if other_meshes:  # all else must hold
        assets = shipped(protocol, task).fingerprint.assets
        now = now.model_copy(update={"assets": assets})
    found = certified(run, protocol, task, now)
    seeds = [one.seed for one in found.instances]
    assert seeds == [*range(FIRST_SEED, FIRST_SEED + len(seeds))]  # every seed tried has its row
    assert protocol not in MAIN or all(one.replay is not None for one in found.feasible)


@pytest.mark.sim
@pytest.mark.parametrize("protocol", MAIN)
@pytest.mark.parametrize("task", QUICK)
def test_the_expert_solves_the_first_instance_bit_for_bit(
    task: str, protocol: str, pack: Pack
) -> None:
    first = LISTS[protocol][task].feasible[0]
    generated = attempt(EpisodeSpec(task, protocol).at(first.seed), load_task(task), pack)
    assert generated.accepted
    assert generated.recording is not None and generated.recording.hash.startswith(first.state)


@pytest.mark.sim
@pytest.mark.slow
@pytest.mark.parametrize(("protocol", "task"), CELLS)
def test_the_expert_still_moves_as_listed(protocol: str, task: str, pack: Pack) -> None:
    """A change of planner, control or simulation shows here, though no task file changed."""
    first = shipped(protocol, task).feasible[0]
    recipe = EpisodeSpec(task, protocol).at(first.seed)
    recording = attempt(recipe, load_task(recipe.task), pack).recording
    assert recording is not None and recording.hash.startswith(first.state)


def test_other_versions_of_packages_are_named_but_allowed() -> None:
    def clauses(versions: dict[str, str]) -> list[str]:
        return other_versions(FINGERPRINT.model_copy(update={"versions": versions}))

    now = packages()
    assert clauses({**now, "python": "3.9.1", "rtphys": "0.0.1"}) == []
    assert clauses({**now, "numpy": "1.0"}) == [f"numpy was 1.0, now {now['numpy']}"]
    assert clauses({}) == []
