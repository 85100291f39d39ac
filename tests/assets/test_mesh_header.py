"""The beginning of a mesh file: each kind passes, and what is none of its kind is refused."""

from pathlib import Path

import numpy as np
import pytest

from rtphys.assets.glb import Surface, glb_bytes
from rtphys.assets.mesh_header import check_mesh
from rtphys.assets.solid import hull
from rtphys.assets.urdf import stl_bytes
from rtphys.core.errors import BadFile

BLOCK = hull(np.array(np.meshgrid((0, 1), (0, 2), (0, 3))).reshape(3, -1).T.astype(float))
SURFACE = Surface(BLOCK.vertices.astype(np.float32), BLOCK.faces.astype(np.uint32))
GLB, STL = glb_bytes([SURFACE], ["a"]), stl_bytes(BLOCK)
TEXT = b"solid a\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n"


@pytest.mark.parametrize(
    ("name", "data"),
    [
        ("a.glb", GLB),
        ("a.STL", STL),
        ("b.stl", b"solid".ljust(80) + STL[80:]),  # some binary ones begin so
        ("c.stl", TEXT),
        ("a.obj", b"# Blender\nmtllib a.mtl\nv 0 0 0\n"),
        ("a.dae", b'<?xml version="1.0"?>\n<COLLADA version="1.4.1"/>'),
        ("a.ply", b"ply"),  # a kind that is not looked at
    ],
)
def test_a_mesh_passes(tmp_path: Path, name: str, data: bytes) -> None:
    (tmp_path / name).write_bytes(data)
    check_mesh(tmp_path / name)


@pytest.mark.parametrize(
    ("name", "data", "says"),
    [
        ("a.glb", b"", "no binary glTF"),
        ("a.glb", b"garbage" * 50, "no binary glTF"),
        ("a.glb", GLB[:-7], "of the .* bytes"),
        ("a.glb", GLB[:4] + b"\1" + GLB[5:], "version 1"),
        ("a.stl", b"garbage" * 50, "neither"),
        ("a.stl", STL[:-1], "neither"),
        ("a.stl", bytes(84), "neither"),
        ("a.obj", b"garbage" * 50, "no Wavefront"),
        ("a.dae", b"garbage" * 50, "no COLLADA"),
    ],
)
def test_what_is_no_mesh_is_refused(tmp_path: Path, name: str, data: bytes, says: str) -> None:
    (tmp_path / name).write_bytes(data)
    with pytest.raises(BadFile, match=rf"{name}: is no readable mesh: .*{says}"):
        check_mesh(tmp_path / name)
