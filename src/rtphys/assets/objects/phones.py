"""077_phone: flat slabs that lie screen up, and 4 screen down as the official one."""

from dataclasses import dataclass
from functools import partial

import numpy as np

from rtphys.assets.asset_model import AssetModel, Body, Part, contact, functional
from rtphys.assets.geometry import box, cylinder, rounded_box
from rtphys.assets.lettering import write
from rtphys.assets.material import Colour, Picture, metal, plastic
from rtphys.assets.objects import Models
from rtphys.assets.pictures import to_picture
from rtphys.assets.solid import together
from rtphys.assets.urdf import placed

BEHIND = 0.003  # [m] how far behind the back its functional point lies: room to lean in a stand
QUARTER = np.pi / 2
# Model frame <- the frame they are made in: bottom edge at +z, screen up. One a model number.
AS_MADE = placed((0, 0, 0))
TO_LEFT, TO_RIGHT = placed((0, 0, 0), (0, -QUARTER, 0)), placed((0, 0, 0), (0, QUARTER, 0))


@dataclass(frozen=True)
class Phone:
    """Sizes [m], mass [kg] and how it lies in its model frame."""

    width: float
    thickness: float
    length: float
    mass: float
    pose: np.ndarray
    camera_up: float  # along z as made, of contact point 0
    turns: int = 0  # quarters by which the picture, laid on in the model frame, follows the pose


def phone(
    size: Phone, case: Colour, glow: tuple[Colour, Colour], lenses: int, words: tuple[str, ...]
) -> AssetModel:
    """A telephone: frame, lit screen with icons, lenses on the back."""
    w, t, length = size.width, size.thickness, size.length
    slab = rounded_box(w, t, length, 0.35 * t, 2).at(y=t / 2)
    glass = box(0.93 * w, 0.0006, 0.955 * length).at(0, t, 0)
    lit = plastic((1, 1, 1), 0.7).with_picture(np.rot90(_home(*glow), size.turns).copy(), "y")
    eyes = [
        cylinder(0.005, 0.001, 12).at(0.3 * w, -0.0002, -0.43 * length + 0.014 * i)
        for i in range(lenses)
    ]
    rim = box(0.97 * w, 0.0004, 0.975 * length).at(0, t - 0.0001, 0)
    button = box(0.0012, 0.3 * t, 0.016).at(w / 2, t / 2, -0.2 * length)
    looks = (
        Part(slab, plastic(case, 0.5), "aluminium"),
        Part(glass, lit, "glass"),
        Part(rim, plastic((0.02, 0.02, 0.02), 0.8), "glass"),
        Part(together(button, *eyes), metal((0.30, 0.30, 0.32)), "aluminium"),
    )
    points = [contact((0, t / 2, 0), (0, 1, 0), (0, 0, s * size.camera_up)) for s in (1, -1)]
    foot = functional((0, -BEHIND, length / 2), (0, 0, -1), (0, 1, 0))
    X = size.pose
    return AssetModel(
        body=Body(
            tuple(Part(p.solid.placed(X), p.finish, p.material, p.crease_deg) for p in looks),
            (rounded_box(w, t, length, 0.35 * t, 1).at(y=t / 2).placed(X),),
            size.mass,
        ),
        material="glass",
        description=words,
        contact_points=tuple(X @ p for p in points),
        functional_points=(X @ foot,),
        categories=("phone", "electronics"),
    )


def _home(top: Colour, bottom: Colour) -> Picture:
    """Picture of a home screen: clock, rows of icons, dock; its lower edge is the phone's."""
    ramp = np.linspace(0, 1, 64)[:, None, None]
    canvas = np.broadcast_to((1 - ramp) * top + ramp * np.array(bottom), (64, 32, 3)).copy()
    write(canvas, "12:30", 6, (1.0, 1.0, 1.0))
    icons = ((0.95, 0.3, 0.25), (0.98, 0.8, 0.2), (0.3, 0.8, 0.4), (0.95, 0.95, 0.95))
    for r in range(4):
        for c in range(4):
            y, x = 18 + 8 * r, 3 + 7 * c
            canvas[y : y + 5, x : x + 5] = icons[(r + c * 3) % 4]
    canvas[54:62, 2:30] = canvas[54:62, 2:30] * 0.5 + 0.4
    for c in range(4):
        canvas[56:61, 4 + 7 * c : 8 + 7 * c] = icons[c]
    return to_picture(canvas)


FACE_DOWN = TO_RIGHT @ placed((0, 0, 0), (0, 0, np.pi))
BLACK, WHITE, GOLD = (0.08, 0.08, 0.09), (0.90, 0.90, 0.91), (0.82, 0.68, 0.42)
RED, BLUE = (0.72, 0.10, 0.14), (0.14, 0.28, 0.55)

MODELS: Models = {
    "077_phone": {
        0: partial(
            phone,
            Phone(0.0750, 0.0148, 0.1505, 0.215, AS_MADE, -1),
            BLACK,
            ((0.10, 0.25, 0.60), (0.35, 0.65, 0.90)),
            3,
            ("black phone", "smartphone", "phone with a blue screen", "black mobile phone"),
        ),
        1: partial(
            phone,
            Phone(0.0642, 0.0135, 0.1505, 0.165, TO_LEFT, -1, -1),
            WHITE,
            ((0.55, 0.20, 0.50), (0.95, 0.60, 0.45)),
            2,
            ("white phone", "slim white smartphone", "narrow phone", "white mobile phone"),
        ),
        2: partial(
            phone,
            Phone(0.0746, 0.0150, 0.1505, 0.205, TO_RIGHT, 1, 1),
            GOLD,
            ((0.10, 0.40, 0.35), (0.55, 0.85, 0.55)),
            2,
            ("golden phone", "gold smartphone", "phone with a green screen", "golden mobile phone"),
        ),
        3: partial(
            phone,
            Phone(0.0770, 0.0178, 0.1500, 0.240, TO_RIGHT, 1, 1),
            RED,
            ((0.20, 0.20, 0.25), (0.50, 0.50, 0.60)),
            1,
            ("red phone", "thick red smartphone", "phone in a red case", "red mobile phone"),
        ),
        4: partial(
            phone,
            Phone(0.0776, 0.0172, 0.1505, 0.225, FACE_DOWN, 1, -1),
            BLUE,
            ((0.45, 0.30, 0.10), (0.98, 0.80, 0.35)),
            3,
            ("blue phone", "wide blue smartphone", "phone in a blue case", "blue mobile phone"),
        ),
    }
}
