"""What `rtphys identify` and `rtphys compare` print of results, few tasks or many."""

import json
from dataclasses import replace
from pathlib import Path

import pytest
from typer.testing import CliRunner

from rtphys.analysis.identify import Result, TaskResult, write_result
from rtphys.analysis.scoring import Beyond, Score
from rtphys.cli.main import app
from rtphys.cli.research import MAX_ONE_BY_ONE, carriers, show

SCORE = Score(0.91, (0.85, 0.95), -0.1, {"touch": 0.01, "effort": 0.6}, 60, None)
TASK = TaskResult(60, 65, {"friction": SCORE}, {"object_mass": "ValueError: \x1b[31m"})


def result(tasks: int, estimator: str = "trees") -> Result:
    return Result(estimator, "phys_random", {f"task_{k}": TASK for k in range(tasks)})


def test_few_tasks_are_shown_one_by_one(capsys: pytest.CaptureFixture[str]) -> None:
    left = replace(TASK, left_out={"table_tilt": "does not vary"})
    show(Result("trees", "phys_random", {"heft": left}))
    said = capsys.readouterr()
    assert "0.85 .. 0.95" in said.out
    assert "heft: left out: table_tilt (does not vary)" in said.out
    assert r"the estimator failed: ValueError: \x1b[31m" in said.err


def test_many_tasks_are_shown_by_attribute(capsys: pytest.CaptureFixture[str]) -> None:
    show(result(MAX_ONE_BY_ONE + 1))
    lines = [line for line in capsys.readouterr().out.splitlines() if "friction" in line]
    assert len(lines) == 1
    assert "task_0 0.91" in lines[0]


def test_carriers_are_the_groups_that_matter() -> None:
    assert carriers(SCORE) == "effort 0.60"
    assert carriers(replace(SCORE, importance={"touch": 0.01})) == "-"


def test_results_of_common_tasks_are_compared(tmp_path: Path) -> None:
    better = replace(SCORE, r2=0.95, beyond=Beyond(0.5, (0.4, 0.6), 30))
    other = Result(
        "python:mine.py:Mine",
        "phys_random",
        {"task_0": replace(TASK, scores={"friction": better}, failed={})},
    )
    files = []
    for name, one in (("a.json", result(3)), ("b.json", other)):
        write_result(tmp_path / name, one)
        files.append(str(tmp_path / name))
    said = CliRunner().invoke(app, ["compare", *files]).output
    assert "mean R2 over 1 task that all files have" in said
    row = next(line for line in said.splitlines() if "friction" in line)
    for number in ("0.91", "0.95", "0.50"):
        assert number in row
    assert "trees failed on 1 attribute of these tasks" in said
    shown = json.loads(CliRunner().invoke(app, ["compare", *files, "--json"]).output)
    assert shown["tasks"] == ["task_0"]
    first, second = shown["columns"]
    assert (first["r2"], second["r2"]) == ({"friction": 0.91}, {"friction": 0.95})
    assert (first["beyond"], second["beyond"]) == ({"friction": None}, {"friction": 0.5})
    assert "object_mass" in first["failed"]["task_0"] and second["failed"] == {"task_0": {}}
    for words in (["--paper"], ["--protocol", "phys_random"], ["--figure", "a.png"]):
        done = CliRunner().invoke(app, ["compare", *files, *words])
        assert done.exit_code == 2 and f"{words[0]} = " in done.stderr
    write_result(tmp_path / "b.json", replace(other, protocol="clean"))
    said = CliRunner().invoke(app, ["compare", *files]).output
    assert "phys_random" in said and "clean" in said, "two protocols are no two estimators"


def test_results_of_one_estimator_are_told_apart_by_their_files(tmp_path: Path) -> None:
    files = [str(tmp_path / name / "trees.json") for name in ("one", "two")]
    for file in files:
        Path(file).parent.mkdir()
        write_result(Path(file), result(1))
    head = CliRunner().invoke(app, ["compare", *files]).output.splitlines()[1]
    assert all(head.count(file) == 2 for file in files), "R2, and R2 beyond the range"
    shown = json.loads(CliRunner().invoke(app, ["compare", *files, "--json"]).output)
    assert [column["file"] for column in shown["columns"]] == files
