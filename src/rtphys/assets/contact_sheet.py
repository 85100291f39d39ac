"""A picture of many models side by side, with the axes of their frames and their points."""

import xml.etree.ElementTree as ElementTree
from collections.abc import Callable, Iterable
from dataclasses import replace
from pathlib import Path

import numpy as np
import trimesh
from numpy.typing import NDArray
from PIL import Image, ImageDraw
from trimesh.visual import TextureVisuals
from trimesh.visual.material import PBRMaterial

from rtphys.assets.draw import Triangles, View, draw, fitting
from rtphys.assets.model import Articulation
from rtphys.assets.pack import Pack
from rtphys.assets.urdf import placed
from rtphys.core.poses import axis_angle, quat_to_matrix

Array = NDArray[np.float64]
Colour = tuple[int, int, int]

AXES: dict[str, Colour] = {"x": (230, 110, 0), "y": (0, 170, 60), "z": (150, 0, 200)}
ROOM = 1.4  # how much wider a picture is than its model, for the axes
CONTACT, FUNCTIONAL = (200, 30, 30), (20, 70, 220)  # approach of a grasp; z of a functional point
UP = np.array([[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]], float)  # y up to z up
AJAR = 0.4  # [1] share of its range by which a joint is shown open


def contact_sheet(
    pack: Pack,
    models: Iterable[tuple[str, int]],
    size: int = 160,
    columns: int = 8,
    tell: Callable[[str], None] | None = None,
) -> Image.Image:
    """A labelled square of `size` pixels per model, at most `columns` in a row.

    Args:
        tell: gets the name of each when it is drawn.
    """
    tiles = []
    for id_name, index in models:
        tiles.append((f"{id_name}/{index}", tile(pack, id_name, index, size)))
        if tell is not None:
            tell(tiles[-1][0])
    columns = min(columns, max(1, len(tiles)))
    rows = -(-len(tiles) // columns)
    sheet = Image.new("RGB", (columns * size, rows * (size + 12)), "white")
    pen = ImageDraw.Draw(sheet)
    for i, (label, picture) in enumerate(tiles):
        x, y = i % columns * size, i // columns * (size + 12)
        sheet.paste(Image.fromarray(picture), (x, y))
        pen.text((x + 2, y + size), label, fill="black")
    return sheet


def tile(pack: Pack, id_name: str, index: int, size: int = 160) -> NDArray[np.uint8]:
    """Picture of one model: axes of its frame; red out of contact points, blue along functional z.

    The frame of an articulated model is that of its root link.
    """
    if pack.is_articulated(id_name):
        model = pack.articulation(id_name, index)
        pieces, links = _open(model)
        frame = next(iter(links.values()))
        contacts = [links[p.link] @ p.matrix for p in model.contact_points]
        functions = [links[p.link] @ p.matrix for p in model.functional_points]
    else:
        model = pack.model(id_name, index)
        frame = UP
        pieces = [t.moved(UP) for t in mesh_triangles(model.visual, model.scale)]
        contacts = [UP @ m for m in model.contact_points]
        functions = [UP @ m for m in model.functional_points]
    view = fitting(pieces, size)
    view = replace(view, radius=ROOM * view.radius)
    image = Image.fromarray(draw(pieces, view))
    pen = ImageDraw.Draw(image)
    _draw_axes(pen, view, frame)
    _mark(pen, view, contacts, 1, CONTACT)
    _mark(pen, view, functions, 2, FUNCTIONAL)
    return np.array(image)


def mesh_triangles(path: Path, scale: Array) -> list[Triangles]:
    """The triangles of each mesh in a file, with its colour or picture."""
    pieces = []
    for mesh in trimesh.load_scene(path).dump():
        if isinstance(mesh, trimesh.Trimesh) and len(mesh.faces):
            corners = np.asarray(mesh.vertices)[mesh.faces] * scale
            pieces.append(Triangles(corners, *_look(mesh)))
    return pieces


def _look(mesh: trimesh.Trimesh) -> tuple[Array, Array | None, Array | None]:
    """Colour, texture coordinates and picture of a mesh."""
    grey = np.full(3, 0.7)
    visual = mesh.visual
    if not isinstance(visual, TextureVisuals):
        return grey, None, None
    material = visual.material
    if not isinstance(material, PBRMaterial):
        return grey, None, None
    if material.baseColorTexture is not None and visual.uv is not None:
        picture = np.asarray(material.baseColorTexture.convert("RGB"), float) / 255
        # trimesh turns v upward on reading; pictures have it downward.
        uv = np.asarray(visual.uv)[mesh.faces] * [1, -1] + [0, 1]
        return grey, uv, picture
    if material.baseColorFactor is None:
        return grey, None, None
    linear = np.asarray(material.baseColorFactor, float)[:3] / 255
    return (
        np.where(linear <= 0.0031, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055),
        None,
        None,
    )


def _draw_axes(pen: ImageDraw.ImageDraw, view: View, frame: Array) -> None:
    for n, (letter, colour) in enumerate(AXES.items()):
        origin, axis = frame[:3, 3], 0.6 * view.radius * frame[:3, n]
        _stroke(pen, view, origin, origin + axis, colour)
        column, row, _ = view.project(origin + 1.15 * axis).tolist()
        pen.text((column, row), letter, colour, anchor="mm", stroke_width=2, stroke_fill="white")


def _mark(
    pen: ImageDraw.ImageDraw, view: View, points: list[Array], axis: int, colour: Colour
) -> None:
    for m in points:
        origin = m[:3, 3]
        _stroke(pen, view, origin, origin + 0.22 * view.radius * m[:3, axis], colour)
        for turn in (0, 2):  # a small cross at the point itself
            arm = 0.03 * view.radius * m[:3, turn]
            _stroke(pen, view, origin - arm, origin + arm, colour)


def _stroke(pen: ImageDraw.ImageDraw, view: View, start: Array, end: Array, colour: Colour) -> None:
    """A line in front of everything."""
    (x0, y0, _), (x1, y1, _) = view.project(np.stack([start, end])).tolist()
    pen.line([(x0, y0), (x1, y1)], colour, max(1, view.size // 80))


def _open(model: Articulation) -> tuple[list[Triangles], dict[str, Array]]:
    """Triangles and link frames (4, 4) of an articulated model with its joints partly open."""
    root = ElementTree.parse(model.urdf).getroot()
    links = _link_frames(root, model.scale)
    drawn = []
    for link in root.findall("link"):
        X = links.get(link.get("name", ""), np.eye(4))
        for visual in link.findall("visual"):
            mesh = visual.find("geometry/mesh")
            if mesh is not None:
                path = model.urdf.parent / mesh.get("filename", "")
                local = X @ _origin(visual.find("origin"), model.scale)
                pieces = mesh_triangles(path, np.full(3, model.scale))
                drawn += [piece.moved(local) for piece in pieces]
    return drawn, links


def _link_frames(root: ElementTree.Element, scale: float) -> dict[str, Array]:
    """Link name -> frame (4, 4) in a world where the user stands at -y."""
    facing = np.eye(4)
    facing[:3, :3] = quat_to_matrix(axis_angle((0, 0, 1), np.pi / 2))
    frames: dict[str, Array] = {}
    waiting = root.findall("joint")
    children = {_link(j, "child") for j in waiting}
    for link in root.findall("link"):
        if link.get("name", "") not in children:
            frames[link.get("name", "")] = facing
    while waiting:
        ready = [j for j in waiting if _link(j, "parent") in frames]
        if not ready:
            break  # the other joints have no known parent: the URDF is broken, but draw the rest
        for j in ready:
            parent = frames[_link(j, "parent")]
            frames[_link(j, "child")] = (
                parent @ _origin(j.find("origin"), scale) @ _motion(j, scale)
            )
        waiting = [j for j in waiting if j not in ready]
    return frames


def _link(joint: ElementTree.Element, end: str) -> str:
    node = joint.find(end)
    return node.get("link", "") if node is not None else ""


def _motion(joint: ElementTree.Element, scale: float) -> Array:
    limit, axis = joint.find("limit"), joint.find("axis")
    X = np.eye(4)
    if limit is None or axis is None or joint.get("type") == "fixed":
        return X
    low, high = float(limit.get("lower", "0")), float(limit.get("upper", "0"))
    q = low + AJAR * (high - low)
    direction = np.array(axis.get("xyz", "1 0 0").split(), float)
    if joint.get("type") == "prismatic":
        X[:3, 3] = q * scale * direction
    else:
        X[:3, :3] = quat_to_matrix(axis_angle(direction, q))
    return X


def _origin(node: ElementTree.Element | None, scale: float) -> Array:
    if node is None:
        return np.eye(4)
    xyz = np.array(node.get("xyz", "0 0 0").split(), float) * scale
    return placed(xyz, np.array(node.get("rpy", "0 0 0").split(), float))
