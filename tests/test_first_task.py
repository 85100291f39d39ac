"""docs/first_task.md: its task solves, and what it says goes wrong does go wrong."""

from pathlib import Path

import pytest

from pages import ROOT, parts
from rtphys.assets.pack import default_pack
from rtphys.episode.generate import attempt
from rtphys.spec.episode import EpisodeSpec
from rtphys.task.spec import load_task

pytestmark = pytest.mark.sim
PAGE = ROOT / "docs" / "first_task.md"


@pytest.fixture
def written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The page's task in a library of its own."""
    (code,) = [part for part in parts(PAGE) if part.file]
    path = tmp_path / code.file
    path.parent.mkdir(parents=True)
    path.write_text(code.text)
    monkeypatch.setenv("RTPHYS_LIBRARY", str(path.parents[1]))
    return path


def outcomes(path: Path, protocol: str) -> list[str]:
    """Reasons of the first four seeds; empty of those that are solved."""
    spec, task = EpisodeSpec(path.stem, protocol), load_task(path.stem)
    return [attempt(spec.at(seed), task, default_pack()).reason for seed in range(4)]


@pytest.mark.parametrize(("protocol", "least"), [("clean", 4), ("phys_random", 3)])
def test_the_task_solves(written: Path, protocol: str, least: int) -> None:
    assert outcomes(written, protocol).count("") >= least


def test_a_target_with_the_books_orientation_is_out_of_reach(written: Path) -> None:
    right = 'robot.scene.on_top("book")'
    text = written.read_text()
    assert right in text
    book = f'Pose({right}.p, robot.scene.pose("book").q)'
    text = text.replace(right, book).replace("    Placing,", "    Placing,\n    Pose,")
    written.write_text(text)
    assert set(outcomes(written, "clean")) <= {"unreachable", "no_path"}
