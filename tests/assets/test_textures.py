"""Table and wall pictures: enough of them, apart by split, different, the same each time."""

import numpy as np
import pytest

from rtphys.assets.build import build
from rtphys.assets.pack import Pack
from rtphys.assets.patterns import PATTERNS, SIZE
from rtphys.assets.textures import HELD_OUT, texture_names, write_texture
from rtphys.core.errors import UnknownName
from rtphys.core.seeds import stream

SPLITS = ("seen", "unseen")


def drawn(pattern: str, k: int) -> np.ndarray:
    return PATTERNS[pattern](stream(0, "assets", "texture", f"{pattern}_{k}"))


def test_sixty_pictures_and_whole_patterns_held_out():
    names = texture_names()
    assert len(names) == len(set(names)) >= 60
    own = {split: {n.split("/")[1] for n in names if n.startswith(split)} for split in SPLITS}
    assert min(len(own["seen"]), len(own["unseen"])) >= 15
    assert not own["seen"] & own["unseen"]
    assert not {n for n in own["seen"] if n.startswith(HELD_OUT)}


@pytest.mark.parametrize("pattern", sorted(PATTERNS))
def test_pictures_of_a_pattern_differ_and_are_not_flat(pattern):
    pictures = [drawn(pattern, k) for k in range(4)]
    for picture in pictures:
        assert picture.shape == (SIZE, SIZE, 3)
        assert np.isfinite(picture).all()
        assert 0.05 < picture.mean() < 1.0
        assert picture.std(axis=(0, 1)).max() > 0.015
    means = [p.mean((0, 1)) for p in pictures]
    apart = [np.abs(a - b).max() for i, a in enumerate(means) for b in means[:i]]
    assert max(apart) > 0.03


def test_builder_writes_them_where_the_pack_looks(tmp_path):
    names = ["seen/board_0", "unseen/hexagons_1"]
    pack = Pack(build(tmp_path / "pack", names=[*names, "050_bell"], workers=1))
    assert [p.name for p in pack.textures("seen")] == ["board_0.png"]
    assert [p.name for p in pack.textures("unseen")] == ["hexagons_1.png"]
    write_texture(tmp_path / "again", names[0])
    again = (tmp_path / "again" / "seen" / "board_0.png").read_bytes()
    assert pack.textures("seen")[0].read_bytes() == again


def test_unknown_texture_is_named(tmp_path):
    with pytest.raises(UnknownName, match="seen/boards_0"):
        write_texture(tmp_path, "seen/boards_0")
