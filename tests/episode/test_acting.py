"""Which attributes act in an episode: known beforehand from its props, true in its world."""

from typing import Any

import pytest

from rtphys.assets.pack import default_pack
from rtphys.core import library
from rtphys.core.errors import Infeasible
from rtphys.episode.assemble import label as label_of
from rtphys.episode.generate import Instance, attempt, prepare
from rtphys.physics import attributes, could_act
from rtphys.physics.attribute import Part
from rtphys.spec.episode import EpisodeSpec
from rtphys.task.props import parts
from rtphys.task.spec import load_task

CAMERA = {"camera_angle", "camera_distance"}


def instance_of(name: str, protocol: str = "phys_random") -> Instance:
    task = load_task(name)
    for seed in range(20):
        try:
            return prepare(EpisodeSpec(name, protocol).at(seed), task, default_pack())
        except Infeasible:
            continue
    raise AssertionError(f"no seed of {name} has a world")


@pytest.mark.sim
@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(library.names("tasks")))
def test_the_props_tell_what_the_world_has(name: str) -> None:
    instance = instance_of(name)
    world = instance.world
    objects = world.objects.values()
    has: dict[str, dict[Part, bool]] = {
        o.name: {"bodies": bool(o.bodies), "joints": bool(o.joints), "surfaces": bool(o.surfaces)}
        for o in objects
    }
    expected = {name: {part for part, there in own.items() if there} for name, own in has.items()}
    assert parts(instance.props) == expected
    readings = {key: bool(a.read(world)) for key, a in attributes().items() if key not in CAMERA}
    acts = could_act(instance.physics, parts(instance.props))
    assert {key for key, read in readings.items() if read} == acts - CAMERA


@pytest.mark.sim
@pytest.mark.parametrize(
    ("name", "inert"),
    [
        ("click_bell", {"object_mass", "center_of_mass", "external_force", "object_joint_damping"}),
        ("stack_blocks_two", {"object_joint_damping"}),
        ("open_laptop", set()),
    ],
)
def test_a_label_says_what_acts(name: str, inert: set[str]) -> None:
    label = label_of(instance_of(name))["attributes"]
    assert isinstance(label, dict)
    assert {key for key, one in label.items() if not one["could_act"]} - CAMERA == inert


def test_a_camera_attribute_acts_in_its_own_modes() -> None:
    spec = EpisodeSpec("click_bell", "phys_random")
    for seed in range(30):
        physics = spec.draw(seed)
        acts = could_act(physics, {}) & CAMERA
        turns = physics["camera_mode"] == "rotate"
        assert acts == ({"camera_angle"} if turns else {"camera_distance"})
    held = {"camera_mode": "orbit", "camera_angle": 3.0}
    assert could_act(EpisodeSpec("click_bell", "phys_random", overrides=held).draw(1), {}) >= CAMERA
    assert could_act(EpisodeSpec("click_bell", "clean").draw(0), {}) >= CAMERA, (
        "nominal, and they could be set"
    )


def demonstrated(task: str, seed: int, **held: float) -> tuple[dict[str, Any], str, Instance]:
    """What the label says of each attribute, the hash of the states, and where they were."""
    spec = EpisodeSpec(task, "phys_random", overrides=held)
    one = attempt(spec.at(seed), load_task(task), default_pack(), happened=True)
    assert one.instance is not None and one.recording is not None
    label: Any = label_of(one.instance, one.recording.happened)
    return label["attributes"], one.recording.hash, one.instance


@pytest.mark.sim
@pytest.mark.parametrize(
    ("task", "ever"),
    [
        ("turn_switch", False),
        pytest.param("open_microwave", False, marks=pytest.mark.slow),
        pytest.param("grab_roller", False, marks=pytest.mark.slow),
        pytest.param("dump_bin_bigbin", True, marks=pytest.mark.slow),
        ("place_mouse_pad", True),
        pytest.param("beat_block_hammer", True, marks=pytest.mark.slow),
    ],
)
def test_restitution_has_acted_unless_the_states_are_the_same_without_it(
    task: str, ever: bool
) -> None:
    """`acted` is measured in one episode, and tested by another value in the same one."""
    acted = set[bool]()
    for seed in (1, 2):
        tried = [demonstrated(task, seed, restitution=e) for e in (0.0, 0.5)]
        acts = [labels["restitution"]["acted"] for labels, _, _ in tried]
        if not all(acts):
            assert acts[0] == acts[1] and tried[0][1] == tried[1][1]
        acted |= set(acts)
    assert acted == {ever}


@pytest.mark.sim
def test_what_moves_in_an_episode_has_acted() -> None:
    label, _, instance = demonstrated("open_laptop", 1)
    for key in ("object_joint_damping", "arm_joint_damping", "gripper_joint_damping"):
        assert label[key]["acted"] is True
    assert label["friction"]["acted"] is None  # not measured
    before = label_of(instance)["attributes"]
    assert isinstance(before, dict)
    assert before["restitution"]["acted"] is None
