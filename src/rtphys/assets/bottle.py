"""Bottles and jars: a lathe-turned body, a label and one of several caps.

One row of sizes and one of colours define a bottle; the object modules have the rows.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from rtphys.assets.asset_model import Body, Part
from rtphys.assets.geometry import cylinder, rounded, tube
from rtphys.assets.labels import label
from rtphys.assets.material import Colour, Finish, metal, plastic
from rtphys.assets.solid import Solid, hull, together
from rtphys.assets.turned import disc, ring, split, turned, turned_parts


@dataclass(frozen=True)
class Bottle:
    """Sizes of a bottle [m]; radii are half widths, heights are above the ground."""

    height: float
    radius: float
    shoulder: float  # where the body ends
    collar: float  # where the neck begins
    neck: float  # its radius
    tag: tuple[float, float]  # label, from and to; equal for none
    mass: float  # [kg]
    waist: float = 1.0  # share of the radius at `grip`
    grip: float = 0.0  # height of the waist
    foot: float = 0.9  # share of the radius at the ground
    top: str = "screw"  # screw, sport, cork, crown, wide, jar, pump, flip
    filled: float = 0.0  # height of the contents' surface; 0 for opaque


@dataclass(frozen=True)
class Look:
    """Colours of shell, contents, cap and label, and the label's style."""

    shell: Colour
    contents: Colour
    cap: Colour
    ground: Colour
    accent: Colour
    ink: Colour
    style: str = "badge"
    material: str = "plastic"


def bottle_body(size: Bottle, look: Look) -> Body:
    """Visual parts, collision parts and mass of a bottle that stands on the origin."""
    outline = profile(size)
    shell = plastic(look.shell, 0.75)
    looks = [Part(turned(outline), shell, look.material)] if not size.filled else []
    if size.filled:
        below, above = split(outline, size.filled)
        looks += [
            Part(turned(below), plastic(look.contents, 0.75), look.material),
            Part(turned(above), shell, look.material),
        ]
    if size.tag[1] > size.tag[0]:
        looks.append(_label(size, look))
    caps, hulls = _top(size)
    looks.append(Part(caps, _cap_finish(size, look), look.material))
    return Body(tuple(looks), (*turned_parts(outline), *hulls), size.mass)


def profile(size: Bottle) -> np.ndarray:
    """Outline (N, 2) of (half width, y) [m] below the cap."""
    r, cap = size.radius, size.height - _CAPS[size.top][1]
    body: list[tuple[float, float]] = [(size.foot * r, 0), (r, 0.08 * size.height)]
    if size.waist < 1:
        body += [(r, size.grip - 0.034), (size.waist * r, size.grip - 0.016)]
        body += [(size.waist * r, size.grip + 0.016), (r, size.grip + 0.034)]
    edge = rounded([(0, 0), *body[:2]], 0.004, 1, closed=False)[:-1]
    top = [(r, size.shoulder), (size.neck, size.collar), (size.neck, cap)]
    soft = rounded([body[-1], *top], 0.02, 2, closed=False)
    return np.array([*edge, *body[1:-1], *soft, (0, cap)])


# Share of the neck's radius and height [m] of each kind of top.
_CAPS = {
    "screw": (1.18, 0.020),
    "sport": (1.15, 0.040),
    "cork": (1.06, 0.035),
    "crown": (1.15, 0.006),
    "wide": (1.10, 0.024),
    "jar": (1.06, 0.030),
    "pump": (1.10, 0.045),
    "flip": (1.05, 0.026),
}


def _label(size: Bottle, look: Look) -> Part:
    paper = plastic((1, 1, 1), 0.2).with_picture(
        label(look.ground, look.accent, look.ink, look.style), "cylinder"
    )
    radius = size.radius * (size.waist if size.tag[0] < size.grip < size.tag[1] else 1)
    return Part(ring(radius + 0.0004, *size.tag), paper, "paper")


def _cap_finish(size: Bottle, look: Look) -> Finish:
    return metal(look.cap) if size.top in ("crown", "cork") else plastic(look.cap, 0.3)


def _top(size: Bottle) -> tuple[Solid, tuple[Solid, ...]]:
    """The visible cap and its collision parts."""
    share, tall = _CAPS[size.top]
    wide, low = share * size.neck, size.height - tall
    if size.top == "sport":
        lid = disc(wide, low, low + 0.016)
        nozzle = turned([(0, 0), (0.6 * wide, 0), (0.35 * wide, 0.024), (0, 0.024)])
        nozzle = nozzle.at(y=low + 0.016)
        return lid + nozzle, (lid, nozzle)
    if size.top == "pump":
        collar, rod = disc(wide, low, low + 0.016), disc(0.004, low + 0.016, size.height - 0.012)
        head = _spout(wide).at(y=size.height - 0.012)
        return together(collar, rod, head), (collar, rod, head)
    lid = disc(wide, low, size.height)
    if size.top == "screw":
        grip = ring(wide + 0.0006, low + 0.002, low + 0.006)
        return lid + grip, (lid,)
    return lid, (lid,)


def _spout(radius: float) -> Solid:
    """A pump's head, convex: it points along +z and keeps within a bottle's width."""
    button = cylinder(0.7 * radius, 0.012, 12).at(y=0.006)
    tip = np.array([(x, y, 0.026) for x in (-0.004, 0.004) for y in (0.003, 0.010)])
    return hull([*button.vertices, *tip])


def with_handle(
    body: Body, path: Sequence[tuple[float, float, float]], finish: Finish | None = None
) -> Body:
    """The body with a handle along `path`; each straight piece collides."""
    bar = tube(path, 0.006, 6)
    legs = [hull(tube(leg, 0.0055, 6).vertices) for leg in pairwise(path)]
    first = body.visual[0]
    looks = (*body.visual, Part(bar, finish or first.finish, first.material))
    return Body(looks, (*body.collision, *legs), body.mass_kg)
