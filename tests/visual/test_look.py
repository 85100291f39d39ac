"""The visual draw of a seed: from the seed alone, inside its rules, clear of the task."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

from rtphys.assets.pack import Pack, default_pack
from rtphys.core.seeds import Chance
from rtphys.spec.episode import EpisodeSpec
from rtphys.spec.protocol import OFFICIAL, VisualRandomization
from rtphys.task.draw import Spot
from rtphys.task.props import Mesh
from rtphys.task.spec import load_task
from rtphys.visual.clutter import (
    GROUPS,
    HALF_X,
    HALF_Y,
    LOW,
    ROOM,
    Piece,
    alike,
    disturbed,
    footprint,
    pieces,
)
from rtphys.visual.look import Look, backdrop, draw_look, problems

SEEDS = range(40)
TASKS = ("click_bell", "stack_blocks_two", "open_laptop", "grab_roller")


def look(name: str, seed: int, pack: Pack, rules: VisualRandomization = OFFICIAL) -> Look:
    task = load_task(name)
    return draw_look(rules, Chance(seed, name), (task, task.props(seed)), pack, "seen")


def placed(one: Look, pack: Pack) -> list[tuple[Piece, np.ndarray]]:
    known = {(p.category, p.model): p for p in pieces(pack)}
    return [(known[p.category, p.model], p.pose.p) for p in one.clutter]


@pytest.mark.parametrize("name", TASKS)
def test_clutter_keeps_clear_of_the_task_and_of_itself(name: str, pack: Pack) -> None:
    task, counts = load_task(name), []
    for seed in SEEDS:
        found = placed(look(name, seed, pack), pack)
        counts.append(len(found))
        props = task.props(seed)
        for piece, p in found:
            assert abs(p[0] - task.table_shift[0]) + piece.radius <= HALF_X + 1e-9
            assert abs(p[1] - task.table_shift[1]) + piece.radius <= HALF_Y + 1e-9
            assert piece.height <= LOW or p[1] - piece.radius >= 0
            for prop in props:
                gap = footprint(prop, pack).distance(p[0], p[1]) - piece.radius
                # To the corner of a grown rectangle it is further than to the rectangle's side.
                assert gap >= ROOM - 1e-9
        for (a, at), (b, other) in combinations(found, 2):
            assert np.linalg.norm((at - other)[:2]) >= a.radius + b.radius
        named = {p.category for p in props if isinstance(p, Mesh)}
        assert named.isdisjoint(p.category for p, _ in found)
    assert max(counts) <= OFFICIAL.clutter
    assert np.mean(counts) > 2.5, "beside a laptop, whose lid swings, there is least room"


def test_keep_clear_is_kept_clear(pack: Pack) -> None:
    task = replace(load_task("click_bell"), keep_clear=(((-0.6, 0.6), (-0.35, 0.1)),))
    for seed in SEEDS:
        one = draw_look(OFFICIAL, Chance(seed), (task, task.props(seed)), pack, "seen")
        assert all(p[1] - piece.radius >= 0.1 for piece, p in placed(one, pack))


def test_look_alikes_stay_away() -> None:
    assert alike("114_bottle", {"001_bottle"}, False)
    assert alike("073_rubikscube", set(), True)
    assert not alike("073_rubikscube", {"050_bell"}, False)
    known = set(default_pack().names)
    assert not {name for group in GROUPS for name in group} - known


def test_equal_seeds_look_alike_and_others_differ(pack: Pack) -> None:
    looks = [look("click_bell", seed, pack).to_json() for seed in SEEDS]
    assert looks == [look("click_bell", seed, pack).to_json() for seed in SEEDS]
    assert len({str(one) for one in looks}) == len(looks)


def test_further_draws_move_textures_and_lights_alone(pack: Pack) -> None:
    draws = [look("click_bell", 5, pack, replace(OFFICIAL, draw=n)) for n in range(6)]
    assert len({str(one.backdrop.lights.directional) for one in draws}) == len(draws)
    assert len({one.table_texture for one in draws}) > 1
    assert len({str([(p.category, p.pose.p.tolist()) for p in one.clutter]) for one in draws}) == 1


def test_each_part_has_a_stream_of_its_own(pack: Pack) -> None:
    """Turning one rule off moves no other draw."""
    full = look("click_bell", 5, pack)
    bare = look("click_bell", 5, pack, replace(OFFICIAL, light_colours=False))
    assert bare.table_texture == full.table_texture
    assert [p.category for p in bare.clutter] == [p.category for p in full.clutter]
    assert bare.backdrop.lights.directional is None


def test_draws_are_spread_over_their_ranges() -> None:
    spec = EpisodeSpec("click_bell", "official_random")
    heights = [spec.draw(seed).scalar("table_height") for seed in range(400)]
    assert -0.03 <= min(heights) < -0.028
    assert -0.002 < max(heights) <= 0
    many = [backdrop(replace(OFFICIAL, flicker_rate=0.3), Chance(seed)) for seed in range(400)]
    assert 0.2 < np.mean([b.flickers for b in many]) < 0.4
    colours = np.array([b.lights.directional for b in many])
    assert colours.min() < 0.02
    assert colours.max() > 0.98


def test_a_flicker_is_the_same_every_time_it_is_drawn() -> None:
    wild = backdrop(replace(OFFICIAL, flicker_rate=1.0), Chance(7))
    assert wild.lights_at(3) == backdrop(replace(OFFICIAL, flicker_rate=1.0), Chance(7)).lights_at(
        3
    )
    assert wild.lights_at(3) != wild.lights_at(4)
    assert abs(wild.lights_at(3).ambient[0] - 0.5) <= 0.1
    still = backdrop(replace(OFFICIAL, flicker_rate=0.0), Chance(7))
    assert still.lights_at(3) == still.lights_at(4) == still.lights


def test_splits_share_no_picture(pack: Pack) -> None:
    task = load_task("click_bell")
    for seed in SEEDS:
        one = draw_look(OFFICIAL, Chance(seed), (task, task.props(seed)), pack, "unseen")
        assert all(
            n is None or n.startswith("unseen/") for n in (one.table_texture, one.wall_texture)
        )
    for place in ("table", "wall"):
        assert not set(pack.textures("seen", place)) & set(pack.textures("unseen", place))


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("flickers", True),
        ("clutter", [{}] * 11),
        ("table_texture", "unseen/tartan_090"),
    ],
)
def test_a_changed_label_is_found(key: str, value: object, pack: Pack) -> None:
    label = look("click_bell", 2, pack).to_json()
    chance = Chance(2, "click_bell")
    assert problems(label, OFFICIAL, chance) == []
    changed = {**label, key: value}
    assert any(f"visual.{key}" in text for text in problems(changed, OFFICIAL, chance))


def test_what_counts_as_disturbed() -> None:
    track = np.tile(np.r_[Spot(0.1, 0.2).pose().p, 1.0, 0, 0, 0], (5, 1))
    moved, tipped, turned, nudged = (track.copy() for _ in range(4))
    moved[2, 0] += 0.021  # and back
    tipped[3:, 3:] = (np.cos(np.radians(10)), np.sin(np.radians(10)), 0, 0)
    turned[3:, 3:] = (0, 0, 1, 0)  # about its own upright axis
    nudged[3:, 0] += 0.019
    tracks = {"moved": moved, "tipped": tipped, "turned": turned, "nudged": nudged}
    assert disturbed(tracks) == ("moved", "tipped")
