"""Printed packets for tea and coffee: cartons, tins, cans, bags and prisms."""

from dataclasses import dataclass

import numpy as np

from rtphys.assets.asset_model import Part
from rtphys.assets.geometry import box, circle, extrude, rounded_box
from rtphys.assets.material import Colour, Finish, Picture, plastic, tint
from rtphys.assets.solid import Solid, hull


@dataclass(frozen=True)
class Packet:
    """Sizes [m], kind and mass [kg]; `above` and `aside` are heights of grasps [m]."""

    x: float
    y: float
    z: float
    kind: str  # "carton", "tin", "can", "bag" or "prism"
    above: float
    aside: float
    mass: float


@dataclass(frozen=True, eq=False)
class Print:
    """Colours of body and lid, and the pictures on the front and on the sides."""

    colour: Colour
    lid: Colour
    front: Picture
    side: Picture


def packet(size: Packet, look: Print) -> tuple[tuple[Part, ...], tuple[Solid, ...]]:
    """Visual parts and convex collision parts. Raises KeyError for an unknown kind."""
    kinds = {"carton": _carton, "tin": _tin, "can": _can, "bag": _bag, "prism": _prism}
    return kinds[size.kind](size, look)


Made = tuple[tuple[Part, ...], tuple[Solid, ...]]


def _carton(size: Packet, look: Print) -> Made:
    x, y, z = size.x, size.y, size.z
    shell = rounded_box(x, y, z, 0.0015, 1).at(y=y / 2)
    flap = box(0.94 * x, 0.0006, 0.48 * z).at(0, y, 0.24 * z)
    looks = (
        Part(shell, plastic(look.colour, 0.3), "cardboard"),
        Part(flap, plastic(look.lid, 0.3), "cardboard"),
        *_labels(size, look, (0.90, 0.90), y / 2),
    )
    return looks, (shell,)


def _tin(size: Packet, look: Print) -> Made:
    """A tin with rounded edges and a lid that overlaps."""
    x, y, z = size.x, size.y, size.z
    body = rounded_box(0.985 * x, 0.86 * y, 0.985 * z, 0.006, 2).at(y=0.43 * y)
    lid = rounded_box(x, 0.20 * y, z, 0.006, 2).at(y=0.90 * y)
    looks = (
        Part(body, Finish(look.colour, 0.2, 0.35), "steel", 50),
        Part(lid, Finish(look.lid, 0.3, 0.3), "steel", 50),
        *_labels(size, look, (0.78, 0.62), 0.42 * y),
    )
    return looks, (body, lid)


def _can(size: Packet, look: Print) -> Made:
    """A round tin with a label around it."""
    r, y = size.x / 2, size.y
    sides = 20
    body = extrude(circle(0.98 * r, sides), 0.98 * y)
    rims = extrude(circle(r, sides), 0.05 * y) + extrude(circle(r, sides), 0.14 * y).at(y=0.86 * y)
    twice = np.concatenate([look.side, look.front], axis=1)
    label = extrude(circle(0.99 * r, sides), 0.74 * y).at(y=0.08 * y)
    looks = (
        Part(body, plastic(look.colour, 0.4), "cardboard"),
        Part(rims, Finish(look.lid, 0.3, 0.3), "steel"),
        Part(label, plastic((1, 1, 1), 0.4).with_picture(twice, "cylinder"), "paper", 50),
    )
    return looks, (extrude(circle(r, sides), y),)


def _bag(size: Packet, look: Print) -> Made:
    """A bag with a flat bottom and its top folded to an edge."""
    x, y, z = size.x, size.y, size.z
    foot = rounded_box(x, 0.70 * y, z, 0.004, 1).at(y=0.35 * y)
    shoulder = hull([
        *box(0.985 * x, 0.001, 0.95 * z).at(y=0.69 * y).vertices,
        *box(0.97 * x, 0.001, 0.16 * z).at(y=0.93 * y).vertices,
    ])  # fmt: skip
    crimp = box(0.97 * x, 0.09 * y, 0.13 * z).at(y=0.955 * y)
    looks = (
        Part(foot + shoulder, plastic(look.colour, 0.6), "paper"),
        Part(crimp, plastic(look.lid, 0.6), "paper"),
        *_labels(size, look, (0.80, 0.54), 0.35 * y),
    )
    return looks, (foot, shoulder, crimp)


def _prism(size: Packet, look: Print) -> Made:
    """A tin with chamfered corners and a flat lid."""
    x, y, z = size.x, size.y, size.z
    cut = 0.22 * min(x, z)
    outline = [
        (sx * (x / 2 - (0 if first else cut)), sz * (z / 2 - (cut if first else 0)))
        for sx, sz, first in (
            (1, -1, True), (1, 1, True), (1, 1, False), (-1, 1, False),
            (-1, 1, True), (-1, -1, True), (-1, -1, False), (1, -1, False),
        )
    ]  # fmt: skip
    body = extrude(np.array(outline) * 0.985, 0.9 * y)
    lid = extrude(outline, 0.16 * y).at(y=0.84 * y)
    looks = (
        Part(body, Finish(look.colour, 0.2, 0.35), "steel"),
        Part(lid, Finish(look.lid, 0.3, 0.3), "steel"),
        *_labels(size, look, (0.54, 0.66), 0.42 * y),
    )
    return looks, (body, lid)


def _labels(
    size: Packet, look: Print, share: tuple[float, float], middle: float
) -> tuple[Part, ...]:
    """Pictures on all four sides: two slabs through the packet that stand out by under 1 mm."""
    wide, tall = share
    out = 0.0008 if size.kind != "bag" else 0.0004
    front = box(wide * size.x, tall * size.y, size.z + out).at(y=middle)
    side = box(size.x + out, tall * size.y, wide * size.z).at(y=middle)
    paper = plastic((1, 1, 1), 0.35)
    # Of a light material: the slabs are printed skins and must not weigh as solid cardboard.
    return (
        Part(front, paper.with_picture(look.front, "z"), "wicker"),
        Part(side, paper.with_picture(look.side, "x"), "wicker"),
    )


def dark(colour: Colour) -> Colour:
    """A darker version of a colour, for printed shade."""
    return tint(colour, 0.55)
