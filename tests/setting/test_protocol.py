"""The table of protocols and a user's own rows."""

from pathlib import Path

import pytest

from rtphys.core.errors import BadFile, BadValue, UnknownName
from rtphys.setting.protocol import BUILTIN, OFFICIAL, VisualRules, load_protocol, protocols
from rtphys.setting.setting import Setting


@pytest.fixture
def library(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "protocols").mkdir()
    monkeypatch.setenv("RTPHYS_LIBRARY", str(tmp_path))
    return tmp_path / "protocols"


def test_both_dimensions_stand_alone_and_together() -> None:
    rows = {(row.visual is not None, row.physics) for row in BUILTIN}
    assert len(rows) == len(BUILTIN) == 4


def test_a_library_adds_rows(library: Path) -> None:
    (library / "dim.yaml").write_text("what: dark\nphysics: true\nvisual: {clutter: 3}\n")
    (library / "all.yaml").write_text("visual: official\n")
    assert load_protocol("dim").visual == VisualRules(clutter=3)
    assert load_protocol("dim").physics
    assert protocols()["all"].visual == OFFICIAL
    assert Setting("grab_roller", "dim").at(0).setting.domain.name == "grab_roller"
    assert Setting("grab_roller", "all").at(0).setting.domain.rules == {}


@pytest.mark.parametrize(
    ("text", "error", "message"),
    [
        ("visual: {cluter: 3}", UnknownName, "did you mean 'clutter'"),
        ("visual: {clutter: 1.5}", BadValue, "from 0 to 20"),
        ("visual: {textures: 1}", BadValue, "true or false"),
        ("visual: {table_drop: -0.01}", BadValue, "table_drop"),
        ("visual: {flicker_rate: .nan}", BadValue, "flicker_rate"),
        ("visual: 3", BadValue, "mapping"),
        ("physics: maybe", BadValue, "physics"),
        ("textures: true", UnknownName, "visual"),
    ],
)
def test_a_wrong_file_is_refused_by_name(
    library: Path, text: str, error: type[Exception], message: str
) -> None:
    (library / "mine.yaml").write_text(text)
    with pytest.raises(error, match=message) as caught:
        load_protocol("mine")
    assert "mine.yaml" in str(caught.value)


def test_a_builtin_name_is_not_taken_twice(library: Path) -> None:
    (library / "clean.yaml").write_text("physics: true\n")
    with pytest.raises(BadFile, match="builtin"):
        protocols()


def test_an_unknown_name_gets_a_suggestion() -> None:
    with pytest.raises(UnknownName, match="phys_random"):
        _ = Setting("click_bell", "phys_randm").domain
    with pytest.raises(UnknownName, match="unseen"):
        Setting("click_bell", "clean", split="unsen")


def test_rules_survive_json() -> None:
    assert VisualRules.from_json(OFFICIAL.to_json()) == OFFICIAL
