"""Every test of data has a cache of its own; a sound dataset is shared."""

from pathlib import Path

import pytest
from collected import collect, run_ahead


@pytest.fixture(autouse=True)
def _own_cache(tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> None:
    """What one test found sound is nothing to the next."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path_factory.mktemp("cache")))


@pytest.fixture
def ahead(tmp_path: Path) -> Path:
    """Three episodes, of which the manifest counts two."""
    run_ahead(tmp_path / "ahead")
    return tmp_path / "ahead"


@pytest.fixture(scope="session")
def three(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three episodes of four seeds, which no test changes."""
    out = tmp_path_factory.mktemp("three")
    collect(out, 3)
    return out
