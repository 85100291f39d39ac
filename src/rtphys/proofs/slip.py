"""Slip on the table: the push at which standing objects slide, over friction and centre of mass."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial import Delaunay, QhullError

from rtphys.core.poses import Array, Pose
from rtphys.physics.handles import GRAVITY
from rtphys.proofs.lab import Lab, pose_of
from rtphys.sim.body import SimBody
from rtphys.sim.engine import RATE, TIME_STEP
from rtphys.sim.feet import FLAT, has_feet
from rtphys.sim.room import TOP_HALF
from rtphys.sim.world import World
from rtphys.task.props import TABLE_TOP, Prop

LOW, HIGH, RATE_OF_PUSH = 0.7, 1.1, 0.2  # push [mu m g] where slip is looked for, its end; [1/s]
EASE = 1.0  # [s] in which the push grows to LOW: a blow would rock what is tall
AFTER = 0.1  # [s] from the slip until it is noticed
REST = RATE  # [steps] until the objects stand
MARGIN = 0.95  # of the face on which an object stands: what pushes harder tips it
GAP = 0.06  # [m] between two copies: they slide by less than half of that


@dataclass(frozen=True)
class Slip:
    """What one pushed object did."""

    share: float  # push at which it slid [mu m g]; Coulomb says 1
    turned: float  # [deg] until the ramp's end; Coulomb says 0
    on_feet: bool


def slips(lab: Lab, prop: Prop, mu: float, offsets: Sequence[Array]) -> list[Slip | None]:
    """Push copies of one object along x at their centres of mass, which `offsets` (3,) [m] move.

    None stands for a copy that does not stand by itself, or that would tip before it slides.
    """
    alone = lab.world([prop.at(Pose((0, 0, 0), prop.pose.q))], {"friction": mu})
    size = float(np.ptp((pose_of(alone.bodies[0]) @ alone.bodies[0].hull)[:, :2], axis=0).max())
    found: list[Slip | None] = []
    for start in range(0, len(offsets), len(places := list(_places(size)))):
        found += _pushed(lab, prop, mu, offsets[start : start + len(places)], places)
    return found


def _places(size: float) -> Iterator[tuple[float, float]]:
    """Places (x, y) [m] on the table for copies of an object of this size."""
    for x in np.arange(-TOP_HALF[0] + size / 2, TOP_HALF[0] - size / 2 - GAP, size + GAP):
        for y in np.arange(-TOP_HALF[1] + size / 2, TOP_HALF[1] - size / 2, size + GAP):
            yield float(x), float(y)


def _pushed(
    lab: Lab,
    prop: Prop,
    mu: float,
    offsets: Sequence[Array],
    places: Sequence[tuple[float, float]],
) -> list[Slip | None]:
    copies = [
        replace(prop, name=f"copy{i}", pose=Pose((*place, 0), prop.pose.q))
        for i, (place, _) in enumerate(zip(places, offsets, strict=False))
    ]
    world = lab.world(copies, {"friction": mu})
    for body, offset in zip(world.bodies, offsets, strict=True):
        body.set_com(body.nominal_com + pose_of(body).R.T @ offset)
    for _ in range(REST):
        world.step()
    tried = [i for i, body in enumerate(world.bodies) if _stands(body, mu)]
    before = {i: pose_of(world.bodies[i]) for i in tried}
    shares = _ramp(world, tried, mu)
    return [
        Slip(
            shares.get(i, HIGH),
            float(np.degrees(before[i].angle_to(pose_of(body)))),
            has_feet(body.component),
        )
        if i in before
        else None
        for i, body in enumerate(world.bodies)
    ]


def _ramp(world: World, tried: list[int], mu: float) -> dict[int, float]:
    """Body -> push [mu m g] at which it began to slide, found from its speed AFTER seconds."""
    fast = RATE_OF_PUSH * mu * GRAVITY * AFTER**2 / 2
    grow = np.arange(LOW, HIGH, RATE_OF_PUSH * TIME_STEP)
    pushes = [*np.linspace(0, LOW, int(EASE * RATE), endpoint=False), *grow]
    shares: dict[int, float] = {}
    for share in pushes:
        for i in tried:
            body = world.bodies[i]
            push = share * mu * body.mass * GRAVITY
            body.component.add_force_torque([push, 0.0, 0.0], [0.0, 0.0, 0.0])
        world.step()
        for i in tried:
            slid = world.bodies[i].component.linear_velocity[0] > fast
            if share >= LOW and i not in shares and slid:
                shares[i] = share - RATE_OF_PUSH * AFTER
    return shares


def _face(body: SimBody) -> Array:
    """Points (n, 2) of the face on which a body stands, world frame [m]."""
    points = pose_of(body) @ body.hull
    return points[points[:, 2] < points[:, 2].min() + FLAT][:, :2]


def _stands(body: SimBody, mu: float) -> bool:
    """Whether a body rests on a face within which its weight and the strongest push act."""
    com, face = pose_of(body) @ body.com, _face(body)
    middle = face.mean(axis=0)
    try:
        inner = Delaunay(middle + MARGIN * (face - middle))
    except (QhullError, ValueError):  # a point or a line
        return False
    ahead = np.array([HIGH * mu * (com[2] - TABLE_TOP), 0.0])
    return bool((inner.find_simplex([com[:2], com[:2] + ahead]) >= 0).all())
