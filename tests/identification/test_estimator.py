"""Estimators by name: the baseline, or a class in a file; what is neither is refused."""

from pathlib import Path

import pytest

from rtphys.core.errors import BadFile, BadValue, UnknownName
from rtphys.identification.estimator import Trees, open_estimator, short_name

CODE = """
class Mine:
    def fit(self, X, y): self.mean = y.mean()
    def predict(self, X): return X[:, 0] * 0 + self.mean

class NoPredict:
    def fit(self, X, y): ...
"""


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "mine.py"
    path.write_text(CODE)
    return path


def test_estimators_are_opened_by_name(file: Path) -> None:
    assert open_estimator("trees") is Trees
    assert open_estimator(f"python:{file}:Mine").__name__ == "Mine"  # type: ignore[attr-defined]
    assert short_name(f"python:{file}:Mine") == "Mine"


def test_what_is_no_estimator_is_refused(file: Path) -> None:
    for spec in ("forest", "python:mine.py", f"python:{file}:NoPredict"):
        with pytest.raises(BadValue, match="estimator"):
            open_estimator(spec)
    with pytest.raises(UnknownName, match="Mine"):
        open_estimator(f"python:{file}:Mina")
    with pytest.raises(BadFile, match="no such estimator file"):
        open_estimator(f"python:{file.parent / 'other.py'}:Mine")
