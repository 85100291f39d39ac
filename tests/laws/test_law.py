"""Experiments of laws are found by the key of their attribute."""

import importlib
from pathlib import Path
from types import ModuleType

import pytest

from rtphys.assets.pack import builtin_pack
from rtphys.core.errors import BadFile, UnknownName
from rtphys.laws import law
from rtphys.laws.lab import Lab


def test_what_an_experiment_lacks_is_not_the_experiment(monkeypatch: pytest.MonkeyPatch) -> None:
    known = importlib.import_module

    def lacking(name: str) -> ModuleType:
        if name == "rtphys.laws.friction":
            raise ModuleNotFoundError("No module named 'manifold3d'", name="manifold3d")
        return known(name)

    monkeypatch.setattr(importlib, "import_module", lacking)
    with pytest.raises(ModuleNotFoundError, match="manifold3d"):
        law.law_test("friction")


OWN = """from rtphys.laws.law import LawTest


def run(lab, value, others):
    {body}


LAW = LawTest(key="friction", law="mu", settings={settings}, run=run)
"""


@pytest.mark.parametrize(
    ("body", "settings", "problem"),
    [
        ("return 1 / 0", "(1.0,)", "raises ZeroDivisionError: division by zero (line 5)"),
        ("return None", "(1.0,)", "raises TypeError: 'NoneType' object is not iterable"),
        ("return []", "(1.0,)", "its run must return one or more Trial"),
        ("return [0.5]", "(1.0,)", "its run must return one or more Trial"),
        ("return []", "()", "LAW: settings = () is not allowed; name a value"),
    ],
)
def test_mistakes_of_an_experiment_of_ones_own_are_named(
    body: str, settings: str, problem: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "laws" / "friction.py"
    file.parent.mkdir()
    file.write_text(OWN.format(body=body, settings=settings))
    monkeypatch.setenv("RTPHYS_LIBRARY", str(tmp_path))
    with pytest.raises(BadFile) as refused:
        next(law.trials_of(Lab(builtin_pack()), law.law_test("friction")))
    assert str(refused.value) == f"{file}: {problem}"


def test_what_an_experiment_excepts_is_an_attribute(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A misspelt one was varied all the same."""
    file = tmp_path / "laws" / "friction.py"
    file.parent.mkdir()
    text = OWN.format(body="return []", settings="(1.0,), except_for={'external_forces': None}")
    file.write_text(text)
    monkeypatch.setenv("RTPHYS_LIBRARY", str(tmp_path))
    with pytest.raises(UnknownName, match="did you mean 'external_force'") as refused:
        law.law_test("friction")
    assert str(file) in str(refused.value)
