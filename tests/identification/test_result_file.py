"""Result files: what is written is read again; what is none is refused."""

from pathlib import Path

import pytest

from rtphys.core.errors import BadFile
from rtphys.identification.result_file import Result, TaskResult, read_result, write_result
from rtphys.identification.scoring import Beyond, Score

SCORE = Score(0.5, (0.25, 0.75), -0.125, {"effort": 0.5}, 60, Beyond(0.25, (0.0, 0.5), 30))
ALONE = Score(0.75, (0.5, 1.0), 0.0, {}, 20, None)
RESULT = Result(
    "trees",
    "phys_random",
    {
        "heft": TaskResult(60, 62, {"object_mass": SCORE}, {"friction": "ValueError: no"}),
        "tap": TaskResult(60, 60, {"object_mass": ALONE}, {}, {"external_force": "does not act"}),
    },
)


def test_a_result_is_read_as_it_was_written(tmp_path: Path) -> None:
    path = tmp_path / "trees.json"
    write_result(path, RESULT)
    assert read_result(path) == RESULT
    first = path.read_bytes()
    write_result(path, read_result(path))
    assert path.read_bytes() == first


def test_means_are_over_the_tasks_that_have_a_score() -> None:
    assert RESULT.mean("object_mass", ["heft", "tap"]) == 0.625
    assert RESULT.mean("object_mass", ["heft", "tap"], beyond=True) == 0.25
    assert RESULT.mean("friction", ["heft", "tap"]) is None


@pytest.mark.parametrize("text", ["{}", '{"format": 2}', '{"format": 1, "tasks": 3}', "[1]"])
def test_what_is_no_result_is_refused(tmp_path: Path, text: str) -> None:
    path = tmp_path / "other.json"
    path.write_text(text)
    with pytest.raises(BadFile, match=r"other\.json"):
        read_result(path)
