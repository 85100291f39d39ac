"""044_microwave: a hollow box, a door hinged at its left edge with a bar to pull it by.

The fingers straddle the upright bar, which stands off the door as far as they reach past their
point. Points 0 and 3 are on the bar, 1 on the door's upper edge; 4, 5 and 2 are the same, turned a
little further open. The official knobs of model 0 do not turn here.
"""

from dataclasses import dataclass
from functools import partial

import numpy as np

from rtphys.assets.asset_model import ArticulatedModel, Body, Joint, Part, contact, functional
from rtphys.assets.geometry import box, cylinder, rounded_box
from rtphys.assets.lettering import write
from rtphys.assets.material import Colour, Finish, Picture, metal, plastic
from rtphys.assets.objects import Models
from rtphys.assets.pictures import plain, to_picture
from rtphys.assets.solid import Solid, together
from rtphys.assets.urdf import placed, root_joint

WALL = 0.008  # [m]
GAP = 0.001  # [m] between shut door and body
STEP = 0.17  # [rad] from a contact point to its twin further open
STEEP_DEG = 57.0  # [deg] how far down the first grasp looks


@dataclass(frozen=True)
class Oven:
    """Sizes [m] of the box, masses [kg]; z of its front, width of the panel beside the door."""

    width: float
    height: float
    depth: float
    front: float
    panel: float
    door: float  # thickness
    bar: tuple[float, float]  # y of its lower and upper end
    grip: float  # y of contact point 0
    root: float  # height of the root frame above the foot
    mass: tuple[float, float]  # body, door


def microwave(size: Oven, shell: Colour, face: Colour, words: tuple[str, ...]) -> ArticulatedModel:
    """A small microwave oven."""
    hinge = (-size.width / 2 + 0.004, 0.0, size.front + GAP)
    wide = size.width - size.panel - 0.004
    inside = (-size.panel / 2, -size.root + WALL + 0.012, size.front - size.depth / 2)
    return ArticulatedModel(
        links={
            "base": Body((), ()),
            "link_0": _box(size, shell, face),
            "link_1": _door(size, wide, face),
        },
        joints=(
            root_joint("base", "link_0"),
            Joint(
                "door",
                "revolute",
                "link_0",
                "link_1",
                placed(hinge),
                (0.0, -1.0, 0.0),
                (0.0, np.pi / 2),
                effort=20.0,
                damping=0.1,
            ),
        ),
        material="steel",
        description=words,
        root_height=size.root,
        contact_points=tuple(("link_1", m) for m in _points(size, wide)),
        functional_points=(("link_0", functional(inside, (0, 1, 0), (1, 0, 0))),),
        # A latch keeps a real door where it is on a tilted table.
        balanced=("link_1",),
        categories=("microwave", "kitchen"),
    )


def _box(size: Oven, shell: Colour, face: Colour) -> Body:
    w, h, d, t = size.width, size.height, size.depth, WALL
    middle = (h / 2 - size.root, size.front - d / 2)  # y, z
    inner = w - t - size.panel
    walls = [
        box(w, t, d).at(0, t / 2 - size.root, middle[1]),
        box(w, t, d).at(0, h - t / 2 - size.root, middle[1]),
        box(t, h - 2 * t, d).at(-(w - t) / 2, *middle),
        box(inner, h - 2 * t, t).at(t / 2 - size.panel / 2, middle[0], size.front - d + t / 2),
    ]
    panel = box(size.panel, h - 2 * t, d).at((w - size.panel) / 2, *middle)
    strip = box(size.panel - 0.004, h - 0.010, size.door).at(
        (w - size.panel) / 2 + 0.001, middle[0], size.front + size.door / 2
    )
    keypad = box(0.72 * size.panel, 0.70 * h, 0.001).at(
        (w - size.panel) / 2, middle[0] + 0.02 * h, size.front + size.door + 0.0003
    )
    plate = cylinder(0.36 * min(inner, d), 0.005, 20).at(
        t / 2 - size.panel / 2, t + 0.008 - size.root, middle[1]
    )
    print_ = plastic((1, 1, 1), 0.5).with_picture(_keypad(), "z")
    looks = (
        Part(together(*walls, panel), plastic(shell, 0.5), "steel"),
        Part(strip, plastic(face, 0.6), "plastic"),
        Part(keypad, print_, "plastic"),
        Part(plate, plastic((0.80, 0.86, 0.86), 0.8), "glass"),
    )
    return Body(looks, (*walls, panel, strip, plate), size.mass[0])


def _door(size: Oven, wide: float, face: Colour) -> Body:
    """In the hinge's frame: x along the door, its back at z = 0."""
    h, t = size.height - 0.006, size.door
    middle = size.height / 2 - size.root
    slab = box(wide, h, t).at(wide / 2 - 0.002, middle, t / 2)
    edge = rounded_box(wide, h, t, 0.002, 1).at(wide / 2 - 0.002, middle, t / 2)
    window = box(0.66 * wide, 0.62 * h, 0.0012).at(0.43 * wide, middle, t)
    low, high = size.bar
    x, z = _bar_at(size, wide)
    bar = rounded_box(0.013, high - low, 0.009, 0.0025, 1).at(x, (low + high) / 2, z)
    deep = z - t + 0.002
    posts = [
        box(0.009, 0.008, deep).at(x, y, t + deep / 2 - 0.001) for y in (low + 0.006, high - 0.006)
    ]
    steel = metal((0.80, 0.81, 0.83), 0.3)
    looks = (
        Part(edge, plastic(face, 0.6), "plastic"),
        Part(window, Finish((0.08, 0.09, 0.10), 0.2, 0.2), "glass"),
        Part(together(bar, *posts), steel, "aluminium"),
    )
    parts: tuple[Solid, ...] = (slab, bar, *posts)
    return Body(looks, parts, size.mass[1])


def _bar_at(size: Oven, wide: float) -> tuple[float, float]:
    """x and z of the bar in the hinge's frame."""
    return wide - 0.014, size.door + 0.026


def _points(size: Oven, wide: float) -> list[np.ndarray]:
    """The six official contact points, in the door's frame."""
    x, z = _bar_at(size, wide)
    a = np.radians(STEEP_DEG)
    top = size.height - size.root
    steep = contact((x, size.grip, z), (0, np.sin(a), np.cos(a)), (0, np.cos(a), -np.sin(a)))
    above = contact((x - 0.004, top - 0.010, size.door / 2), (0, 1, 0), (-1, 0, 0))
    level = contact((x, sum(size.bar) / 2, z + 0.012), (0, 0, 1), (0, 1, 0))
    ahead = placed((0, 0, 0), (0, -STEP, 0))
    return [steep, above, ahead @ above, level, ahead @ steep, ahead @ level]


def _keypad() -> Picture:
    canvas = plain((0.16, 0.17, 0.19), 24, 40)
    canvas[2:11, 2:22] = (0.02, 0.05, 0.04)
    write(canvas, "1:30", 4, (0.35, 0.95, 0.60))
    for r in range(4):
        for c in range(3):
            canvas[14 + 5 * r : 17 + 5 * r, 3 + 7 * c : 7 + 7 * c] = (0.75, 0.76, 0.78)
    canvas[34:38, 3:11], canvas[34:38, 13:21] = (0.75, 0.20, 0.18), (0.25, 0.65, 0.35)
    return to_picture(canvas)


MODELS: Models = {
    "044_microwave": {
        0: partial(
            microwave,
            Oven(
                0.234, 0.140, 0.155, 0.064, 0.048, 0.010, (-0.036, 0.058), 0.046, 0.0743, (2.6, 0.5)
            ),
            (0.88, 0.88, 0.87),
            (0.20, 0.21, 0.23),
            ("white microwave", "microwave oven", "microwave", "white microwave with a dark door"),
        ),
        1: partial(
            microwave,
            Oven(
                0.198, 0.133, 0.175, 0.072, 0.038, 0.010, (-0.044, 0.052), 0.018, 0.0639, (2.4, 0.4)
            ),
            (0.75, 0.16, 0.14),
            (0.86, 0.84, 0.80),
            ("red microwave", "small red microwave", "compact microwave", "red microwave oven"),
        ),
    }
}
