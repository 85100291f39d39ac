"""The asset pack, a user's library, and a dataset to reproduce, for tests of all studies."""

from collections.abc import Callable
from pathlib import Path

import pytest
from quick_pool import in_process  # noqa: F401  (a fixture)

from rtphys.assets.pack import Pack, default_pack
from rtphys.data.attempts import read_attempts
from rtphys.spec.collection import CollectionSpec
from rtphys.spec.episode import EpisodeSpec
from rtphys.spec.recording import RecordingSpec
from rtphys.studies.collect import collect
from rtphys.studies.requests import Run

OwnTask = Callable[[str, str], None]


@pytest.fixture(scope="session")
def pack() -> Pack:
    return default_pack()


@pytest.fixture
def own_task(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> OwnTask:
    """Adds a task file to it: a name, and the text."""
    folder = tmp_path / "own" / "tasks"

    def add(name: str, text: str) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        (folder / f"{name}.py").write_text(text)
        monkeypatch.setenv("RTPHYS_LIBRARY", str(folder.parent))

    return add


@pytest.fixture(scope="session")
def honest(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Its seed 0 is rejected, since clutter does not come to rest; 1 and 2 have 74 frames each."""
    out = tmp_path_factory.mktemp("honest")
    spec = EpisodeSpec("press_stapler", "phys_random_all")
    collect([CollectionSpec(spec, RecordingSpec(("head",)), episodes=2)], Run(out, workers=1))
    (ledger,) = out.rglob("ledger.jsonl")
    assert [row.verdict for row in read_attempts(ledger)] == ["rejected", "accepted", "accepted"]
    return out
