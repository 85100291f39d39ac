"""Drawn tables and walls: many, apart by split in every parameter, the same each time."""

import json

import numpy as np
import pytest

from rtphys.assets.build import build
from rtphys.assets.pack import Pack
from rtphys.assets.surfaces import (
    CANVAS,
    HELD_OUT,
    KINDS,
    SPLITS,
    draw_surface,
    parameters,
    surface_names,
)
from rtphys.assets.surfaces.canvas import Canvas, Knobs
from rtphys.core.errors import UnknownName

EVERY = [(place, kind) for place in KINDS for kind in KINDS[place]]


def test_a_thousand_of_each_and_whole_kinds_held_out() -> None:
    for place in KINDS:
        seen, unseen = (surface_names(place, split) for split in SPLITS)
        assert len(set(seen)) + len(set(unseen)) == 100 * len(KINDS[place]) >= 1000
        assert len(seen) >= 1000 and len(unseen) >= 300
        assert not set(seen) & set(unseen)
        assert not [name for name in seen if name.startswith(HELD_OUT)]


@pytest.mark.parametrize(
    ("place", "kind"), EVERY, ids=[f"{place}-{kind.__name__}" for place, kind in EVERY]
)
def test_surfaces_of_a_kind_differ_and_are_not_flat(place, kind) -> None:
    small = Canvas(CANVAS[place].width / 4, CANVAS[place].height / 4, 128, 72)
    pictures = []
    for number in range(6):
        knobs = Knobs(np.random.Generator(np.random.PCG64(number)), unseen=number % 2 == 1)
        picture = kind(small, knobs)
        assert picture.shape == (72, 128, 3)
        assert np.isfinite(picture).all()
        assert 0.03 < picture.mean() < 1.0
        assert picture.std(axis=(0, 1)).max() > 0.004
        pictures.append(picture)
    means = [p.mean((0, 1)) for p in pictures]
    assert min(np.abs(a - b).max() for i, a in enumerate(means) for b in means[:i]) > 1e-3


def test_splits_share_no_value_of_any_parameter() -> None:
    drawn = {True: {}, False: {}}
    for unseen, values in drawn.items():
        for number in range(400):
            knobs = Knobs(np.random.Generator(np.random.PCG64(number)), unseen)
            values[number] = knobs.number("size", 2.0, 12.0)
        inside = [(v - 2) / 10 for v in values.values()]
        held = [0.4 <= share <= 0.5 or 0.9 <= share <= 1.0 for share in inside]
        assert all(held) if unseen else not any(held)
        assert max(inside) - min(inside) > 0.55
        assert len(set(inside)) == 400


def test_a_name_is_a_picture_and_its_parameters() -> None:
    name = "seen/linen_003"
    first, again = draw_surface("table", name), draw_surface("table", name)
    canvas = CANVAS["table"]
    assert first.shape == (canvas.rows, canvas.columns, 3) and first.dtype == np.uint8
    assert np.array_equal(first, again)
    drawn = parameters("table", name)
    assert drawn == parameters("table", name) and 0.0036 <= drawn["thread"] <= 0.006
    assert drawn != parameters("table", "seen/linen_004") != parameters("wall", "seen/linen_004")


def test_a_surface_is_sharp_in_a_small_picture() -> None:
    """Its edges are one or two pixels wide where 320 of them show 0.8 m of a table."""
    picture = draw_surface("table", "seen/gingham_007").astype(float).mean(axis=2)
    per_pixel = 0.8 / 320 / (CANVAS["table"].width / CANVAS["table"].columns)
    assert per_pixel >= 1.5, "finer than the picture, never coarser"
    steps = np.abs(np.diff(picture, axis=1))
    assert np.quantile(steps, 0.995) > 25


def test_the_pack_lists_them_and_draws_them(tmp_path) -> None:
    pack = Pack(build(tmp_path / "pack", names=["surfaces.json", "050_bell"], workers=1))
    for place in KINDS:
        for split in SPLITS:
            assert pack.textures(split, place) == surface_names(place, split)
    picture = pack.texture("wall", "unseen/plaster_085")
    assert np.array_equal(picture, draw_surface("wall", "unseen/plaster_085"))
    stored = json.loads((pack.root / "textures" / "surfaces.json").read_text())
    assert len(stored["drawn_by"]) == 64, "another way of drawing is another pack"


def test_a_pack_of_pictures_keeps_its_files(tmp_path) -> None:
    for split in SPLITS:
        folder = tmp_path / "background_texture" / split
        folder.mkdir(parents=True)
        (folder / "7.png").write_bytes(b"")
    (tmp_path / "objects").mkdir()
    pack = Pack(tmp_path, Pack(build(tmp_path / "own", names=["surfaces.json"], workers=1)))
    assert pack.textures("seen", "table") == pack.textures("seen", "wall") == ("7",)
    assert pack.texture("wall", "unseen/7") == tmp_path / "background_texture/unseen/7.png"


@pytest.mark.parametrize("name", ["seen/planksy_001", "unseen/planks_001", "planks_001"])
def test_an_unknown_surface_is_named(name: str) -> None:
    with pytest.raises(UnknownName, match="planks"):
        draw_surface("table", name)
