"""Clutter: which models may be, where they stand, and which an episode disturbed."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import hypot, pi

import numpy as np

from rtphys.assets.pack import Pack
from rtphys.core.poses import Array, quat_to_matrix
from rtphys.core.seeds import Chance
from rtphys.task.draw import Spot
from rtphys.task.props import CLUTTER, UP_Z, Articulated, Ball, Box, Mesh, Prop
from rtphys.task.spec import Task

GROUPS = (
    {"001_bottle", "114_bottle", "029_olive-oil", "065_soy-sauce", "066_vinegar", "049_shampoo"},
    {"109_hydrating-oil", "080_pillbottle", "095_glue", "031_jam-jar"},
    {"071_can", "105_sauce-can", "068_boxdrink", "038_milk-box"},
    {"021_cup", "039_mug", "059_pencup", "002_bowl"},
    {"003_plate", "008_tray", "019_coaster"},
    {"076_breadbasket", "110_basket", "062_plasticbox", "007_shoe-box"},
    {"063_tabletrashbin", "011_dustbin"},
    {"005_french-fries", "006_hamburg", "075_bread"},
    {"077_phone", "079_remotecontrol", "151_calculator"},
    {"078_phonestand", "074_displaystand", "070_paymentsign"},
    {"112_tea-box", "113_coffee-box", "081_playingcards", "107_soap", "023_tissue-box"},
    {"086_woodenblock", "073_rubikscube"},
    {"020_hammer", "084_woodenmallet"},
    {"030_drill", "024_scanner"},
    {"106_skillet", "060_kitchenpot"},
    {"043_book", "150_paperback", "092_notebook", "015_laptop", "116_keyboard"},
    {"036_cabinet", "040_rack", "044_microwave"},
    {"046_alarm-clock", "099_fan"},
)
"""Groups of id_names that look alike; models of one id_name always do."""

BLOCKS = {"086_woodenblock", "073_rubikscube", "112_tea-box", "113_coffee-box"}
"""id_names that look like the plain boxes that tasks stack."""

ROUND = {"035_apple", "130_fruit", "102_roller", "155_marker"}
"""id_names that are never clutter: stable on a level table, they roll off a tilted one."""


def alike(category: str, named: Collection[str], blocks: bool) -> bool:
    """Whether a model of this category could be mistaken for one of the task's objects.

    Args:
        named: categories of the task's objects.
        blocks: whether plain boxes are among them.
    """
    if category in named or (blocks and category in BLOCKS):
        return True
    return any(category in group and not group.isdisjoint(named) for group in GROUPS)


# ---- where it stands -----------------------------------------------------------------------------

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


@lru_cache(maxsize=4)
def _by_category(pack: Pack) -> dict[str, list[Piece]]:
    found: dict[str, list[Piece]] = {}
    for piece in pieces(pack):
        found.setdefault(piece.category, []).append(piece)
    return found


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
    by_category = _by_category(pack)
    fit = sorted(category for category in by_category if not alike(category, named, blocks))
    rng = chance.stream("visual", "clutter")
    placed: list[tuple[Piece, Spot]] = []
    failures = 0
    while fit and len(placed) < most and failures < FAILURES:
        models = by_category[fit[int(rng.integers(len(fit)))]]
        piece = models[int(rng.integers(len(models)))]
        x, y, yaw = (float(rng.uniform(-h, h)) for h in (HALF_X, HALF_Y, pi))
        spot = Spot(x + task.table_shift[0], y + task.table_shift[1], yaw)
        x, y, r = spot.x - task.table_shift[0], spot.y - task.table_shift[1], piece.radius
        inside = abs(x) + r <= HALF_X and abs(y) + r <= HALF_Y
        if (
            inside
            and (piece.height <= LOW or y - r >= 0)  # not tall in the near half, where arms work
            and all(area.distance(spot.x, spot.y) >= r for area in taken)
            and all(spot.distance(at) >= r + other.radius + 2 * GAP for other, at in placed)
        ):
            placed.append((piece, spot))
        else:
            failures += 1
    return tuple(
        Mesh(name=f"{CLUTTER}{n}", pose=at.pose(UP_Z), category=piece.category, model=piece.model)
        for n, (piece, at) in enumerate(placed)
    )


# ---- what an episode disturbed -------------------------------------------------------------------

MOVED = 0.02  # [m] distance from its position when the policy stage began
TIPPED = np.radians(15.0)  # [rad] angle of its up axis from its direction then


def disturbed(tracks: Mapping[str, Array]) -> tuple[str, ...]:
    """Names of the pieces that were disturbed at any time of the episode.

    Args:
        tracks: name of a piece -> its world poses (T, 7), xyz [m] + wxyz, from the start on.
    """
    found: list[str] = []
    for name, poses in tracks.items():
        moved = np.linalg.norm(poses[:, :3] - poses[0, :3], axis=1).max() > MOVED
        up = np.array([quat_to_matrix(q)[:, 1] for q in poses[:, 3:]])  # a piece's own y is up
        if moved or (up @ up[0]).min() < np.cos(TIPPED):
            found.append(name)
    return tuple(found)
