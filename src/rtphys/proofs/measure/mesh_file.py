"""Corners of the meshes in glTF, STL and Wavefront files, read without the simulator."""

import struct
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from rtphys.core.errors import BadFile
from rtphys.core.json_text import parse_mapping
from rtphys.core.poses import Array, quat_to_matrix

_JSON, _BINARY = 0x4E4F534A, 0x004E4942  # chunk types of a GLB file


def corners(path: Path) -> list[Array]:
    """Corners (n, 3) of each part of a mesh file, in the file's unit.

    Raises:
        BadFile: of a kind that is not read here.
    """
    if path.suffix.lower() == ".glb":
        return _gltf(path)
    if path.suffix.lower() == ".stl":
        return [_stl(path)]
    if path.suffix.lower() == ".obj":
        return [_wavefront(path)]
    raise BadFile(path, "is none of .glb, .stl, .obj")


def _stl(path: Path) -> Array:
    data = path.read_bytes()
    record = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("count", "<u2")])
    (count,) = struct.unpack_from("<I", data, 80)
    return np.frombuffer(data, record, count, 84)["corners"].reshape(-1, 3).astype(float)


def _wavefront(path: Path) -> Array:
    lines = path.read_text(errors="replace").splitlines()
    return np.array([line.split()[1:4] for line in lines if line.startswith("v ")], float)


def _gltf(path: Path) -> list[Array]:
    """One part for each primitive of each node, moved by the node's transform."""
    chunks, data, at = {}, path.read_bytes(), 12
    while at < len(data):
        size, kind = struct.unpack_from("<II", data, at)
        chunks[kind] = data[at + 8 : at + 8 + size]
        at += 8 + size
    head: dict[str, Any] = parse_mapping(chunks[_JSON], path)
    found: list[Array] = []
    roots = head["scenes"][head.get("scene", 0)]["nodes"]
    pending = [(node, np.eye(4)) for node in roots]
    while pending:
        index, X_parent = pending.pop(0)
        node = head["nodes"][index]
        X = X_parent @ _transform(node)
        pending += [(child, X) for child in node.get("children", ())]
        if "mesh" in node:
            for primitive in head["meshes"][node["mesh"]]["primitives"]:
                points = _points(head, chunks[_BINARY], primitive["attributes"]["POSITION"])
                found.append(points @ X[:3, :3].T + X[:3, 3])
    return found


def _points(head: Mapping[str, Any], blob: bytes, accessor: int) -> Array:
    entry = head["accessors"][accessor]
    view = head["bufferViews"][entry["bufferView"]]
    start = view.get("byteOffset", 0) + entry.get("byteOffset", 0)
    stride = view.get("byteStride", 12)
    rows = np.ndarray((entry["count"], 3), "<f4", blob, start, (stride, 4))
    return rows.astype(float)


def _transform(node: Mapping[str, Sequence[float]]) -> Array:
    """(4, 4) of a node in its parent."""
    if "matrix" in node:
        return np.array(node["matrix"], float).reshape(4, 4).T
    X = np.eye(4)
    x, y, z, w = node.get("rotation", (0.0, 0.0, 0.0, 1.0))
    X[:3, :3] = quat_to_matrix((w, x, y, z)) * np.array(node.get("scale", (1.0, 1.0, 1.0)))
    X[:3, 3] = node.get("translation", (0.0, 0.0, 0.0))
    return X
