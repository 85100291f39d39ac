"""Imports that wait until something is used."""

import sys
from pathlib import Path

import pytest

from rtphys.core.deferred import deferred


@pytest.fixture
def library(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """A package whose top imports a submodule of another."""
    (tmp_path / "heavy_one").mkdir()
    (tmp_path / "heavy_one" / "__init__.py").write_text("loaded = True\n")
    (tmp_path / "heavy_one" / "part.py").write_text("value = 3\n")
    text = (
        "import heavy_one\nimport heavy_one.part as part\n\n\ndef use():\n    return part.value\n"
    )
    (tmp_path / "light_one.py").write_text(text)
    monkeypatch.syspath_prepend(str(tmp_path))
    return "heavy_one"


def test_nothing_is_loaded_until_it_is_used(library: str) -> None:
    with deferred(library, f"{library}.part"):
        import light_one  # pyright: ignore[reportMissingImports]
    assert not [name for name in sys.modules if name.startswith(library)]
    assert light_one.use() == 3
    assert sys.modules[library].loaded and sys.modules[f"{library}.part"].value == 3


def test_what_is_used_at_once_or_loaded_already_is_no_stand_in() -> None:
    with deferred("colorsys", "json"):
        import colorsys
        import json

        assert colorsys.ONE_THIRD == 1 / 3
        assert json is sys.modules["json"] and json.loads("1") == 1
    assert sys.modules["colorsys"].rgb_to_hsv(0, 0, 0) == (0, 0, 0)
