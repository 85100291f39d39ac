"""036_cabinet: a chest of three drawers that slide out to +z.

The handles stand off the fronts; the grasps, a little further out than the official ones, leave the
fingertips short of the front. Drawers are counted from below; link_1 is the one that tasks use.
Its functional point is 3 cm behind the official one: in the middle of what 16 cm of pull lay open.
"""

from dataclasses import dataclass
from functools import partial

from rtphys.assets.asset_model import ArticulatedModel, Body, Joint, Part, contact, functional
from rtphys.assets.geometry import box, rounded_box
from rtphys.assets.material import Colour, Finish, matt, metal, tint
from rtphys.assets.objects import Models
from rtphys.assets.pictures import grain
from rtphys.assets.solid import Solid, together
from rtphys.assets.urdf import placed, root_joint

WALL = 0.008  # [m] of the carcass
SIDE = 0.006  # [m] of a drawer's box
TRAVEL = 0.1782  # [m] official
CLEAR = 0.0025  # [m] around a drawer


@dataclass(frozen=True)
class Cabinet:
    """Sizes [m] and masses [kg]."""

    width: float
    height: float
    depth: float  # of the carcass, fronts included
    handle: float  # y of the handle's middle above a drawer's own
    mass: tuple[float, float]  # carcass, a drawer


def cabinet(
    size: Cabinet, wood: Finish, fronts: Colour, words: tuple[str, ...]
) -> ArticulatedModel:
    """A cabinet with its root frame in the middle of the carcass."""
    rows = [_row(size, i) for i in range(3)]
    links = {"base": Body((), ()), "link_0": _carcass(size, wood)}
    joints = [root_joint("base", "link_0")]
    for i, middle in enumerate(rows, 1):
        links[f"link_{i}"] = _drawer(size, middle, wood, fronts)
        joints.append(
            Joint(
                f"drawer_{i}",
                "prismatic",
                "link_0",
                f"link_{i}",
                placed((0, 0, 0)),
                (0.0, 0.0, 1.0),
                (0.0, TRAVEL),
                effort=200.0,
                speed=2.0,
                damping=2.0,
            )
        )
    bar_y, bar_z = rows[0] + size.handle, _face(size) + 0.026
    grip = (0, bar_y, bar_z + 0.012)
    floor = (0, -size.height / 2 + WALL + CLEAR + SIDE, 0.010)
    return ArticulatedModel(
        links=links,
        joints=tuple(joints),
        material="wood",
        description=words,
        root_height=size.height / 2,
        contact_points=tuple(("link_1", contact(grip, (0, 0, 1), (s, 0, 0))) for s in (-1, 1)),
        functional_points=(("link_1", functional(floor, (0, 0, 1), (-1, 0, 0))),),
        # Runners have friction enough to hold a drawer on a tilted table; joints have none.
        balanced=("link_1", "link_2", "link_3"),
        categories=("cabinet", "furniture"),
    )


def _row(size: Cabinet, i: int) -> float:
    """y of the middle of drawer i."""
    pitch = (size.height - WALL) / 3
    return -size.height / 2 + WALL / 2 + (i + 0.5) * pitch


def _face(size: Cabinet) -> float:
    """z of the drawers' fronts: carcass and handles reach equally far from the root."""
    return size.depth - 0.1215


def _carcass(size: Cabinet, wood: Finish) -> Body:
    w, h, deep = size.width, size.height, size.depth - 0.006
    z = -0.1215 + deep / 2
    pitch = (h - WALL) / 3
    boards = [box(WALL, h, deep).at(s * (w - WALL) / 2, 0, z) for s in (-1, 1)]
    shelf = box(w - 2 * WALL, WALL, deep)
    boards += [shelf.at(0, -h / 2 + WALL / 2 + i * pitch, z) for i in range(4)]
    boards.append(box(w - 2 * WALL, h - 2 * WALL, 0.005).at(0, 0, -0.1215 + 0.0025))
    return Body((Part(together(*boards), wood, "wood"),), tuple(boards), size.mass[0])


def _drawer(size: Cabinet, y: float, wood: Finish, colour: Colour) -> Body:
    """A drawer: an open box, its front and handle; at q = 0 it is shut."""
    pitch = (size.height - WALL) / 3
    wide, tall = size.width - 2 * WALL - 2 * CLEAR, pitch - WALL - 2 * CLEAR
    face = _face(size)
    back, inner = -0.1215 + 0.012, face - 0.010
    length, z = inner - back, (inner + back) / 2
    bottom = y - tall / 2
    side_h = 0.80 * tall
    floor = box(wide, SIDE, length).at(0, bottom + SIDE / 2, z)
    sides = [
        box(SIDE, side_h, length).at(s * (wide - SIDE) / 2, bottom + side_h / 2, z) for s in (-1, 1)
    ]
    rear = box(wide, side_h, SIDE).at(0, bottom + side_h / 2, back + SIDE / 2)
    front = rounded_box(wide, tall, 0.010, 0.002, 1).at(0, y, face - 0.005)
    handle = _handle(size, y, face)
    looks = (
        Part(together(floor, *sides, rear), matt((0.84, 0.74, 0.58)), "wood"),
        Part(front, Finish(colour, 0.0, 0.6, wood.picture, "z"), "wood"),
        Part(together(*handle), metal((0.78, 0.79, 0.82), 0.3), "aluminium"),
    )
    return Body(looks, (floor, *sides, rear, front, *handle), size.mass[1])


def _handle(size: Cabinet, y: float, face: float) -> list[Solid]:
    bar = rounded_box(0.100, 0.010, 0.009, 0.0025, 1).at(0, y + size.handle, face + 0.026)
    post = box(0.008, 0.008, 0.026)
    return [bar, *(post.at(s * 0.043, y + size.handle, face + 0.012) for s in (-1, 1))]


OAK = matt((0.72, 0.52, 0.32)).with_picture(grain((1.0, 1.0, 1.0), "cabinet", 0.18), "z")

MODELS: Models = {
    "036_cabinet": {
        46653: partial(
            cabinet,
            Cabinet(0.231, 0.4338, 0.208, 0.0560, (3.6, 0.55)),
            OAK,
            tint((0.72, 0.52, 0.32), 1.25),
            ("wooden cabinet", "chest of drawers", "cabinet with three drawers", "small cabinet"),
        ),
    }
}
