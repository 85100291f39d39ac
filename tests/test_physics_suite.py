"""The physics suite: nothing but a hidden attribute tells what to do, and it can be found out."""

from dataclasses import fields
from itertools import islice

import pytest

from rtphys.assets.pack import Pack
from rtphys.core import library
from rtphys.core.poses import Pose
from rtphys.episode.policy_episode import PolicyEpisode, begin
from rtphys.physics.load import domain_for_task
from rtphys.physics.reach import split
from rtphys.policies.registry import open_policy
from rtphys.spec.episode import EpisodeSpec
from rtphys.task.props import Prop
from rtphys.task.spec import load_task

SUITE = library.suites()["physics"]
# Task -> its hidden keys: several props that differ, or one whose value decides how to move.
HIDDEN = {
    name: sorted(key for key in domain_for_task(name).by_prop.keys if "@" in key) for name in SUITE
}
CHOICES = [name for name, keys in HIDDEN.items() if len({split(key)[0] for key in keys}) == 1]
COMPARED = [name for name in CHOICES if len(HIDDEN[name]) > 1]
OTHERS = [name for name in SUITE if name not in COMPARED]


def played(name: str, policy: str, seed: int, pack: Pack, protocol: str = "clean") -> PolicyEpisode:
    # As `evaluate` begins it: rows are kept by who needs them.
    spec = EpisodeSpec(name, protocol)
    episode = begin(spec.at(seed), load_task(name), pack, keep="hash")
    open_policy(policy).play(episode)
    return episode


def looks(prop: Prop) -> dict[str, object]:
    """All of a prop that a picture could show, but where it is."""
    return {f.name: getattr(prop, f.name) for f in fields(prop) if f.name not in ("name", "pose")}


def test_eight_tasks_hide_something_and_five_kinds_of_it() -> None:
    assert len(SUITE) == 8
    assert all(HIDDEN.values())
    kinds = {split(key)[0] for keys in HIDDEN.values() for key in keys}
    assert kinds == {
        "center_of_mass", "friction", "object_joint_damping", "object_mass", "restitution",
    }  # fmt: skip


@pytest.mark.parametrize("name", COMPARED)
def test_props_that_differ_look_alike(name: str) -> None:
    for seed in range(10):
        props = {prop.name: prop for prop in load_task(name).props(seed)}
        shown = [looks(props[split(key)[1]]) for key in HIDDEN[name]]
        assert all(one == shown[0] for one in shown)


@pytest.mark.parametrize("name", COMPARED)
def test_neither_name_nor_place_tells_which_is_which(name: str) -> None:
    keys, episodes = HIDDEN[name], 100
    by_name = by_place = 0
    for seed in range(episodes):
        props = {prop.name: prop for prop in load_task(name).props(seed)}
        drawn = EpisodeSpec(name, "clean").draw(seed)
        largest = max(keys, key=drawn.scalar)
        leftmost = min(keys, key=lambda key: props[split(key)[1]].pose.p[0])
        by_name += largest == keys[0]
        by_place += largest == leftmost
    fair = episodes / len(keys)
    spread = 4 * (fair * (1 - 1 / len(keys))) ** 0.5  # of a fair draw, one in 16,000 is further off
    assert abs(by_name - fair) < spread
    assert abs(by_place - fair) < spread


@pytest.mark.parametrize("name", OTHERS)
def test_what_one_prop_hides_moves_nothing_that_is_seen(name: str) -> None:
    key = next(key for key in HIDDEN[name] if key.startswith(("center_of_mass", "friction@puck")))
    values = ((0.03, 0.0, 0.0), (-0.03, 0.0, 0.0)) if "mass" in key else (0.05, 0.1)
    layouts = []
    for value in values:
        spec = EpisodeSpec(name, "clean", overrides={key: value})
        assert spec.draw(3)[key] == value
        layouts.append([(p.name, *_plain(p.pose), looks(p)) for p in load_task(name).props(3)])
    assert layouts[0] == layouts[1]


def _plain(pose: Pose) -> tuple[list[float], list[float]]:
    return pose.p.tolist(), pose.q.tolist()


@pytest.mark.sim
@pytest.mark.parametrize("name", SUITE)
@pytest.mark.parametrize("policy", ["expert", pytest.param("feels", marks=pytest.mark.slow)])
def test_who_knows_it_succeeds_and_so_does_who_feels_it(name: str, policy: str, pack: Pack) -> None:
    successes = (seed for seed in range(2000, 2003) if played(name, policy, seed, pack).success)
    assert len([*islice(successes, 2)]) == 2, f"{policy} solves fewer than two of three"


@pytest.mark.sim
@pytest.mark.parametrize("name", COMPARED)
def test_who_takes_the_one_for_the_other_fails(name: str, pack: Pack) -> None:
    keys = HIDDEN[name]
    truth = EpisodeSpec(name, "clean").draw(2000)
    turned = dict(zip(keys, sorted((truth.scalar(k) for k in keys), reverse=True), strict=True))
    ranks = sorted(keys, key=truth.scalar)
    belief = "+".join(f"{key}={value}" for key, value in zip(ranks, turned.values(), strict=True))
    assert not played(name, f"expert:{belief}", 2000, pack).success
    assert played(name, "expert", 2000, pack).success


@pytest.mark.sim
@pytest.mark.slow
@pytest.mark.parametrize("name", SUITE)
@pytest.mark.parametrize("policy", ["idle", "random", "jitter"])
def test_who_does_nothing_with_sense_fails(name: str, policy: str, pack: Pack) -> None:
    assert not any(played(name, policy, seed, pack).success for seed in range(2000, 2005))
