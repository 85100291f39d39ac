"""What the single arms of the builtin pack share: writing them, and their floor stand."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from rtphys.assets.asset_model import ArticulatedModel, Body, Inertial, Joint, Part
from rtphys.assets.embodiments.aloha_arm import Shape
from rtphys.assets.geometry import box, rounded_box
from rtphys.assets.material import plastic
from rtphys.assets.solid import Solid, hull
from rtphys.assets.write import write_links

Array = NDArray[np.float64]
# Mass [kg], centre of mass (3,) [m], inertia about it xx yy zz xy xz yz [kg m^2].
Figures = tuple[float, tuple[float, ...], tuple[float, ...]]

STAND = plastic((0.30, 0.31, 0.33), 0.6)


def write_arm(folder: Path, model: ArticulatedModel, config: str) -> None:
    """`<folder>/{config.yml,<name>.urdf,meshes/}`."""
    folder.mkdir(parents=True, exist_ok=True)
    write_links(folder, folder.name, model, f"{folder.name}.urdf")
    (folder / "config.yml").write_text(config, encoding="utf-8")


def body(shape: Shape, figures: Figures) -> Body:
    """A link of these shapes with mass properties from a data sheet."""
    mass, com, (xx, yy, zz, xy, xz, yz) = figures
    inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return Body(*shape, given=Inertial(mass, np.array(com, float), inertia, 0.0))


def turning(
    names: Sequence[str],
    links: Sequence[str],
    frames: Sequence[Array],
    limits: Sequence[tuple[float, float]],
    effort: Sequence[float],
) -> list[Joint]:
    """A chain of joints, each about z of its frame (4, 4) in the link before it."""
    rows = zip(names, links[:-1], links[1:], frames, limits, effort, strict=True)
    return [
        Joint(name, "revolute", parent, child, X, (0.0, 0.0, 1.0), span, torque, speed=3.0)
        for name, parent, child, X, span, torque in rows
    ]


def moved(shape: Shape, X: Array) -> Shape:
    """A shape given in the frame X (4, 4) of the frame in which it is wanted."""
    visual, collision = shape
    parts = tuple(Part(p.solid.placed(X), p.finish, p.material, p.crease_deg) for p in visual)
    return parts, tuple(solid.placed(X) for solid in collision)


def prism(outline: Sequence[tuple[float, float]], thickness: float) -> Solid:
    """The convex prism of points (x, y), its thickness about z = 0."""
    return hull([(x, y, z) for x, y in outline for z in (-thickness / 2, thickness / 2)])


def stand(height: float, depth: float, width: float) -> tuple[Part, Solid]:
    """A column from the arm's foot to the floor, `height` below, and its collision box [m]."""
    column = box(depth, width, height - 0.02).at(0.0, 0.0, -height / 2)
    plate = rounded_box(depth + 0.02, width + 0.08, 0.02, 0.004, 1).at(0, 0, -height + 0.01)
    return Part(column + plate, STAND, "aluminium"), column


def by_name(
    names: Sequence[str], shapes: Mapping[str, Shape], figures: Mapping[str, Figures]
) -> dict[str, Body]:
    """The bodies of these links, in their order."""
    return {name: body(shapes[name], figures[name]) for name in names}
