"""Coulomb friction: a plate stops after v² / 2 mu g and starts when pushed by more than mu m g."""

import numpy as np

from rtphys.physics.handles import GRAVITY
from rtphys.physics.values import Value
from rtphys.proofs.grip import finger_friction
from rtphys.proofs.hold import creep, lost_at
from rtphys.proofs.lab import Lab, launch, pose_of, puck, record
from rtphys.proofs.proof import Proof, Trace, Trial, Values, number

RUNWAY = 0.25  # [m] stopping distance for which the plate is launched
ROUGH = 0.1  # ten times the slope of the table in COMPANY
HELD = 0.05  # of 2 mu N: the hand yields while the load grows
CREPT = 0.05  # [mm/s]
FALL = 50  # [steps] until the plate, dropped from 1 mm, lies still


def stopping(lab: Lab, values: Values, mu: float) -> tuple[float, Trace]:
    """Distance [m] that a plate slides after a launch at the speed that should give RUNWAY."""
    world = lab.world([puck(x=0.0)], values)
    body = world.bodies[0]
    for _ in range(FALL):
        world.step()
    speed = float(np.sqrt(2 * mu * GRAVITY * RUNWAY))
    start = pose_of(body).p[0]
    launch(body, (speed, 0.0, 0.0))
    t, x = record(
        world, int(250 * 1.3 * speed / (mu * GRAVITY)) + 10, lambda: pose_of(body).p[0] - start
    )
    rest = np.minimum(t, speed / (mu * GRAVITY))
    law = speed * rest - mu * GRAVITY * rest**2 / 2
    return float(x[-1]), Trace(t, x, law, "time [s]", "distance [m]")


def breakaway(lab: Lab, values: Values, mu: float) -> float:
    """Smallest push [m g] that moves a plate, by bisection within ±10 % of `mu`."""
    low, high = 0.9 * mu, 1.1 * mu
    if _slips(lab, values, low) or not _slips(lab, values, high):
        return float("nan")
    for _ in range(4):
        middle = (low + high) / 2
        low, high = (low, middle) if _slips(lab, values, middle) else (middle, high)
    return (low + high) / 2


def _slips(lab: Lab, values: Values, push: float) -> bool:
    world = lab.world([puck(x=0.0)], {**values, "external_force": push})
    body = world.bodies[0].component
    for _ in range(FALL):
        world.step()
    world.policy_stage = True
    for _ in range(100):
        world.step()
    # 1 % above breakaway gives 0.01 mu g over 0.4 s; creep below it stays far under that.
    return bool(body.linear_velocity[0] > 2e-3 * push * GRAVITY * 0.4)


def run(lab: Lab, value: Value, others: Values) -> list[Trial]:
    values, mu = {**others, "friction": value}, number(value)
    # On a tilted table a plate that is nearly without friction slides by itself.
    table = {**values, "table_tilt": 0.0} if mu < ROUGH else values
    distance, trace = stopping(lab, table, mu)
    trials = [
        Trial("stopping distance v²/2μg on the table", RUNWAY, distance, "m", trace=trace),
        Trial("breakaway push on the table", mu, breakaway(lab, table, mu), "m·g"),
        Trial("coefficient between finger and object", mu, finger_friction(lab, values, mu), "1"),
    ]
    if mu < ROUGH:  # the fingers lean by more than the angle of friction, as hands do
        return trials
    # A load aside of the pads turns between them before it slips.
    held = {**values, "center_of_mass": (0.0, 0.0, 0.0)}
    dropped, crept = lost_at(lab, held, mu), creep(lab, held, mu)
    return [
        *trials,
        Trial("load that is lost from the hand", 1.0, dropped, "2μN", tolerance=HELD),
        Trial("creep under half that load", 0.0, crept, "mm/s", 1.0, CREPT),
    ]


PROOF = Proof(
    "friction",
    "stopping distance = v² / 2 μ g;  breakaway push = μ m g;  F_slip = 2 μ N between fingers",
    (0.5, 0.01, 0.3, 1.25),
    run,
    ({"restitution": 0.5}, {"object_mass": 4.0, "restitution": 0.25}),
)
