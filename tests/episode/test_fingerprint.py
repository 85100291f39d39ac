"""A fingerprint covers what decides a state: task, family, expert, simulation."""

from pathlib import Path

import pytest

import rtphys
from rtphys.core.code_digest import imported_files
from rtphys.episode.fingerprint import versions
from rtphys.task.spec import load_task

PACKAGE = Path(rtphys.__file__).parent
DECIDING = (
    "expert/arm.py",
    "plan/rrt.py",
    "plan/trajectory.py",
    "sim/feet.py",
    "physics/domain.py",
    "visual/clutter.py",
    "task/success.py",
)
DRAWING = ("sim/renderer.py", "episode/render.py", "data/video.py", "cli/main.py")


def test_the_way_from_a_recipe_to_its_states_is_covered_and_pictures_are_not() -> None:
    found = imported_files(PACKAGE / "episode" / "generate.py", PACKAGE)
    names = {path.relative_to(PACKAGE).as_posix() for path in found}
    assert names >= set(DECIDING)
    assert names.isdisjoint(DRAWING)


FAMILY = "LIFT = 0.1  # [m]\n"
OWN = '''"""Do nothing."""
from rtphys.task import Task, hands_open

from ._family import LIFT


def layout(draw):
    return []


def script(robot):
    robot.left.lift(LIFT)


task = Task(layout=layout, script=script, success=hands_open(), step_limit=100)
'''


def test_a_familys_code_counts_and_its_comments_do_not(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "tasks"
    folder.mkdir()
    monkeypatch.setenv("RTPHYS_LIBRARY", str(tmp_path))
    (folder / "own.py").write_text(OWN)
    found = []
    for text in (FAMILY, FAMILY.replace("[m]", "metres, upwards"), FAMILY.replace("0.1", "0.2")):
        (folder / "_family.py").write_text(text)
        found.append(versions(load_task("own")))
    assert found[0] == found[1]
    assert found[0]["task"] != found[2]["task"]
    assert found[0]["code"] == found[2]["code"]
