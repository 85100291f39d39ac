"""What `collect` says of a run before it begins is what the labels will say."""

from pathlib import Path

import pytest

from rtphys.spec.collection import CollectionSpec
from rtphys.spec.episode import EpisodeSpec
from rtphys.spec.varies import what_varies
from rtphys.studies.requests import specs_for

OWN = Path(__file__).parents[2] / "examples" / "own_attributes"
LOOKS = "textures, lights and clutter vary"


def lines(
    *tasks: str, sweep: str = "", twin: str | None = None, **episode: object
) -> tuple[str, ...]:
    template = CollectionSpec(EpisodeSpec(**episode), twin=twin)  # type: ignore[arg-type]
    return tuple(what_varies(specs_for(template, tasks or ("click_bell",), sweep)))


@pytest.mark.parametrize(
    ("episode", "said"),
    [
        ({"protocol": "clean"}, "protocol clean: nothing varies but the layout"),
        ({}, f"protocol phys_random_all: all 13 attributes vary; {LOOKS}"),
        ({"only": ("friction",)}, "protocol only_friction: friction varies; looks are nominal"),
        (
            {"protocol": "clean", "only": ("friction", "table_tilt")},
            "protocol clean: friction, table_tilt vary; looks are nominal",
        ),
        (
            {"protocol": "phys_random", "overrides": {"friction": 0.2}},
            "protocol phys_random: all 13 attributes but friction vary; friction is held at 0.2; "
            "looks are nominal",
        ),
        (
            {"protocol": "clean", "overrides": {"center_of_mass": (0.0, 0.0, 0.01)}},
            "protocol clean: center_of_mass is held at (0, 0, 0.01); "
            "nothing else varies but the layout",
        ),
        (
            {"protocol": "clean", "sweep": "friction=0.05,0.3,0.8"},
            "protocol clean: friction is swept: 0.05, 0.3, 0.8; nothing else varies but the layout",
        ),
        (
            {"protocol": "clean", "overrides": {"friction": 2.0}},
            "protocol clean: friction is held at 2 (domain global: [0.01, 1.25]); "
            "nothing else varies but the layout",
        ),
        (
            {"protocol": "clean", "sweep": "gripper_joint_damping=1,5"},
            "protocol clean: gripper_joint_damping is swept: 1, 5 (domain global: [0.5, 3]); "
            "nothing else varies but the layout",
        ),
        (
            {"only": ("friction",), "sweep": "friction=0.1,0.2"},
            "protocol only_friction: friction is swept: 0.1, 0.2; "
            "nothing else varies but the layout",
        ),
        (
            {"protocol": "official_random"},
            f"protocol official_random: table_height varies with the look; {LOOKS}",
        ),
        (
            {"protocol": "severity_25"},
            f"protocol severity_25: all 13 attributes vary in 25 % of their ranges; {LOOKS}",
        ),
    ],
    ids=str,
)
def test_one_line_says_what_is_drawn_held_and_swept(episode: dict[str, object], said: str) -> None:
    assert lines(**episode) == (said,)  # type: ignore[arg-type]


def test_a_domain_that_is_named_varies_no_more_than_the_protocol_draws(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("RTPHYS_LIBRARY", str(OWN))
    assert lines(only=("linear_drag",), ranges="thick_air") == (
        "protocol only_linear_drag: linear_drag varies (domain thick_air); looks are nominal",
    )
    (line,) = lines(protocol="phys_random")
    assert "all 16 attributes but actuator_latency, gravity, linear_drag vary" in line


@pytest.mark.parametrize(
    ("episode", "said"),
    [
        (
            {"only": ("friction",)},
            "protocol only_friction: friction varies; object_mass@first, object_mass@second vary "
            "too: the task draws that under every protocol; looks are nominal",
        ),
        (
            {"only": ("friction", "restitution")},
            "protocol clean: friction, restitution vary; object_mass@first, object_mass@second are "
            "nominal, although the task draws that elsewhere; looks are nominal",
        ),
        (
            {"only": ("object_mass@first",)},
            "protocol clean: object_mass@first varies; object_mass@second is nominal, although the "
            "task draws that elsewhere; looks are nominal",
        ),
        (
            {"only": ("object_mass",)},
            "protocol only_object_mass: object_mass, object_mass@first, object_mass@second vary; "
            "looks are nominal",
        ),
    ],
    ids=str,
)
def test_what_a_task_draws_of_single_props_is_named_apart(
    episode: dict[str, object], said: str
) -> None:
    assert lines("heavy_below", **episode) == (said,)  # type: ignore[arg-type]
    varied = EpisodeSpec("heavy_below", **episode).draw(7).varied  # type: ignore[arg-type]
    drawn = said.partition("nominal, although")[0].rpartition(";")[0] or said
    for key in ("object_mass@first", "object_mass@second"):
        assert (key in varied) == (key in drawn)


def test_a_twin_has_a_line_of_its_own() -> None:
    """One without physics holds nothing; one with physics holds the same."""
    held = {"protocol": "phys_random", "overrides": {"friction": 0.2}}
    assert lines(twin="clean", **held)[1:] == ("twin clean: nothing varies but the layout",)
    assert "friction is held at 0.2" in lines(twin="phys_random_all", **held)[1]


def test_tasks_that_differ_are_named() -> None:
    """A domain that gives an attribute one value varies it in no episode."""
    many, one = lines("click_bell", "lift_pot", "put_object_cabinet", protocol="phys_random")
    assert many == (
        "protocol phys_random: all 13 attributes vary; looks are nominal (all other tasks)"
    )
    assert "all 13 attributes but arm_joint_damping, gripper_joint_damping, object_scale" in one
    assert one.endswith("(put_object_cabinet)")
    clean = lines("heavy_below", "click_bell", protocol="clean")
    assert clean[0].startswith("protocol clean: object_mass@first, object_mass@second vary")


@pytest.mark.parametrize(
    "episode",
    [
        {"protocol": "clean", "overrides": {"friction": 0.3}},
        {"only": ("friction",)},
        {"protocol": "official_random"},
        {"protocol": "phys_random"},
    ],
    ids=str,
)
def test_it_names_what_the_labels_call_varied(episode: dict[str, object]) -> None:
    spec = EpisodeSpec("click_bell", **episode)  # type: ignore[arg-type]
    varied = spec.draw(7).varied
    (line,) = lines(**episode)  # type: ignore[arg-type]
    named = {key for key in varied if key in line}
    assert named == varied or "all 13 attributes vary" in line
