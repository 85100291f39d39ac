"""`rtphys bench`: what is counted, and that nothing is counted twice."""

import json

import pytest

from pages import ran
from rtphys.assets.pack import default_pack
from rtphys.core.timing import PhaseTimer
from rtphys.episode.generate import attempt
from rtphys.spec.episode import EpisodeSpec
from rtphys.studies.cost import ATTEMPT, PICTURES, Cost, Spent, bench
from rtphys.studies.requests import BenchPlan
from rtphys.task.spec import load_task

MAX_OUTSIDE = 0.1  # of the CPU time neither on physics nor planning, rendering, encoding


def test_phases_and_the_rest_make_the_sum() -> None:
    spent = Spent(("a", "b"), count=2)
    spent.timer.cpu_s.update(a=3.0, b=5.0, other=2.0)
    assert spent.cpu_s() == {"a": 1.5, "b": 2.5, "other": 1.0, "sum": 5.0}


@pytest.mark.sim
def test_attempts_are_measured_in_full() -> None:
    options = ["bench", "--task", "click_bell", "--protocol", "clean", "--episodes", "1"]
    done = ran([*options, "--no-pictures", "--json"])
    content = json.loads(done.stdout)
    (row,) = content["rows"]
    assert (row["task"], row["protocol"], row["attempts"]) == ("click_bell", "clean", 1)
    assert row["images"] == 0
    for key, phases in (("attempt_cpu_s", ATTEMPT), ("pictures_cpu_s", PICTURES)):
        assert list(row[key]) == [*phases, "other", "sum"]
    for spent in (row["attempt_cpu_s"], row["attempt_wall_s"]):
        assert sum(v for k, v in spent.items() if k != "sum") == pytest.approx(spent["sum"])
        assert min(spent[phase] for phase in ("build", "plan", "simulate")) > 0
    # An attempt is almost nothing but its phases.
    assert row["attempt_cpu_s"]["other"] < 0.2 * row["attempt_cpu_s"]["sum"]
    assert content["means"]["clean"]["attempt_cpu_s"] == row["attempt_cpu_s"]["sum"]


@pytest.mark.sim
def test_taking_time_changes_no_state() -> None:
    task, pack, recipe = (
        load_task("click_bell"),
        default_pack(),
        EpisodeSpec("click_bell", "clean").at(3),
    )
    plain, timed = attempt(recipe, task, pack), attempt(recipe, task, pack, PhaseTimer())
    assert plain.recording is not None and timed.recording is not None
    assert plain.recording.hash == timed.recording.hash


@pytest.mark.slow
@pytest.mark.render
def test_physics_planning_rendering_and_encoding_take_nine_tenths() -> None:
    told: list[Cost] = []
    plan = BenchPlan(("click_bell",), ("clean",), episodes=1)
    (cost,) = bench(plan, default_pack(), told.append)
    assert told == [cost] and cost.pictures.count == cost.accepted == 1
    assert cost.images % 3 == 0
    spent = cost.pictures.cpu_s()
    assert min(spent[phase] for phase in PICTURES) > 0
    both = (cost.attempts.timer.cpu_s, cost.pictures.timer.cpu_s)
    outside = sum(each.get(phase, 0.0) for each in both for phase in ("build", "write", "other"))
    assert outside < MAX_OUTSIDE * sum(sum(each.values()) for each in both)
