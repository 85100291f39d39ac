"""One attempt, watched: where the script stuck, and what it had asked for."""

from pathlib import Path

import pytest

from rtphys.assets.pack import default_pack
from rtphys.core.library import bundled
from rtphys.spec.episode import EpisodeSpec
from rtphys.studies.check import watch
from rtphys.task.spec import load_task

pytestmark = pytest.mark.sim


def test_a_script_that_sticks_is_told_with_its_line_and_the_tilt(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The cup is to lie on the coaster's own axes, which are y up, and so on its side."""
    tasks = tmp_path / "tasks"
    tasks.mkdir()
    text = (bundled() / "tasks" / "place_empty_cup.py").read_text()
    for old, new in (
        ('robot.scene.functional("coaster", 0)', 'robot.scene.pose("coaster")'),
        (", aim=Aim(spot, 0, ONTO)", ""),
        (", point=0, how=ONTO", ", how=ONTO"),
    ):
        assert old in text
        text = text.replace(old, new)
    (tasks / "my_cup.py").write_text(text)
    rim = bundled() / "tasks" / "_by_the_rim.py"
    (tasks / rim.name).write_text(rim.read_text())
    monkeypatch.setenv("RTPHYS_LIBRARY", str(tmp_path))
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
