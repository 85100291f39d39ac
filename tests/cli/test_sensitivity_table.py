"""The table of `rtphys sensitivity`: the counts behind a tolerance, in 80 columns."""

from pathlib import Path

import pytest

from rtphys.analysis.sensitivity import Axis, Bisection, Level, answer
from rtphys.cli.research import draw_map, tolerances_table
from rtphys.cli.screen import Screen, print_within
from rtphys.core.untrusted import JSON
from rtphys.report.figures import SENSITIVITY

LOW, HIGH = Axis("gripper_joint_damping", 1.0, 0.5), Axis("gripper_joint_damping", 1.0, 3.0)
BOTH = answer([Bisection(LOW, 1, [Level(1.0, 10, 10)]),
               Bisection(HIGH, 1, [Level(1.0, 2, 10), Level(0.5, 9, 10)])])  # fmt: skip
ONE = answer([Bisection(Axis("external_force", 0.0, 0.1), 1, [Level(1.0, 7, 10)])])
LONGEST = "shake_bottle_horizontally"


def lines(capsys: pytest.CaptureFixture[str], task: str, width: int) -> list[str]:
    attributes: dict[str, JSON] = {"gripper_joint_damping": BOTH, "external_force": ONE}
    result: dict[str, JSON] = {"task": task, "seeds": [*range(10)], "attributes": attributes}
    print_within(Screen(width=width), tolerances_table([result]))
    printed = capsys.readouterr().out.splitlines()
    assert max(map(len, printed)) <= width
    return [" ".join(line.split()) for line in printed]


def test_successes_at_the_ends_stand_in_the_row(capsys: pytest.CaptureFixture[str]) -> None:
    for width in (80, 120):
        rows = lines(capsys, "click_bell", width)
        assert "click_bell gripper_joint_damping 0.5 to 2 × 60 % 10/10, 2/10" in rows
        assert "click_bell external_force 0 to 0.1 × m·g 100 % 7/10" in rows


def test_names_stay_in_one_piece_in_80_columns(capsys: pytest.CaptureFixture[str]) -> None:
    words = [word for row in lines(capsys, LONGEST, 80) for word in row.split()]
    assert words.count(LONGEST) == 2 and "gripper_joint_damping" in words


def test_a_map_of_nothing_is_not_drawn(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    draw_map({"click_bell": {}}, SENSITIVITY, tmp_path / "map.png")
    said = "map.png: not drawn, since nothing was measured\n"
    assert capsys.readouterr().err.endswith(said) and not (tmp_path / "map.png").exists()
    draw_map({"click_bell": {"friction": 0.5}}, SENSITIVITY, tmp_path / "map.png")
    assert (tmp_path / "map.png").exists()
