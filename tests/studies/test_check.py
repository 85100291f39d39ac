"""`rtphys check`: what it counts, what it complains about, what it refuses."""

import json
from dataclasses import replace
from pathlib import Path

import pytest
from typer.testing import CliRunner

from rtphys.assets.pack import default_pack
from rtphys.cli.authoring import complaints
from rtphys.cli.main import app
from rtphys.policies.baselines import Walk
from rtphys.spec.episode import EpisodeSpec
from rtphys.studies import check as check_module
from rtphys.studies.check import BASELINES, CheckResult, Score, check, solves
from rtphys.studies.requests import CheckPlan
from rtphys.task.spec import load_task

KEYS = [
    "task", "protocol", "seeds", "accepted", "rejected", "failures", "replay_success",
    "idle_success", "random_success", "jitter_success", "cpu_seconds_mean",
]  # fmt: skip


def score_of(*trials: tuple[str, int, CheckResult]) -> Score:
    robots = ("expert", "again", *BASELINES)
    by_robot = {robot: {s: trial for r, s, trial in trials if r == robot} for robot in robots}
    return Score(EpisodeSpec("click_bell", "clean"), by_robot)  # type: ignore[arg-type]


GOOD = CheckResult(success=True, cpu_seconds=1.0, hash="a")
LOST = CheckResult("worker_hang", "slept")


def test_a_score_counts_by_reason_and_leaves_out_what_was_not_tried() -> None:
    slipped = CheckResult("slipped", "the bell", cpu_seconds=3.0, hash="b")
    score = score_of(("expert", 2, GOOD), ("expert", 1, slipped), ("expert", 0, GOOD))
    assert score.to_json() == {
        "task": "click_bell",
        "protocol": "clean",
        "seeds": 3,
        "accepted": 2,
        "rejected": {"slipped": 1},
        "failures": [{"seed": 1, "reason": "slipped", "detail": "the bell"}],
        "replay_success": 1.0,
        "idle_success": None,
        "random_success": None,
        "jitter_success": None,
        "cpu_seconds_mean": pytest.approx(5 / 3),
    }
    assert min(score.accepted) == 0
    assert score.failures == {1: slipped}


def test_a_lost_worker_is_a_failure_with_its_reason() -> None:
    score = score_of(("expert", 0, GOOD), ("expert", 1, LOST))
    assert score.rejected == {"worker_hang": 1} and score.failures[1].detail == "slept"
    assert score.accepted == [0] and score.deterministic


def test_an_idle_robot_that_succeeds_is_complained_about() -> None:
    assert complaints([score_of(("expert", 0, GOOD), ("idle", 0, CheckResult()))]) == []
    (text,) = complaints(
        [score_of(("idle", 0, CheckResult(success=True)), ("idle", 1, CheckResult()))]
    )
    assert text == "click_bell, clean: the baseline idle solves 1 of 2 seeds"


def test_an_expert_that_solves_nothing_is_complained_about() -> None:
    assert complaints([score_of(("expert", 0, LOST), ("expert", 1, GOOD))]) == []
    (text,) = complaints([score_of(("expert", 0, LOST), ("expert", 1, LOST))])
    assert text == "click_bell, clean: the expert solves none of 2 seeds"


def test_two_outcomes_of_one_seed_are_complained_about() -> None:
    same = score_of(("expert", 0, GOOD), ("again", 0, GOOD))
    assert complaints([same]) == []
    other = score_of(("expert", 0, GOOD), ("again", 0, CheckResult(hash="b")))
    (text,) = complaints([other])
    assert "different states" in text


def test_the_random_walk_stays_within_limits_and_is_keyed() -> None:
    import numpy as np

    limits = np.array([[[-0.1, 0.2]] * 6] * 2)
    walks = []
    for seed in (1, 1, 2):
        source, command = Walk(seed, limits), np.zeros(14)
        walk = []
        for _ in range(200):
            command = source.after(command)
            walk.append(command)
        walks.append(np.array(walk))
    arms = walks[0][:, [0, 5, 7, 12]]
    assert arms.min() >= -0.1
    assert arms.max() <= 0.2
    assert np.ptp(arms) > 0.2
    assert 0 <= walks[0][:, [6, 13]].min() <= walks[0][:, [6, 13]].max() <= 1
    assert (walks[0] == walks[1]).all()
    assert (walks[0] != walks[2]).any()


def test_baselines_try_only_what_the_expert_solves(monkeypatch: pytest.MonkeyPatch) -> None:
    ran: list[str] = []

    def run_here(batches, *_) -> None:
        for batch in batches:
            ran.append(batch.progress.name)
            good = GOOD if "click_bell" in batch.progress.name else LOST
            batch.results.update({0: good})

    monkeypatch.setattr(check_module, "run_here", run_here)
    plan = CheckPlan(tasks=("click_bell", "lift_pot"), seeds=1)
    bell, pot = check(plan, default_pack())
    assert bell.rate("idle") == 1 and pot.rate("idle") is None and not pot.accepted
    assert ran == [
        "click_bell, clean (expert)",
        "click_bell, clean (expert, a second time)",
        "lift_pot, clean (expert)",
        "lift_pot, clean (expert, a second time)",
        *(f"click_bell, clean ({role})" for role in BASELINES),
    ]


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ("click_bel", "did you mean 'click_bell'?"),
        ("click_bell --protocol cleen", "did you mean 'clean'?"),
        ("click_bell --domain globl", "did you mean 'global'?"),
        ("click_bell --domain global", "varies no physics"),
        ("click_bell --seeds 0", "--seeds = 0 is not allowed"),
        ("click_bell --json /nowhere/at/all.json", "/nowhere/at/all.json"),
    ],
)
def test_what_cannot_work_is_one_clear_line(options: str, text: str) -> None:
    done = CliRunner().invoke(app, ["check", *options.split()])
    assert done.exit_code == 2
    assert len(done.stderr.strip().splitlines()) == 1
    assert text in done.stderr


@pytest.mark.sim
def test_the_command_writes_the_numbers(tmp_path: Path) -> None:
    out = tmp_path / "numbers.json"
    options = ["click_bell", "--seeds", "2", "--baselines", "0", "--workers", "2"]
    done = CliRunner().invoke(app, ["check", *options, "--json", str(out)])
    assert done.exit_code == 0, done.stderr
    (numbers,) = json.loads(out.read_text())
    assert list(numbers) == KEYS
    assert numbers["accepted"] == 2
    assert numbers["replay_success"] == 1.0
    assert numbers["idle_success"] is numbers["random_success"] is None
    assert numbers["jitter_success"] is None
    assert 0 < numbers["cpu_seconds_mean"] < 60


@pytest.mark.sim
def test_scores_do_not_depend_on_the_number_of_workers() -> None:
    pack = default_pack()
    plan = CheckPlan(("click_bell",), ("phys_random",), seeds=1, baselines=0, workers=1)
    one, two = check(plan, pack), check(replace(plan, workers=2), pack)
    for role in ("expert", "again"):
        (here, there) = (score.results[role][0].hash for score in (one[0], two[0]))
        assert here and here == there
    assert one[0].deterministic


@pytest.mark.sim
@pytest.mark.parametrize("robot", ["idle", "random"])
def test_a_blind_robot_does_not_ring_the_bell(robot: str) -> None:
    task, pack = load_task("click_bell"), default_pack()
    assert not any(
        solves(EpisodeSpec("click_bell", "phys_random").at(s), task, pack, robot) for s in (0, 1)
    )


@pytest.mark.sim
@pytest.mark.parametrize(
    ("name", "seed", "protocol"),
    [
        ("click_alarmclock", 100031, "clean"),  # a level hand that drifts past presses the button
        ("turn_switch", 100061, "phys_random_all"),  # the force alone creeps the rocker to its stop
    ],
)
def test_what_chance_once_solved_it_no_longer_does(name: str, seed: int, protocol: str) -> None:
    """With each task's first success condition these were successes of the random robot."""
    task = load_task(name)
    assert not solves(EpisodeSpec(name, protocol).at(seed), task, default_pack(), "random")


@pytest.mark.sim
def test_a_task_that_holds_at_the_start_is_solved_by_idling(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The idle robot's zero means something: here it succeeds."""
    (tmp_path / "tasks").mkdir()
    (tmp_path / "tasks" / "nothing_to_do.py").write_text(
        "from dataclasses import replace\n"
        "from rtphys.task import load_task, opened\n"
        "task = replace(load_task('click_bell'), success=opened('left'))\n"
    )
    monkeypatch.setenv("RTPHYS_LIBRARY", str(tmp_path))
    task, pack = load_task("nothing_to_do"), default_pack()
    assert solves(EpisodeSpec("nothing_to_do", "clean").at(0), task, pack, "idle")
