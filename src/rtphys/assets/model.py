"""Reads the description of one model of a pack: sizes, masses, contact and functional points."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from rtphys.assets.mesh_header import check_mesh
from rtphys.core.bounds import JSON_BYTES
from rtphys.core.errors import BadFile, BadValue, MissingAsset
from rtphys.core.untrusted import parse_mapping, read_file

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Model:
    """One rigid model, in the official object frame: metres after scaling, mostly y up.

    A contact point's frame has +y outward, x camera-up, z minus the finger axis; a functional
    point has the z axis that its object defines (docs/objects.md).
    """

    id_name: str
    index: int
    visual: Path
    collision: Path  # glb; every sub-mesh is one convex part
    scale: Array  # (3,) for the mesh loader
    extents: Array  # (3,) [m] bounding box, scaled
    center: Array  # (3,) [m] of that box in the object frame
    contact_points: tuple[Array, ...]  # (4, 4) object frame <- point, [m]
    functional_points: tuple[Array, ...]  # (4, 4) likewise
    mass_kg: float | None  # None in the official pack, which has no masses
    center_of_mass: Array | None  # (3,) [m] object frame, None where mass_kg is
    inertia: Array | None  # (3, 3) [kg m^2] about the centre of mass, object axes
    material: str
    density: float | None  # [kg/m^3] mean over the solid
    categories: tuple[str, ...]
    description: tuple[str, ...]  # noun phrases without article, for language
    stable: bool  # it stays upright by itself, so it may be clutter


@dataclass(frozen=True, eq=False)
class Box:
    """Bounding box of a rigid model and whether it stands by itself, for clutter."""

    center: Array  # (3,) [m] of the bounding box, object frame, scaled
    extents: Array  # (3,) [m] likewise
    stable: bool


@dataclass(frozen=True, eq=False)
class LinkPoint:
    """A contact or functional point that moves with a link of an articulation."""

    link: str
    matrix: Array  # (4, 4) link frame <- point, [m], scaled


@dataclass(frozen=True, eq=False)
class Articulation:
    """One articulated model (URDF)."""

    id_name: str
    index: int
    urdf: Path
    scale: float  # for the URDF loader
    root_offset: Array  # (4, 4) spawn pose <- root link; official `transform_matrix`
    init_qpos: Array  # (n,) or empty
    contact_points: tuple[LinkPoint, ...]
    functional_points: tuple[LinkPoint, ...]
    joint_damping: float | None  # [N m s/rad or N s/m] nominal; None: the URDF's own
    balanced_links: tuple[str, ...]  # links without gravity: a spring carries their weight
    mass_kg: float | None  # of all links together
    material: str
    categories: tuple[str, ...]
    description: tuple[str, ...]


def read_json(path: Path) -> dict[str, object]:
    """Read a JSON object. Raises MissingAsset or BadFile, which name the file."""
    if not path.is_file():
        raise MissingAsset(f"file {path.name}", path)
    return {**parse_mapping(read_file(path, JSON_BYTES, links=True), path)}


def frozen(value: object) -> Array:
    """A read-only float array."""
    array = np.array(value, float)
    array.setflags(write=False)
    return array


def read_model(folder: Path, index: int) -> Model:
    """Read `<folder>/model_data<index>.json` and find the meshes beside it.

    Raises:
        MissingAsset: the description or a mesh is not there.
        BadFile: the description lacks a key or an array has a wrong shape, or a mesh is none.
        BadValue: a number that no body has.
    """
    path = folder / f"model_data{index}.json"
    data = read_json(path)
    try:
        box = _box(data, path)
        scale = np.broadcast_to(np.array(data["scale"], float), (3,))
        return Model(
            id_name=folder.name,
            index=index,
            visual=mesh_file(folder, "visual", index),
            collision=mesh_file(folder, "collision", index),
            scale=frozen(scale),
            extents=box.extents,
            center=box.center,
            contact_points=_matrices(data.get("contact_points_pose"), scale),
            functional_points=_matrices(data.get("functional_matrix"), scale),
            mass_kg=_number(data, "mass_kg", path),
            center_of_mass=_array(data.get("center_of_mass"), (3,)),
            inertia=_inertia(data, path),
            material=str(data.get("material", "")),
            density=_number(data, "density", path),
            categories=_words(data.get("categories")),
            description=_words(data.get("description")),
            stable=box.stable,
        )
    except (KeyError, ValueError, TypeError) as problem:
        raise BadFile(path, f"not a model description ({problem!r})") from problem


def read_box(folder: Path, index: int) -> Box:
    """Read a model's bounding box only, several times as fast as `read_model`. Raises the same."""
    path = folder / f"model_data{index}.json"
    try:
        return _box(read_json(path), path)
    except (KeyError, ValueError, TypeError) as problem:
        raise BadFile(path, f"not a model description ({problem!r})") from problem


def _box(data: Mapping[str, object], path: Path) -> Box:
    scale, extents, center = (np.array(data[key], float) for key in ("scale", "extents", "center"))
    _check_scale(scale, path)
    return Box(frozen(center * scale), frozen(extents * scale), bool(data.get("stable", False)))


def mesh_file(folder: Path, kind: str, index: int) -> Path:
    """Path of a model's `visual` or `collision` mesh.

    Raises:
        MissingAsset: it is not there.
        BadFile: it is no mesh.
    """
    path = folder / kind / f"base{index}.glb"
    if not path.is_file():
        raise MissingAsset(f"{kind} mesh of {folder.name} model {index}", path)
    check_mesh(path)
    return path


def read_articulation(folder: Path, index: int) -> Articulation:
    """Read `<folder>/{mobility.urdf,model_data.json}`. Raises as `read_model`."""
    path = folder / "model_data.json"
    data = read_json(path)
    urdf = folder / "mobility.urdf"
    if not urdf.is_file():
        raise MissingAsset(f"URDF of {folder.parent.name} model {index}", urdf)
    try:
        scales = np.array(data["scale"], float)
        _check_scale(scales, path)
        scale = float(np.max(scales))
        return Articulation(
            id_name=folder.parent.name,
            index=index,
            urdf=urdf,
            scale=scale,
            # The offset is already in metres: upstream multiplies the scale into the points only.
            root_offset=frozen(data.get("transform_matrix", np.eye(4))),
            init_qpos=frozen(data.get("init_qpos") or []),
            contact_points=_link_points(data.get("contact_points"), scale),
            functional_points=_link_points(data.get("functional_points"), scale),
            joint_damping=_number(data, "joint_damping", path, zero=True),
            balanced_links=_words(data.get("balanced_links")),
            mass_kg=_number(data, "mass_kg", path),
            material=str(data.get("material", "")),
            categories=_words(data.get("categories")),
            description=_words(data.get("description")),
        )
    except (KeyError, ValueError, TypeError) as problem:
        raise BadFile(path, f"not an articulation description ({problem!r})") from problem


def _matrices(value: object, scale: Array) -> tuple[Array, ...]:
    return tuple(_scaled(m, scale) for m in value) if isinstance(value, list) else ()


def _scaled(matrix: object, scale: Array) -> Array:
    m = np.array(matrix, float)
    if m.shape != (4, 4):
        raise ValueError(f"a point is a 4 x 4 matrix, not {m.shape}")
    m[:3, 3] *= scale
    return frozen(m)


def _link_points(value: object, scale: float) -> tuple[LinkPoint, ...]:
    if not isinstance(value, list):
        return ()
    factors = np.full(3, scale)
    return tuple(LinkPoint(str(p["base"]), _scaled(p["matrix"], factors)) for p in value)


def _number(
    data: Mapping[str, object], key: str, path: Path, *, zero: bool = False
) -> float | None:
    value = data.get(key)
    if value is None:
        return None
    number = float(value) if isinstance(value, int | float) else np.nan
    if not (0 < number < np.inf or (zero and number == 0)):
        allowed = "it is a number, 0 or above" if zero else "it is a number above 0"
        raise BadValue(key, value, allowed, path)
    return number


def _inertia(data: Mapping[str, object], path: Path) -> Array | None:
    inertia = _array(data.get("inertia"), (3, 3))
    if inertia is None:
        return None
    symmetric = np.allclose(inertia, inertia.T, rtol=0, atol=1e-3 * np.abs(inertia).max())
    if not symmetric or np.linalg.eigvalsh(inertia)[0] <= 0:
        raise BadValue("inertia", inertia.tolist(), "it is symmetric and positive definite", path)
    return inertia


def _check_scale(scale: Array, path: Path) -> None:
    if not ((scale > 0) & (scale < np.inf)).all():
        raise BadValue("scale", scale.tolist(), "each number is above 0", path)


def _array(value: object, shape: tuple[int, ...]) -> Array | None:
    if value is None:
        return None
    array = frozen(value)
    if array.shape != shape:
        raise ValueError(f"expected numbers of shape {shape}, not {array.shape}")
    return array


def _words(value: object) -> tuple[str, ...]:
    return tuple(str(v) for v in value) if isinstance(value, list) else ()
