"""Manifests that say what to collect, and what they will take."""

import re
from dataclasses import fields
from pathlib import Path

import pytest
from typer.testing import CliRunner

from rtphys.cli.main import app
from rtphys.core import library
from rtphys.core.errors import BadFile, BadValue, UnknownName
from rtphys.data.schema_collect import CollectionRun
from rtphys.physics.load import domain_for_task
from rtphys.studies.collect import CollectPlan, estimate, find_collection, plans_of
from rtphys.studies.collect.measure import Measured
from rtphys.task.spec import task_names

HOW = CollectPlan((), 1, Path("data"), workers=2)


def plans(text: str, tmp_path: Path) -> tuple[CollectPlan, ...]:
    path = tmp_path / "own.yaml"
    path.write_text(text)
    return plans_of(path, HOW)


# ---- what ships ----------------------------------------------------------------------------------


def test_the_training_set_is_the_papers() -> None:
    (plan,) = plans_of(find_collection("training_v1"), HOW)
    assert list(plan.tasks) == task_names()
    assert len(plan.tasks) == 50
    assert (plan.episodes, plan.protocol, plan.twin) == (100, "phys_random_all", None)
    domains = [plan.recipe(task, 0).domain().name for task in plan.tasks]
    assert domains == [domain_for_task(task).name for task in plan.tasks]
    assert sum(name != "global" for name in domains) == 9


def test_the_manifest_for_smoke_can_be_read() -> None:
    assert [plan.protocol for plan in plans_of(find_collection("smoke"), HOW)] == [
        "phys_random_all",
        "clean",
    ]


def test_a_run_can_say_all_that_decides_what_is_collected() -> None:
    """What it cannot say is about this machine, or has another name."""
    here = {"out", "assets", "fallback", "shader", "workers", "runner", "address", "shard"}
    here |= {"resume", "limits", "config", "twin_of"}
    renamed = {"overrides": "set", "ranges": "domain", "most_attempts": "max_attempts"}
    said = {renamed.get(f.name, f.name) for f in fields(CollectPlan) if f.name not in here}
    assert said | {"sweep"} == CollectionRun.model_fields.keys()


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
    first, *swept = plans(OWN, tmp_path)
    assert first.tasks == ("click_alarmclock", "click_bell", "lift_pot")
    assert (first.episodes, first.first_seed, first.most_attempts) == (3, 7, 9)
    assert (first.protocol, first.only, first.layout) == ("phys_random", ("friction",), "legacy")
    assert first.overrides == {"object_mass": 0.2, "center_of_mass": (0.0, 0.0, 0.01)}
    assert (first.cameras, first.workers) == (("head",), 2)
    assert [plan.config for plan in swept] == ["clean.friction=0.1", "clean.friction=0.2"]


RUN = "collect: [{tasks: [lift_pot], episodes: 1%s}]"
WRONG = {
    "colect: []": (UnknownName, "did you mean 'collect'"),
    "what: nothing": (BadFile, "collect: field required"),
    "collect: []": (BadFile, "collect: list should have at least 1 item"),
    "collect: 3": (BadFile, "collect: input should be a valid list"),
    "collect: [{tasks: [lift_pot]}]": (BadFile, "collect.0.episodes: field required"),
    "collect: [{tasks: [lift_pt], episodes: 1}]": (UnknownName, "did you mean 'lift_pot'"),
    "collect: [{tasks: [], episodes: 1}]": (BadFile, "collect.0.tasks"),
    RUN % ", episods: 2": (UnknownName, r"own.yaml: .*collect.0 .*did you mean 'episodes'"),
    RUN % ", first_seed: -1": (BadFile, "collect.0.first_seed"),
    RUN % ", episodes: many": (BadFile, "collect.0.episodes"),
    RUN % ", domain: globl": (UnknownName, "did you mean 'global'"),
    RUN % ", recovery: perhaps": (BadFile, "collect.0.recovery"),
    RUN % ", layout: natve": (BadFile, "collect.0.layout"),
    RUN % ", set: {frction: 1}": (UnknownName, "did you mean 'friction'"),
    RUN % ", sweep: friction": (BadValue, "key=value,value"),
    "collect: [{tasks: [lift_pot, lift_pot], episodes: 1}, {tasks: [lift_pot], episodes: 2}]": (
        BadFile,
        "clean/lift_pot/aloha_agilex is collected by two runs",
    ),
}


@pytest.mark.parametrize("text", WRONG)
def test_a_mistake_is_named_with_its_place(text: str, tmp_path: Path) -> None:
    kind, told = WRONG[text]
    with pytest.raises(kind, match=told):
        plans(text, tmp_path)


@pytest.mark.parametrize(
    ("options", "told"),
    [
        ("--manifest smok", "did you mean 'smoke'?"),
        ("--manifest smoke --episodes 3", "--episodes = 3 is not allowed; the manifest says that"),
        ("--manifest smoke --set friction=1", "--set"),
        ("--manifest smoke --split unseen", "--split"),
        ("--manifest smoke --shard 3/2", "from 1/n to n/n"),
        ("", "name at least one task, or a --manifest"),
    ],
)
def test_what_cannot_be_is_one_line(options: str, told: str) -> None:
    done = CliRunner().invoke(app, ["collect", *options.split()])
    assert done.exit_code == 2
    assert len(done.stderr.strip().splitlines()) == 1
    assert told in done.stderr


def test_every_manifest_that_collects_has_tasks_that_exist() -> None:
    for path in library.names("manifests").values():
        if "collect" in library.read_yaml(path):
            assert plans_of(path, HOW)


# ---- what it takes -------------------------------------------------------------------------------


def measured(**changes: float) -> Measured:
    """Half of the attempts fail; an attempt takes 1 s and a frame of 100 takes 20 ms and 30 kB."""
    known = {"attempts": 8, "accepted": 4, "attempt_cpu": 1.0, "frames": 100.0, "draw_cpu": 0.02}
    known |= {"bytes": 30e3, "start_cpu": 0.0, "cpu": 10.0, "wall": 10.0}
    return Measured(**{**known, **changes})  # type: ignore[arg-type]


def test_an_estimate_adds_attempts_pictures_and_starts(tmp_path: Path) -> None:
    plan = CollectPlan(("a", "b"), 10, tmp_path, workers=2)
    found = estimate(plan, {"a": measured(start_cpu=3.0), "b": measured()}, 2)
    cost = found.total
    assert cost.episodes == 20
    assert cost.attempts == pytest.approx(40, rel=0.05)
    assert cost.cpu == pytest.approx(40 * 1 + 20 * 2 + 2 * 3, rel=0.05)
    assert cost.bytes == pytest.approx(20 * 3e6, rel=0.05)
    assert found.wall == pytest.approx(cost.cpu / 2)


def test_a_busy_machine_is_slower(tmp_path: Path) -> None:
    plan = CollectPlan(("a",), 10, tmp_path)
    idle, busy = (estimate(plan, {"a": measured(wall=wall)}, 1) for wall in (10.0, 25.0))
    assert busy.total.cpu == idle.total.cpu
    assert busy.wall == pytest.approx(2.5 * idle.wall)


def test_a_task_without_success_is_drawn_like_the_others(tmp_path: Path) -> None:
    plan = CollectPlan(("a", "b"), 10, tmp_path)
    poor = measured(accepted=0, frames=0.0, draw_cpu=0.0, bytes=0.0)
    found = estimate(plan, {"a": measured(), "b": poor}, 1)
    assert found.tasks["b"].attempts > 2 * found.tasks["a"].attempts
    assert found.tasks["b"].bytes == found.tasks["a"].bytes


def test_what_is_there_costs_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("rtphys.studies.collect.costs.episodes_there", lambda plan, task: 9)
    plan = CollectPlan(("a",), 10, tmp_path)
    assert estimate(plan, {"a": measured()}, 1).total.episodes == 1


@pytest.mark.sim
@pytest.mark.render
@pytest.mark.slow
def test_the_estimate_is_near_what_it_takes(tmp_path: Path) -> None:
    """Of disk, that is: the clocks belong to whoever shares the machine."""
    path = tmp_path / "own.yaml"
    path.write_text("collect: [{tasks: [click_bell], episodes: 6, protocol: phys_random}]")
    options = ["--manifest", str(path), "--out", str(tmp_path / "data"), "--workers", "1"]
    done = CliRunner().invoke(app, ["collect", *options])
    assert done.exit_code == 0, done.stderr
    assert "estimate: 6 episodes" in done.stdout
    off = re.search(r"it took .* GB \((.\d+) %\)", done.stdout)
    assert off is not None
    assert abs(int(off[1])) <= 20
    again = CliRunner().invoke(app, ["collect", *options, "--estimate"])
    assert "estimate: 0 episodes" in again.stdout
