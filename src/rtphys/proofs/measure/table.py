"""Lowers balls onto the table: where they come to rest is its plane, in the world frame."""

from itertools import product

import numpy as np

from rtphys.proofs.measure.finding import Finding, Measurement, Unmeasured
from rtphys.proofs.measure.specimen import Specimen
from rtphys.proofs.measure.throw import RADIUS, Spot, ball_at, cast
from rtphys.sim.room import TOP, TOP_HALF

ABOVE = 0.5  # [m] over the nominal top, from where rays look for the table
DOWN = np.array([0.0, 0.0, -1.0])
START, SPEED, STEPS = 1e-3, 0.1, 20  # [m] above the table; [m/s] too slow to bounce; to touch it
PLACES = list(product((-0.9, -0.6, -0.3, 0.0, 0.3, 0.6, 0.9), (-0.9, -0.45, 0.0, 0.45, 0.9)))
ENOUGH = 6  # places that the robot leaves free


def survey(specimen: Specimen) -> list[Finding]:
    """Height, tilt and lean of the table."""
    world = specimen.world
    plan, table = world.plan.table, world.room.table.components[0]
    shift = np.array([*plan.shift, 0.0])
    high = np.array([0.0, 0.0, TOP + ABOVE])
    starts = [shift + np.array([x, y, 0.0]) * TOP_HALF + high for x, y in PLACES]
    hits = [cast(world, start, DOWN) for start in starts]
    spots = [spot for spot in hits if spot is not None and spot.body is table]
    if len(spots) < ENOUGH:
        why = "the robot leaves too little of it free"
        return [Unmeasured(key, "table", why) for key in ("table_height", "table_tilt")]
    # Straight down, from a point straight above.
    above = [Spot(spot.body, spot.p, -DOWN) for spot in spots]
    balls = [ball_at(world, spot, START, SPEED * DOWN) for spot in above]
    for _ in range(STEPS):
        world.step()
    centres = np.array([ball.entity_pose.p for ball in balls], float)
    for ball in balls:
        ball.entity.remove_from_scene()
    # z = a + b x + c y through the balls' centres.
    a, b, c = np.linalg.lstsq(np.c_[np.ones(len(balls)), centres[:, :2]], centres[:, 2])[0]
    normal = np.array([-b, -c, 1.0]) / np.linalg.norm([b, c, 1.0])
    # The plane of the centres lies a radius above the table, along the normal.
    top = a + b * shift[0] + c * shift[1] - RADIUS / normal[2]
    height = float(top - TOP + plan.drop)
    lean = (float(np.degrees(np.arctan2(n, normal[2]))) for n in (normal[1], normal[0]))
    tilt = specimen.number("table_tilt")
    return [
        Measurement("table_height", "table", specimen.number("table_height"), height),
        Measurement("table_tilt", "table", (tilt, 0.0), tuple(lean)),
    ]
