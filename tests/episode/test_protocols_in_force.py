"""The same seed under every protocol: one layout, one look, and both in force."""

from pathlib import Path

import numpy as np
import pytest

from rtphys.assets.pack import default_pack
from rtphys.episode.generate import Instance, attempt, prepare, settle
from rtphys.physics import disagreements
from rtphys.spec.episode import EpisodeSpec
from rtphys.spec.protocol import BUILTIN
from rtphys.task.spec import load_task

PACK = default_pack()
pytestmark = pytest.mark.sim

NAMES = tuple(row.name for row in BUILTIN)
TASKS = ("click_bell", "grab_roller", "stack_blocks_two")


def under(name: str, seed: int, protocol: str) -> Instance:
    return prepare(EpisodeSpec(name, protocol).at(seed), load_task(name), PACK)


@pytest.mark.parametrize("name", (*TASKS, "open_laptop"))
def test_the_layout_of_a_seed_is_the_same_in_all_four(name: str) -> None:
    for seed in range(3):
        places = []
        for protocol in NAMES:
            world = under(name, seed, protocol).world
            # Heights follow object_scale; where a thing stands on the table does not.
            places.append({n: world.to_task(o.pose) for n, o in world.objects.items()})
        for other in places[1:]:
            assert other.keys() == places[0].keys()
            for n, pose in places[0].items():
                assert np.allclose(other[n].p[:2], pose.p[:2], atol=1e-6), n
                assert other[n].angle_to(pose) < 1e-3, n


@pytest.mark.parametrize("name", TASKS)
def test_the_look_of_a_seed_is_the_same_with_and_without_physics(name: str) -> None:
    for seed in range(3):
        plain, both = (under(name, seed, p) for p in ("official_random", "phys_random_all"))
        assert plain.look.to_json() == both.look.to_json()
        assert plain.world.clutter.keys() == both.world.clutter.keys()
        for n, thing in plain.world.clutter.items():
            p = plain.world.to_task(thing.pose).p
            q = both.world.to_task(both.world.clutter[n].pose).p
            assert np.allclose(p, q, atol=1e-6), "object_scale or tilt moved clutter on the table"
        assert not under(name, seed, "phys_random").world.clutter


def test_physics_of_a_seed_is_the_same_with_and_without_a_look() -> None:
    for name in TASKS:
        plain, both = (under(name, 1, p) for p in ("phys_random", "phys_random_all"))
        assert plain.physics == both.physics
        assert disagreements(both.world, both.physics) == []


def test_clutter_rests_obeys_friction_and_tilt_but_not_the_objects_own_physics() -> None:
    held = {"friction": 0.37, "table_tilt": 1.5, "object_scale": 0.9, "object_mass": 3.0}
    plain = EpisodeSpec("click_bell", "official_random").at(2)
    recipe = EpisodeSpec("click_bell", "phys_random_all", tuple(held), held).at(2)
    task = load_task("click_bell")
    nominal, varied = (prepare(r, task, PACK).world for r in (plain, recipe))
    assert len(varied.clutter) >= 3
    for name, thing in varied.clutter.items():
        friction = {m[:2] for s in thing.surfaces for m in s.materials()}
        assert np.allclose(list(friction), 0.37)
        own = nominal.clutter[name]
        assert [b.mass for b in thing.bodies] == [b.mass for b in own.bodies]
        up = varied.X_WT.R[:, 2]
        assert np.allclose(thing.pose.R[:, 1], up, atol=1e-5), "it stands on the tilted table"
    instance = prepare(recipe, task, PACK)
    settle(instance)
    for thing in instance.world.clutter.values():
        assert np.linalg.norm(thing.bodies[0].component.linear_velocity) < 0.01


@pytest.mark.parametrize("physics", [False, True])
def test_what_is_only_seen_changes_no_state(
    physics: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "protocols").mkdir()
    rules = "{textures: true, light_colours: true, flicker_rate: 1}"
    text = f"physics: {str(physics).lower()}\nvisual: {rules}\n"
    (tmp_path / "protocols" / "seen_only.yaml").write_text(text)
    monkeypatch.setenv("RTPHYS_LIBRARY", str(tmp_path))
    task, hashes = load_task("click_bell"), []
    for protocol in ("phys_random" if physics else "clean", "seen_only", "official_random"):
        tried = attempt(EpisodeSpec("click_bell", protocol).at(0), task, PACK)
        assert tried.recording is not None
        hashes.append(tried.recording.hash)
    assert hashes[0] == hashes[1]
    assert hashes[0] != hashes[2], "clutter and the table's height are part of the state"
