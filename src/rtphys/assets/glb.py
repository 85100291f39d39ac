"""Writes binary glTF. Our own: the bytes of a library's writer may change with its version."""

import json
import struct
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from rtphys.assets.material import Finish
from rtphys.assets.png import png_bytes

FLOAT, UINT16, UINT32 = 5126, 5123, 5125


@dataclass(frozen=True, eq=False)
class Surface:
    """A mesh ready to draw: a corner with two normals is two vertices."""

    points: NDArray[np.float32]  # (N, 3) [m]
    faces: NDArray[np.uint32]  # (M, 3)
    normals: NDArray[np.float32] | None = None  # (N, 3)
    uv: NDArray[np.float32] | None = None  # (N, 2), v downward as in the picture
    finish: Finish | None = None


@dataclass
class _Writer:
    blob: bytearray = field(default_factory=bytearray)
    views: list[dict[str, int]] = field(default_factory=list)
    accessors: list[dict[str, object]] = field(default_factory=list)

    def view(self, data: bytes) -> int:
        self.blob.extend(b"\0" * (-len(self.blob) % 4))
        self.views.append({"buffer": 0, "byteOffset": len(self.blob), "byteLength": len(data)})
        self.blob.extend(data)
        return len(self.views) - 1

    def accessor(self, array: NDArray[np.generic], kind: str, component: int) -> int:
        entry: dict[str, object] = {
            "bufferView": self.view(array.tobytes()),
            "componentType": component,
            "count": len(array) if kind != "SCALAR" else array.size,
            "type": kind,
        }
        if kind == "VEC3":
            entry |= {"min": array.min(0).tolist(), "max": array.max(0).tolist()}
        self.accessors.append(entry)
        return len(self.accessors) - 1


def glb_bytes(surfaces: list[Surface], names: list[str]) -> bytes:
    """A GLB file with one mesh and one untransformed node per surface, in order."""
    out = _Writer()
    materials: list[dict[str, object]] = []
    images: list[dict[str, object]] = []
    meshes = []
    for surface, name in zip(surfaces, names, strict=True):
        attributes = {"POSITION": out.accessor(surface.points, "VEC3", FLOAT)}
        if surface.normals is not None:
            attributes["NORMAL"] = out.accessor(surface.normals, "VEC3", FLOAT)
        if surface.uv is not None:
            attributes["TEXCOORD_0"] = out.accessor(surface.uv, "VEC2", FLOAT)
        small = len(surface.points) < 0xFFFF
        index = surface.faces.reshape(-1).astype(np.uint16 if small else np.uint32)
        primitive: dict[str, object] = {
            "attributes": attributes,
            "indices": out.accessor(index, "SCALAR", UINT16 if small else UINT32),
        }
        if surface.finish is not None:
            primitive["material"] = len(materials)
            materials.append(_material(surface.finish, name, out, images))
        meshes.append({"name": name, "primitives": [primitive]})
    return _container(out, meshes, materials, images)


def _material(
    finish: Finish, name: str, out: _Writer, images: list[dict[str, object]]
) -> dict[str, object]:
    pbr: dict[str, object] = {
        "metallicFactor": round(finish.metallic, 4),
        "roughnessFactor": round(finish.roughness, 4),
    }
    if finish.picture is None:
        pbr["baseColorFactor"] = [round(linear(c), 4) for c in finish.colour] + [1.0]
    else:
        # Tinted here: SAPIEN lets a texture replace the colour factor instead of multiplying.
        tinted = np.round(finish.picture * np.array(finish.colour)).astype(np.uint8)
        pbr["baseColorTexture"] = {"index": len(images)}
        images.append({"bufferView": out.view(png_bytes(tinted)), "mimeType": "image/png"})
    return {"name": name, "pbrMetallicRoughness": pbr}


def linear(srgb: float) -> float:
    """An sRGB value 0..1 in linear light, as glTF wants colour factors (but not pictures)."""
    return srgb / 12.92 if srgb <= 0.04045 else ((srgb + 0.055) / 1.055) ** 2.4


def _container(
    out: _Writer,
    meshes: list[dict[str, object]],
    materials: list[dict[str, object]],
    images: list[dict[str, object]],
) -> bytes:
    scene: dict[str, object] = {
        "asset": {"version": "2.0", "generator": "rtphys"},
        "scene": 0,
        "scenes": [{"nodes": list(range(len(meshes)))}],
        "nodes": [{"mesh": i, "name": mesh["name"]} for i, mesh in enumerate(meshes)],
        "meshes": meshes,
        "accessors": out.accessors,
        "bufferViews": out.views,
        "buffers": [{"byteLength": len(out.blob) + (-len(out.blob) % 4)}],
    }
    if materials:
        scene["materials"] = materials
    if images:
        scene |= {
            "images": images,
            "samplers": [{"magFilter": 9729, "minFilter": 9729, "wrapS": 10497, "wrapT": 10497}],
            "textures": [{"source": i, "sampler": 0} for i in range(len(images))],
        }
    text = json.dumps(scene, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    blob = bytes(out.blob) + b"\0" * (-len(out.blob) % 4)
    total = 12 + 8 + len(text) + 8 + len(blob)
    return b"".join(
        [
            struct.pack("<4sII", b"glTF", 2, total),
            struct.pack("<I4s", len(text), b"JSON"),
            text,
            struct.pack("<I4s", len(blob), b"BIN\0"),
            blob,
        ]
    )
