"""Experiments of laws are found by the key of their attribute."""

import importlib
from types import ModuleType

import pytest

from rtphys.laws import law


def test_what_an_experiment_lacks_is_not_the_experiment(monkeypatch: pytest.MonkeyPatch) -> None:
    known = importlib.import_module

    def lacking(name: str) -> ModuleType:
        if name == "rtphys.laws.friction":
            raise ModuleNotFoundError("No module named 'manifold3d'", name="manifold3d")
        return known(name)

    monkeypatch.setattr(importlib, "import_module", lacking)
    with pytest.raises(ModuleNotFoundError, match="manifold3d"):
        law.law_test("friction")
