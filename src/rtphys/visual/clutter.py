"""Clutter: objects that a task does not need, placed clear of its own objects and areas."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import hypot, pi

import numpy as np

from rtphys.assets.pack import Pack
from rtphys.core.poses import Pose
from rtphys.core.seeds import Chance
from rtphys.task.draw import Spot
from rtphys.task.orientation import UP_Z
from rtphys.task.props import Articulated, Ball, Box, Mesh, Prop
from rtphys.task.spec import Task
from rtphys.visual.look_alikes import ROUND, alike

HALF_X, HALF_Y = 0.60, 0.34  # [m] half size of the clutter area about the table's centre (RoboTwin)
GAP = 0.005  # [m] margin of each piece towards other pieces (RoboTwin)
ROOM = 0.08  # [m] margin around the task's objects: a gripper comes down beside them
LOW = 0.05  # [m] higher pieces stand in the far half of the table only (RoboTwin)
FAILURES = 50  # rejected placements after which the table counts as full (RoboTwin)
WIDEST = 0.16  # [m] radius of the largest piece
REACH = 0.25  # [m] margin around an articulated object, whose door or lid swings


@dataclass(frozen=True)
class Area:
    """A rectangle on the table, task frame [m]."""

    x: tuple[float, float]
    y: tuple[float, float]

    def distance(self, x: float, y: float) -> float:
        """Distance [m] from a point to the rectangle; 0 inside."""
        dx = max(self.x[0] - x, 0.0, x - self.x[1])
        dy = max(self.y[0] - y, 0.0, y - self.y[1])
        return hypot(dx, dy)

    def grown(self, by: float) -> "Area":
        """The rectangle with a margin [m] on all sides."""
        return Area((self.x[0] - by, self.x[1] + by), (self.y[0] - by, self.y[1] + by))


@dataclass(frozen=True)
class Piece:
    """A model that may be clutter: it stays upright by itself, with its y axis up."""

    category: str
    model: int
    radius: float  # [m] of the cylinder about the upright axis that holds it
    height: float  # [m]


@lru_cache(maxsize=4)
def pieces(pack: Pack) -> tuple[Piece, ...]:
    """Every model of a pack that may be clutter, in a fixed order."""
    models = []
    for name in pack.names:
        if name in ROUND or pack.is_articulated(name):
            continue
        for index in pack.indices(name):
            box = pack.box(name, index)
            low, high = ((box.center + s * box.extents / 2).tolist() for s in (-1, 1))
            radius = max(hypot(x, z) for x in (low[0], high[0]) for z in (low[2], high[2]))
            if box.stable and radius <= WIDEST:
                models.append(Piece(name, index, radius, float(box.extents[1])))
    return tuple(models)


@lru_cache(maxsize=64)
def _choice(pack: Pack, named: frozenset[str], blocks: bool) -> tuple[tuple[Piece, ...], ...]:
    """Clutter that no task object resembles, by category: sorted by name, then as in `pieces`."""
    by_category: dict[str, list[Piece]] = {}
    for piece in pieces(pack):
        by_category.setdefault(piece.category, []).append(piece)
    fit = sorted(category for category in by_category if not alike(category, named, blocks))
    return tuple(tuple(by_category[category]) for category in fit)


def footprint(prop: Prop, pack: Pack) -> Area:
    """Bounding rectangle of a prop on the table at its nominal size, independent of physics."""
    x, y = (float(v) for v in prop.pose.p[:2])
    if isinstance(prop, Articulated):
        return Area((x - REACH, x + REACH), (y - REACH, y + REACH))
    if isinstance(prop, Ball):
        low, high = -np.full(3, prop.radius), np.full(3, prop.radius)
    elif isinstance(prop, Box):
        low, high = -np.array(prop.half_size), np.array(prop.half_size)
    elif isinstance(prop, Mesh):
        model = pack.model(prop.category, prop.model)
        low, high = (model.center + s * model.extents / 2 for s in (-1, 1))
    else:
        low = high = np.zeros(3)
    corners = np.array(
        [[a[0], b[1], c[2]] for a in (low, high) for b in (low, high) for c in (low, high)]
    )
    shadow = prop.pose @ corners
    (x0, y0), (x1, y1) = shadow[:, :2].min(axis=0), shadow[:, :2].max(axis=0)
    return Area((float(x0), float(x1)), (float(y0), float(y1)))


def scatter(
    chance: Chance, most: int, task: Task, props: Sequence[Prop], pack: Pack
) -> tuple[Mesh, ...]:
    """Up to `most` pieces, clear of the props, of `task.keep_clear` and of each other."""
    if not most:
        return ()
    taken = [footprint(prop, pack).grown(ROOM) for prop in props]
    taken += [Area(x, y) for x, y in task.keep_clear]
    named = frozenset(p.category for p in props if isinstance(p, Mesh | Articulated))
    blocks = any(isinstance(p, Box) and not p.visual_only for p in props)
    # The category is drawn first, or bottles, of which there are twenty, would be everywhere.
    categories = _choice(pack, named, blocks)
    rng = chance.stream("visual", "clutter")
    placed: list[tuple[Piece, Spot]] = []
    failures = 0
    while categories and len(placed) < most and failures < FAILURES:
        models = categories[int(rng.integers(len(categories)))]
        piece = models[int(rng.integers(len(models)))]
        x, y, yaw = (float(rng.uniform(-h, h)) for h in (HALF_X, HALF_Y, pi))
        spot = Spot(x + task.table_shift[0], y + task.table_shift[1], yaw)
        if _fits(piece, spot, task) and _is_clear(piece, spot, taken, placed):
            placed.append((piece, spot))
        else:
            failures += 1
    return tuple(_mesh(n, piece, spot) for n, (piece, spot) in enumerate(placed))


def _fits(piece: Piece, spot: Spot, task: Task) -> bool:
    """Whether a piece is inside the clutter area and not tall in the near half, where arms work."""
    x, y = spot.x - task.table_shift[0], spot.y - task.table_shift[1]
    r = piece.radius
    inside = abs(x) + r <= HALF_X and abs(y) + r <= HALF_Y
    return inside and (piece.height <= LOW or y - r >= 0)


def _is_clear(
    piece: Piece, spot: Spot, taken: Sequence[Area], placed: Sequence[tuple[Piece, Spot]]
) -> bool:
    r = piece.radius
    return all(area.distance(spot.x, spot.y) >= r for area in taken) and all(
        spot.distance(at) >= r + other.radius + 2 * GAP for other, at in placed
    )


def _mesh(number: int, piece: Piece, spot: Spot) -> Mesh:
    pose: Pose = spot.pose(UP_Z)
    return Mesh(name=f"clutter{number}", pose=pose, category=piece.category, model=piece.model)
