"""What a task's file may hold, and what is refused by name before anything is simulated."""

from pathlib import Path

import pytest

from rtphys.core.errors import BadFile, BadValue, RtphysError
from rtphys.core.poses import Pose
from rtphys.task.props import Box, Prop, check_names
from rtphys.task.spec import load_task

OWN = '''
"""Lift the block."""
from rtphys.task import *


def layout(draw):
    yield Box(name="block", pose=Pose((0.1, -0.1, 0.74)), half_size=(0.02, 0.02, 0.02))


def script(robot):
    robot.do(robot.right.shift(z=0.02))


success = lifted("block", 0.1)
task = Task(layout=layout, script=script, success=success, step_limit=50)
'''
WITHOUT_YIELD = "    yield Box(", "    Box("


@pytest.fixture
def library(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("RTPHYS_LIBRARY", str(tmp_path))
    (tmp_path / "tasks").mkdir()
    return tmp_path / "tasks" / "own.py"


def test_a_task_of_ones_own_is_loaded(library: Path) -> None:
    library.write_text(OWN)
    (block,) = load_task("own").props(0)
    assert block.name == "block"


@pytest.mark.parametrize(
    ("old", "new", "problem"),
    [
        ("layout(draw)", "layout()", "layout must be a function of one argument"),
        ("script(robot)", "script(robot, scene)", "script must be a function of one argument"),
        ("success=success", "success=True", "success must be a condition, or a function"),
        ("step_limit=50", "step_limit='50'", "step_limit = '50' is not allowed; .* 1 or more"),
        ("step_limit=50", "step_limit=0", "step_limit = 0 is not allowed"),
        *[
            (
                'success = lifted("block", 0.1)',
                f'success = {words} lifted("block", 0.1)',
                r"joined by & and ~, not by `and`, `or` and `not` \(line \d+\)",
            )
            for words in ("at_rest('block') and", "at_rest('block') or", "not")
        ],
        (*WITHOUT_YIELD, "layout must yield props, and gave None"),
        ("yield Box(", "yield 3, Box(", r"layout must yield props, and gave \(3, Box"),
    ],
)
def test_a_part_of_a_task_that_is_none_is_named(
    library: Path, old: str, new: str, problem: str
) -> None:
    assert old in OWN
    library.write_text(OWN.replace(old, new))
    with pytest.raises(RtphysError, match=problem) as refused:
        load_task("own").props(0)
    assert str(refused.value).startswith(str(library))
    assert isinstance(refused.value, BadFile | BadValue)


def block(name: str) -> Prop:
    return Box(name=name, pose=Pose((0, 0, 0.74)), half_size=(0.02, 0.02, 0.02))


def test_each_prop_has_a_name_of_its_own() -> None:
    """Two of one name were one in labels, and only one of them had its physics."""
    check_names([block("left block"), block("clutter"), block("table_left")], "here")
    refused = {
        "block": "two props have this name",
        "table": "name other things",
        "right_gripper": "name other things",
        "clutter0": "name other things",
        "red/block": "no slash",
        "red@block": "before a prop",
        "": "not empty",
    }
    for name, problem in refused.items():
        with pytest.raises(BadValue, match=rf"here: prop = '{name}' .*{problem}"):
            check_names([block("block"), block(name)], "here")
