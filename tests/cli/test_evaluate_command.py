"""`rtphys evaluate`: what it refuses, and its tables: from 80 columns on, nothing is cut off."""

import re
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from evaluations import FINGERPRINT, instances, record
from rich.table import Table

from pages import ran
from rtphys.cli.evaluate import (
    attributes_table,
    errors_of,
    failures_table,
    left_out_of,
    pairs_table,
    rates_table,
)
from rtphys.cli.screen import Screen, print_within
from rtphys.core.errors import BadValue
from rtphys.results import summarise
from rtphys.results.breaks import Break, Curve
from rtphys.results.evaluation import EpisodeRecord, Results, ledger_file
from rtphys.results.statistics import Paired
from rtphys.results.summary import Counts, Loads, PairSummary, ProtocolSummary, Summary, TaskSummary
from rtphys.studies.requests import BenchPlan, CertificationRun, CheckPlan, EvaluationRun

COUNTS = Counts(feasible=500, infeasible=74, rollouts=500, successes=445, held=333)
LOADS = Loads((0.0, 21.4, 1012.0), (0.3, 0.89, 1.0), 12)
REASONS = {"step_limit": 44, "policy_error": 11}
TASK, BELL = "shake_bottle_horizontally", "click_bell"
KEY = ("clean", TASK)
CURVE = Curve(low=-0.0499, high=0.0499, slope=-12.34, error=10.01, levels=(1.0,), p=1.2e-14)
SUMMARY = Summary(
    tasks=(TaskSummary("phys_random_all", TASK, COUNTS, LOADS, 100.0, REASONS),),
    overall=(ProtocolSummary("phys_random_all", 2, COUNTS, LOADS, 0.5),),
    pairs=(PairSummary("official_random", "phys_random_all", Paired(4000, 1000, 101, 7)),),
    breaks={
        "phys_random_all": (
            Break("arm_joint_damping", "N·m·s/rad", CURVE, 2.3e-13, (), ("gripper_joint_damping",)),
        )
    },
)
RATES = [
    "phys_random_all",
    TASK,
    "89 % [86-91.5] 445/500",
    "77.5 % 445/574",
    "66.6 % 333/500",
]
TOTAL = ["phys_random_all", "all, mean 50 %", *RATES[2:]]
FAILURES = ["phys_random_all", TASK, "step_limit 44, policy_error 11"]
PAIRS = ["official_random", "phys_random_all", "5108", "4000", "1000", "101", "1.3e-186"]
ATTRIBUTES = [
    "phys_random_all",
    "arm_joint_damping, gripper_joint_damping",
    "-0.0499 to 0.0499 N·m·s/rad",
    "-12.34 ± 10.01",
    "1.2e-14",
    "2.3e-13",
]


@pytest.mark.parametrize(
    ("draw", "rows"),
    [
        (rates_table, [RATES, TOTAL]),
        (failures_table, [FAILURES]),
        (pairs_table, [PAIRS]),
        (attributes_table, [ATTRIBUTES]),
    ],
)
def test_tables_have_their_rows_and_no_word_is_broken_in_80_columns(
    draw: Callable[[Summary], Table], rows: list[list[str]], capsys: pytest.CaptureFixture[str]
) -> None:
    table = draw(SUMMARY)
    assert [list(row) for row in zip(*(c.cells for c in table.columns), strict=True)] == rows
    texts = [str(text) for column in table.columns for text in (column.header, *column.cells)]
    print_within(Screen(width=80), table)
    printed = Counter(capsys.readouterr().out.split())
    assert not Counter(word for text in texts for word in text.split()) - printed


def test_a_pair_without_a_common_seed_has_no_p(capsys: pytest.CaptureFixture[str]) -> None:
    """As in `compare`: 1 would say that the rates are alike."""
    none = PairSummary("clean", "phys_random", Paired(0, 0, 0, 0))
    print_within(Screen(width=80), pairs_table(replace(SUMMARY, pairs=(none,))))
    assert capsys.readouterr().out.splitlines()[-1].split()[-1] == "-"


def test_heads_wrap_before_rates_do(capsys: pytest.CaptureFixture[str]) -> None:
    counts = Counts(feasible=40, infeasible=0, rollouts=40, successes=40, held=40)
    row = TaskSummary("phys_random", BELL, counts, LOADS, 100.0, {"gave_up": 26})
    print_within(Screen(width=80), rates_table(replace(SUMMARY, tasks=(row,), overall=())))
    (line,) = (line for line in capsys.readouterr().out.splitlines() if BELL in line)
    assert "  100 % [91.2-100] 40/40  " in line and line.count("  100 % 40/40") == 2


def test_what_nobody_tried_has_no_rate(capsys: pytest.CaptureFixture[str]) -> None:
    counts = Counts(feasible=2, infeasible=None, rollouts=2, successes=2, held=2)
    row = TaskSummary("phys_random", BELL, counts, LOADS, 100.0, {})
    print_within(Screen(width=80), rates_table(replace(SUMMARY, tasks=(row,), overall=())))
    (line,) = (line for line in capsys.readouterr().out.splitlines() if BELL in line)
    assert re.search(r" 100 % \[34\.2-100\] 2/2 +- +100 % 2/2", line)


def test_seeds_of_a_dataset_are_no_benchmark_instances() -> None:
    for certified, head in ((True, "of benchmark instances"), (False, "of these seeds")):
        table = rates_table(replace(SUMMARY, certified=certified))
        assert str(table.columns[2].header) == head


def test_attributes_that_are_not_shown_are_counted_with_their_place() -> None:
    (effect,) = SUMMARY.breaks["phys_random_all"]
    assert left_out_of(SUMMARY) == []
    many = replace(SUMMARY, breaks={"clean": [], "phys_random_all": [effect] * 8})
    assert len(attributes_table(many).rows) == 5
    where = "summary.json and attributes_phys_random_all.png"
    assert left_out_of(many) == [f"phys_random_all: 3 more attributes in {where}"]


def test_the_first_error_of_a_policy_is_said_in_one_line(tmp_path: Path) -> None:
    trace = "Traceback (most recent call last):\n  ...\nValueError: 14 actions, not 16\n"
    records = [
        EpisodeRecord(TASK, "clean", 100000, success=True),
        EpisodeRecord(TASK, "clean", 100001, success=False, reason="policy_error", detail=trace),
    ]
    results = Results(tmp_path, {}, {KEY: records}, {})
    where = ledger_file(tmp_path, "clean", TASK)
    sentence = (
        "policy_error of seed 100001: ValueError: 14 actions, not 16; "
        f"the traceback is `detail` of its line in {where}"
    )
    assert errors_of(results, [KEY]) == (sentence, False)
    assert errors_of(replace(results, records={KEY: records[1:]}), [KEY]) == (sentence, True)
    assert errors_of(replace(results, records={KEY: records[:1]}), [KEY]) == ("", False)


def test_what_an_earlier_command_has_run_hides_no_error_and_is_none(tmp_path: Path) -> None:
    bell, wrong = ("clean", BELL), "ValueError: x"
    raised = EpisodeRecord(TASK, "clean", 1, False, reason="policy_error", detail=wrong)
    earlier = EpisodeRecord(BELL, "clean", 1, success=True)
    results = Results(tmp_path, {}, {bell: [earlier], KEY: [raised]}, {})
    assert errors_of(results, [KEY])[1]
    assert errors_of(results, [bell]) == ("", False)
    assert not errors_of(results, [bell, KEY])[1]


def test_the_message_of_an_error_may_have_several_lines(tmp_path: Path) -> None:
    frames = (
        'Traceback (most recent call last):\n  File "mine.py", line 3, in play\n    f()\n    ^^^\n'
    )
    for trace in (f"{frames}ValueError: sizes\n[1 2\n 3]\n", f"{frames}ValueError: sizes\n"):
        wrong = EpisodeRecord(TASK, "clean", 1, False, reason="policy_error", detail=trace)
        said, _ = errors_of(Results(tmp_path, {}, {KEY: [wrong]}, {}), [KEY])
        assert said.startswith("policy_error of seed 1: ValueError: sizes; ")


def test_a_long_message_of_an_error_is_cut(tmp_path: Path) -> None:
    wrong = EpisodeRecord(
        TASK, "clean", 1, False, reason="policy_error", detail="E: " + "x" * 10**6
    )
    said, _ = errors_of(Results(tmp_path, {}, {KEY: [wrong]}, {}), [KEY])
    assert said.startswith("policy_error of seed 1: E: xxx") and len(said) < 1000


@pytest.mark.parametrize("width", [80, 100])
def test_no_interval_is_broken(width: int, capsys: pytest.CaptureFixture[str]) -> None:
    print_within(Screen(width=width), rates_table(SUMMARY))
    assert capsys.readouterr().out.split().count("[86-91.5]") == 2


def shown(made: Summary, out: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """What the command prints of a summary."""
    monkeypatch.setattr("rtphys.studies.evaluate.evaluate", lambda *_: made)
    records = {(row.protocol, row.task): [] for row in made.tasks}
    results = Results(out, {}, records, {})
    monkeypatch.setattr("rtphys.cli.evaluate.read_results", lambda _: results)
    options = ["--policy", "idle", "--task", BELL, "--protocol", "clean", "--out", str(out)]
    done = ran(["evaluate", *options])
    return done.stdout


def test_what_a_policy_usually_does_wrong_is_one_line_below_the_table(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    cause = "joints are beyond their limits in 83% of the actions, up to 95 rad: degrees? (2 of 2)"
    tasks = (replace(SUMMARY.tasks[0], language=cause), SUMMARY.tasks[0])
    said = shown(replace(SUMMARY, tasks=tasks), tmp_path, monkeypatch)
    assert " ".join(said.split()).count(f"phys_random_all, {TASK}: {cause}") == 1
    assert said.count("degrees?") == 1, "nothing is said of the task that fits"


def test_successes_that_no_demonstration_could_be_are_counted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    said = " ".join(shown(SUMMARY, tmp_path, monkeypatch).split())
    many = f"12 of the {SUMMARY.tasks[0].counts.successes} successes"
    assert said.count(f"phys_random_all, {TASK}: {many} press or strain too hard") == 1


def test_stale_lists_and_what_the_regression_cannot_say_are_lines_of_the_output(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    listed = instances(BELL, "clean", 1)
    edited = FINGERPRINT.model_copy(update={"assets": "new"})
    key = ("clean", BELL)
    stale = summarise({key: [record(1)]}, {key: listed}, {key: edited})
    made = replace(SUMMARY, changed=stale.changed)
    said = shown(made, tmp_path, monkeypatch)
    clause = "1 of 1 list had another certification fingerprint when they were run: assets was ''"
    assert said.count(clause) == 1
    assert said.count("`rtphys sensitivity` moves one attribute alone") == 1
    both = "--only arm_joint_damping,gripper_joint_damping` tells them apart"
    assert " ".join(said.split()).count(both) == 1
    assert "looks" not in said
    (pair,) = SUMMARY.pairs
    pairs = (replace(pair, first="clean", looks_differ=True), pair)
    said = shown(replace(made, pairs=pairs), tmp_path, monkeypatch)
    caution = "clean, phys_random_all: they differ in looks too, not in physics alone"
    assert said.count(caution) == said.count("differ in looks") == 1


def test_a_protocol_that_is_named_twice_is_refused() -> None:
    for kind in (CheckPlan, BenchPlan):
        with pytest.raises(BadValue, match="each protocol once"):
            kind((BELL,), ("clean", "clean"))
    for kind in (CertificationRun, EvaluationRun):
        with pytest.raises(BadValue, match="each protocol once"):
            kind((BELL,), ("clean", "phys_random", "clean"), out=Path("bench"))


def test_the_command_spells_what_certifies(tmp_path: Path) -> None:
    options = ["--task", BELL, "--protocol", "clean", "--instances", str(tmp_path)]
    done = ran(["evaluate", "--policy", "idle", *options], 2)
    cure = f"`rtphys certify --task {BELL} --protocol clean --feasible 100 --out FOLDER`"
    assert f"does not exist; to certify: {cure}, then set --instances" in done.stderr
