"""A library of one's own, for tests of all studies."""

from collections.abc import Callable
from pathlib import Path

import pytest

OwnTask = Callable[[str, str], None]


@pytest.fixture
def own_task(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> OwnTask:
    """Adds a task file to it: a name, and the text."""
    folder = tmp_path / "own" / "tasks"

    def add(name: str, text: str) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        (folder / f"{name}.py").write_text(text)
        monkeypatch.setenv("RTPHYS_LIBRARY", str(folder.parent))

    return add
