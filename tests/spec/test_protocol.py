"""The table of protocols and a user's own rows."""

from dataclasses import replace
from pathlib import Path

import pytest

from rtphys.core.errors import BadFile, RtphysError, UnknownName
from rtphys.physics.attribute import attributes
from rtphys.physics.load import load_domain
from rtphys.spec.episode import EpisodeSpec
from rtphys.spec.protocol import (
    BUILTIN,
    OFFICIAL,
    SEVERITIES,
    VisualRandomization,
    load_look,
    load_protocol,
    protocols,
)


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
    assert load_protocol("dim").visual == VisualRandomization(clutter=3)
    assert load_protocol("dim").physics
    assert protocols()["all"].visual == OFFICIAL
    assert EpisodeSpec("grab_roller", "dim").at(0).spec.domain.name == "grab_roller"
    assert EpisodeSpec("grab_roller", "all").at(0).spec.domain.rules == {}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("visual: {cluter: 3}", "did you mean 'clutter'"),
        ("visual: {clutter: 1.5}", "clutter: input should be a valid integer"),
        ("visual: {clutter: 21}", "clutter = 21 is not allowed; at most 20"),
        ("visual: {textures: 1}", "textures: input should be a valid boolean"),
        ("visual: {table_drop: -0.01}", "table_drop = -0.01 .*at least 0"),
        ("visual: {flicker_rate: .nan}", "flicker_rate = nan"),
        ("visual: 3", "mapping"),
        ("physics: maybe", "physics: input should be a valid boolean"),
        ("textures: true", "unknown key of a protocol 'textures'.*visual"),
        ("physics: true\nonly: frictoin", "did you mean 'friction'"),
        ("physics: true\nwidth: 1.5", "width = 1.5 .*at most 1"),
        ("physics: true\nwidth: wide", "width: input should be a valid number"),
        ("physics: true\nvisual: {table_drop: 0.01}", "table_drop = 0.01 .*leave table_drop out"),
        ("only: friction", "only = .*physics: true"),
    ],
)
def test_a_wrong_file_is_refused_by_name(library: Path, text: str, message: str) -> None:
    (library / "mine.yaml").write_text(text)
    with pytest.raises(RtphysError, match=message) as caught:
        load_protocol("mine")
    assert "mine.yaml" in str(caught.value)


@pytest.mark.parametrize("name", ["clean", "only_friction"])
def test_a_builtin_name_is_not_taken_twice(library: Path, name: str) -> None:
    (library / f"{name}.yaml").write_text("physics: true\n")
    with pytest.raises(BadFile, match="builtin"):
        protocols()


def test_rules_survive_json() -> None:
    for rules in (OFFICIAL, replace(OFFICIAL, draw=3)):
        assert VisualRandomization.from_json(rules.to_json()) == rules
    assert "draw" not in OFFICIAL.to_json()  # stored rules and certified lists know no such key


def test_a_look_may_be_drawn_anew() -> None:
    assert load_look("official_random") == OFFICIAL
    assert load_look("official_random.12") == replace(OFFICIAL, draw=12)
    assert load_look("clean.3") == VisualRandomization()  # nothing is drawn
    for name in ("official_randm.3", "official_random.", "official_random.x"):
        with pytest.raises(UnknownName, match="did you mean 'official_random'"):
            load_look(name)


def test_one_attribute_varies_alone_with_the_draw_it_has_among_all() -> None:
    for key in attributes():
        spec = EpisodeSpec("open_microwave", f"only_{key}")
        assert spec.domain.keys == [key] and spec.visual() is None
    every, alone = (
        EpisodeSpec("open_microwave", name).draw(7) for name in ("phys_random", "only_friction")
    )
    assert alone["friction"] == every["friction"] and alone.varied == {"friction"}
    assert alone["object_mass"] == 1.0


def test_what_follows_another_attribute_has_its_range_when_alone() -> None:
    domain = EpisodeSpec("click_bell", "only_gripper_joint_damping").domain
    assert domain.rule("gripper_joint_damping") == load_domain("global").rule("arm_joint_damping")


@pytest.mark.parametrize("percent", SEVERITIES)
def test_a_severity_draws_the_same_point_of_narrower_ranges(percent: int) -> None:
    full = EpisodeSpec("click_bell", "phys_random_all").draw(11)
    part = EpisodeSpec("click_bell", f"severity_{percent}").draw(11)
    assert part.varied == full.varied
    for key, attribute in attributes().items():
        middle, value, narrow = attribute.nominal, full[key], part[key]
        if isinstance(value, float):  # the asset's own: towards the range's lower end, 0
            about = middle if isinstance(middle, float) else 0.0
            assert narrow == pytest.approx(about + percent / 100 * (value - about))
        else:
            assert narrow == pytest.approx([percent / 100 * x for x in value])


def test_the_widest_severity_is_the_paper_itself() -> None:
    whole, paper = (EpisodeSpec("click_bell", name) for name in ("severity_100", "phys_random_all"))
    assert whole.domain.digest == paper.domain.digest and whole.visual() == paper.visual()


def test_a_library_may_narrow_and_pick(library: Path) -> None:
    (library / "mild.yaml").write_text("physics: true\nonly: [friction]\nwidth: 0.5\n")
    interval = EpisodeSpec("click_bell", "mild").domain.rule("friction").interval
    assert (interval.low, interval.high) == pytest.approx((0.255, 0.875))
