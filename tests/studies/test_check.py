"""`rtphys check`: what it counts, what it complains about, what it refuses."""

import json
from dataclasses import replace
from pathlib import Path

import pytest
from counting import Ears
from typer.testing import CliRunner

from pages import ran
from rtphys.assets.pack import default_pack
from rtphys.cli.authoring import TEMPLATE, complaints
from rtphys.cli.main import app
from rtphys.core.library import bundled
from rtphys.spec.episode import EpisodeSpec
from rtphys.studies import check as check_module
from rtphys.studies.check import BASELINES, CheckResult, Score, check, solves, watch
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


def test_a_lost_attempt_does_not_lower_the_mean_cpu_time() -> None:
    score = score_of(("expert", 0, GOOD), ("expert", 1, LOST))
    assert score.to_json()["cpu_seconds_mean"] == 1.0
    assert score_of(("expert", 0, LOST)).to_json()["cpu_seconds_mean"] is None


@pytest.mark.parametrize(("first", "shown"), [(GOOD, "1.00"), (LOST, "-")])
def test_the_table_shows_the_mean_cpu_time(
    first: CheckResult, shown: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    score = score_of(("expert", 0, first), ("expert", 1, LOST))
    monkeypatch.setattr(check_module, "check", lambda *_: [score])
    head, row = CliRunner().invoke(app, ["check", "click_bell"]).stdout.splitlines()[:2]
    assert row[head.index("CPU-s") :].split()[0] == shown


WON = CheckResult(success=True)


@pytest.mark.parametrize(
    ("trials", "said"),
    [
        ([("expert", 0, GOOD), ("idle", 0, CheckResult())], []),
        (
            [("idle", 0, WON), ("idle", 1, CheckResult())],
            ["click_bell, clean: the baseline idle solves 1 of 2 seeds"],
        ),
        ([("expert", 0, LOST), ("expert", 1, GOOD)], []),
        (
            [("expert", 0, LOST), ("expert", 1, LOST)],
            ["click_bell, clean: the expert solves none of 2 seeds"],
        ),
        ([("expert", 0, GOOD), ("again", 0, GOOD)], []),
        (
            [("expert", 0, GOOD), ("again", 0, CheckResult(hash="b"))],
            ["click_bell, clean: a seed that was tried twice had two outcomes"],
        ),
        (
            [("expert", 0, GOOD), ("again", 0, CheckResult("slipped"))],
            ["click_bell, clean: a seed that was tried twice had two outcomes"],
        ),
        ([("expert", 0, GOOD), ("again", 0, LOST)], []),
    ],
)
def test_what_no_task_may_do_is_complained_about(
    trials: list[tuple[str, int, CheckResult]], said: list[str]
) -> None:
    assert complaints([score_of(*trials)]) == said


def test_baselines_try_only_what_the_expert_solves(monkeypatch: pytest.MonkeyPatch) -> None:
    ran: list[str] = []

    def run_here(batches, *_) -> None:
        for batch in batches:
            ran.append(batch.progress.name)
            good = GOOD if "click_bell" in batch.progress.name else LOST
            batch.results.update({0: good})

    monkeypatch.setattr(check_module, "run_here", run_here)
    plan = CheckPlan(tasks=("click_bell", "lift_pot"), seeds=1)
    bell, pot = check(plan, default_pack(), heard := Ears())
    assert bell.rate("idle") == 1 and pot.rate("idle") is None and not pot.accepted
    assert ran == [
        "click_bell, clean (expert)",
        "click_bell, clean (expert, determinism check)",
        "lift_pot, clean (expert)",
        "lift_pot, clean (expert, determinism check)",
        *(f"click_bell, clean ({role})" for role in BASELINES),
    ]
    (said,) = heard.notices
    assert said == "the baselines skip 1 pair of task and protocol, where the expert solves none"


@pytest.mark.sim
def test_the_command_prints_the_numbers() -> None:
    options = ["click_bell", "--seeds", "2", "--baselines", "0", "--workers", "2"]
    done = ran(["check", *options, "--json"])
    (numbers,) = json.loads(done.stdout)
    assert list(numbers) == KEYS
    assert numbers["accepted"] == 2
    assert numbers["replay_success"] == 1.0
    assert numbers["idle_success"] is numbers["random_success"] is None
    assert numbers["jitter_success"] is None
    assert 0 < numbers["cpu_seconds_mean"] < 60


@pytest.mark.processes
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
@pytest.mark.parametrize(
    ("name", "protocol", "seeds", "baseline"),
    [
        ("click_bell", "phys_random", (0, 1), "idle"),
        ("click_bell", "phys_random", (0, 1), "random"),
        # With each task's first success condition these were successes of the random walk:
        # a level hand that drifts past presses the button,
        ("click_alarmclock", "clean", (100031,), "random"),
        # the force alone creeps the rocker to its stop.
        ("turn_switch", "phys_random_all", (100061,), "random"),
    ],
)
def test_who_sees_nothing_solves_nothing(
    name: str, protocol: str, seeds: tuple[int, ...], baseline: str
) -> None:
    task, pack, spec = load_task(name), default_pack(), EpisodeSpec(name, protocol)
    assert not any(solves(spec.at(seed), task, pack, baseline) for seed in seeds)


@pytest.mark.sim
def test_a_task_that_holds_at_the_start_is_solved_by_idling(own_task) -> None:
    """The idle robot's zero means something: here it succeeds."""
    own_task(
        "nothing_to_do",
        "from dataclasses import replace\n"
        "from rtphys.task import load_task, opened\n"
        "task = replace(load_task('click_bell'), success=opened('left'))\n",
    )
    task, pack = load_task("nothing_to_do"), default_pack()
    assert solves(EpisodeSpec("nothing_to_do", "clean").at(0), task, pack, "idle")


@pytest.mark.sim
def test_a_script_that_sticks_is_told_with_its_line_and_the_tilt(own_task) -> None:
    """The cup is to lie on the coaster's own axes, which are y up, and so on its side."""
    text = (bundled() / "tasks" / "place_empty_cup.py").read_text()
    for old, new in (
        ('robot.scene.functional("coaster", 0)', 'robot.scene.pose("coaster")'),
        (", aim=Aim(spot, 0, ONTO)", ""),
        (", point=0, how=ONTO", ", how=ONTO"),
    ):
        assert old in text
        text = text.replace(old, new)
    own_task("my_cup", text)
    own_task("_by_the_rim", (bundled() / "tasks" / "_by_the_rim.py").read_text())
    task = load_task("my_cup")
    watched = watch(EpisodeSpec("my_cup", "clean").at(1), task, default_pack())
    assert watched.attempt.reason == "unreachable"
    assert watched.line.startswith("my_cup.py:") and 'arm.place("cup", spot' in watched.line
    assert watched.placed is not None and watched.placed.prop == "cup"
    assert watched.placed.tilt > 1
    assert [name for name, _, _ in watched.stages][-1].endswith("lift")
    bell = EpisodeSpec("click_bell", "clean").at(0)
    again = watch(bell, load_task("click_bell"), default_pack())
    assert again.attempt.accepted and (again.line, again.placed) == ("", None)


@pytest.mark.render
def test_where_nothing_can_be_drawn_the_verdict_stays(own_task, tmp_path: Path) -> None:
    own_task("too_full", TEMPLATE.replace("where=free", "where=lambda spot: False"))
    for name, file in (("picture", "a.png"), ("video", "a.mp4")):
        done = ran(["try", "too_full", f"--{name}", str(tmp_path / file)], 1)
        assert f"{file}: not drawn, " in done.stderr
    assert not [*tmp_path.glob("a.*")]


@pytest.mark.parametrize("name", ["picture", "video"])
def test_a_file_of_another_kind_is_refused(name: str, tmp_path: Path) -> None:
    done = ran(["try", "click_bell", f"--{name}", str(tmp_path / "a.gif")], 2)
    assert "a.gif' is not allowed; a name that ends in ." in done.stderr
