"""Coulomb friction on the table, on objects, of the pads, and of a load in the hand.

A plate stops after v² / 2 mu g and starts when pushed by more than mu m g, as does one that stands
across the edge of a block; a block pulled through the fingers is slowed by 2 mu N, and a load slips
out of the robot's hand at 2 mu N.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from rtphys.core.poses import Array, Pose
from rtphys.laws.lab import NONE, Lab, floating, hold, launch, pose_of, puck, record, slope, wait
from rtphys.laws.law import LawTest, Trial, Values, number
from rtphys.physics.handles import GRAVITY
from rtphys.physics.values import Value
from rtphys.sim.body import SimBody
from rtphys.sim.engine import RATE, TIME_STEP, to_sapien
from rtphys.sim.robot import SimArm
from rtphys.sim.world import World
from rtphys.task.props import Ball, Box, Prop

# ---- the fingers -----------------------------------------------------------------------------

HALF = 0.02  # [m] half the thickness between the fingers
LONG = 0.03  # [m] along the pull: stays between the pads while it is pulled
FREE = 0.002  # [m] between the block and the palm
GRIP = 0.004  # [m] depth of the finger targets inside the block: a few newtons, which the arm bears
DENSITY = 5000.0  # [kg/m³] heavy enough that a 4 ms step does not jerk it
SPARE = 8.0  # [m/s²] of the pull beyond friction: the pads yield a little, the block must slide
CLOSE, PULL, SLIDING = 300, 20, 5  # [steps] until the grip is steady; of the pull; until it slides


def _between_fingers(
    lab: Lab, values: Values, prop: Callable[[SimArm], Prop]
) -> tuple[World, SimBody]:
    """The "block" that `prop` makes for the left arm's home posture, without gravity."""
    empty = lab.world([], values)  # a name keeps it alive: its robot dies with it
    world = lab.world([prop(empty.robot.left)], values)
    return world, floating(world, "block")


def finger_friction(lab: Lab, values: Values, mu: float) -> float:
    """Coefficient between finger pad and block [1].

    The fingers close on a block, which is then pulled across them by a force that exceeds 2 mu N if
    the label is right: m a = F - 2 mu N, with N from the contacts.
    """

    def block(arm: SimArm) -> Box:
        half = (min(LONG, arm.limb.hand.palm - FREE), HALF, LONG)
        held = Box(name="block", pose=arm.tcp(), half_size=half, density=DENSITY)
        return replace(held, resting=False, on_table=False)

    world, body = _between_fingers(lab, values, block)
    arm, limb = world.robot.left, world.robot.left.limb
    # The block may not turn: turning between the pads would take up some of the friction.
    locked = [False, False, False, True, True, True]
    body.component.set_locked_motion_axes(locked)  # pyright: ignore[reportAttributeAccessIssue]
    closed, fully = (limb.finger_signs[0] * limb.finger_target(x) for x in (0.0, 1.0))
    arm.grip((HALF - GRIP - closed) / (fully - closed))
    wait(world, CLOSE)
    along = arm.ee().R[:, 2]
    force = 2 * mu * squeeze(world) + SPARE * body.mass
    t, recorded = record(
        world,
        PULL,
        lambda: (body.component.linear_velocity @ along, squeeze(world)),
        lambda: body.component.add_force_torque((force * along).tolist(), NONE),
    )
    a, normal = slope(t[SLIDING:], recorded[SLIDING:, 0]), recorded[SLIDING:, 1].mean()
    return float((force - body.mass * a) / (2 * normal))


def squeeze(world: World) -> float:
    """Force [N] with which one finger presses on the block, from the contacts' impulses."""
    total = 0.0
    for contact in world.scene.get_contacts():
        if "block" in {body.entity.name for body in contact.bodies}:
            impulse = sum((p.impulse for p in contact.points), np.zeros(3))
            total += float(np.linalg.norm(impulse)) * RATE
    return total / 2


# ---- a load in the hand ------------------------------------------------------------------------

PRESS = 25.0  # [N] about what the closed hand presses; N itself is read from the contacts
HOLD = 350  # [steps] until the grip is steady
LOW, HIGH, RAMP = 0.8, 1.2, 1.0  # share of 2 mu N at the ramp's ends, and its length [s]
FAST = 0.05  # [m/s] against the fingers: it is lost, not creeping
TENTH = RATE // 10  # [steps]


def lost_at(lab: Lab, values: Values, mu: float) -> float:
    """Share of 2 mu N at which a growing load pulls a block out of the hand [1].

    The block weighs what 2 mu N would carry, so that a load of one accelerates it by about g. From
    the moment of the slip its speed grows as a ramp's integral, by which that moment is found.
    """
    world, body, normal = _gripped(lab, values, mu)
    load, rate = 2 * mu * normal, (HIGH - LOW) / RAMP
    for step in range(RATE):  # gently, so that the hand has yielded before it matters
        _pull(world, body, LOW * load * step / RATE)
    for step in range(int(RAMP * RATE)):
        share = LOW + rate * step * TIME_STEP
        before = _in_hand(world, body)
        _pull(world, body, share * load)
        speed = float(np.linalg.norm(_in_hand(world, body) - before)) * RATE
        if speed > FAST:
            return share - rate * float(np.sqrt(2 * FAST * body.mass / (rate * load)))
    return float("nan")


@dataclass(frozen=True)
class Grip:
    """How a thing is held."""

    aside: float = 0.0  # [m] of its centre of mass from the line through the pads
    out: float = 0.0  # [m] of the thing from the pads' middle towards their tips
    mass: float | None = None  # [kg]; None: what 2 mu N would carry
    ball: bool = False  # it is round
    creeps: float = 1.0  # [mm/s] at most


CENTRED = Grip()
GRIPS = {
    "a light block that is pulled": Grip(mass=0.085),
    "a block with its mass 25 mm aside": Grip(aside=0.025),
    "a ball": Grip(ball=True, creeps=2.5),
    "a block at the tips": Grip(out=0.03),
}


def creep(lab: Lab, values: Values, mu: float, share: float, grip: Grip = CENTRED) -> float:
    """Speed [mm/s] of a thing in the hand under a share of 2 mu N, once the hand has yielded."""
    world, body, normal = _gripped(lab, values, mu, grip)
    load, start = 2 * share * mu * normal, np.zeros(3)
    for step in range(2 * RATE):
        _pull(world, body, load * min(1.0, 2 * step / RATE))
        if step == RATE - 1:
            start = _in_hand(world, body)
    return float(np.linalg.norm(_in_hand(world, body) - start)) * 1000


def _gripped(
    lab: Lab, values: Values, mu: float, grip: Grip = CENTRED
) -> tuple[World, SimBody, float]:
    """A thing in the left hand, without gravity, and the force [N] of one finger."""

    def thing(arm: SimArm) -> Prop:
        at, half = arm.tcp().moved(grip.out * arm.ee().R[:, 0]), arm.limb.hand.palm - FREE
        held = Box(name="block", pose=at, half_size=(min(HALF, half), HALF, HALF))
        ball = Ball(name="block", pose=at, radius=HALF)
        mass = grip.mass or 2 * mu * PRESS / GRAVITY
        return replace(ball if grip.ball else held, mass_kg=mass, resting=False, on_table=False)

    world, body = _between_fingers(lab, values, thing)
    up = world.robot.left.ee().R[:, 2]
    if grip.aside:
        body.set_com(body.nominal_com + pose_of(body).R.T @ (grip.aside * up))
    for locked, steps in ((True, HOLD), (False, TENTH)):
        hold(body.component, locked)
        world.robot.left.grip(0.0)
        wait(world, steps)
    _, pressed = record(world, TENTH, lambda: squeeze(world))
    return world, body, float(pressed.mean())


def _pull(world: World, body: SimBody, force: float) -> None:
    """One step under a force [N] along the fingers, away from the palm."""
    along = world.robot.left.ee().R[:, 0]
    body.component.add_force_torque((force * along).tolist(), NONE)
    world.step()


def _in_hand(world: World, body: SimBody) -> Array:
    """Centre of mass (3,) [m] from the middle between the fingers, in the hand's own frame."""
    arm = world.robot.left
    fingers = [np.asarray(link.entity_pose.p, float) for link in arm.finger_links]
    return arm.ee().R.T @ (pose_of(body) @ body.com - sum(fingers) / 2)


# ---- the table -----------------------------------------------------------------------------------

RUNWAY = 0.25  # [m] stopping distance for which the plate is launched
ROUGH = 0.1  # ten times the slope of the table in ALL_VARIED
HELD = 0.05  # of 2 mu N: the hand yields while the load grows
CREPT = 0.05  # [mm/s] of a centred block
HALF_LOAD, QUARTER = 0.5, 0.25  # of 2 mu N: what a centred block bears without creep; what all do
FALL = 50  # [steps] until the plate, dropped from 1 mm, lies still
ONSET = 100  # [steps] of a push


def stopping(lab: Lab, values: Values, mu: float) -> float:
    """Distance [m] that a plate slides after a launch at the speed that should give RUNWAY."""
    world = lab.world([puck(x=0.0)], values, FALL)
    body = world.bodies[0]
    speed, start = float(np.sqrt(2 * mu * GRAVITY * RUNWAY)), pose_of(body).p[0]
    launch(body, (speed, 0.0, 0.0))
    wait(world, int(250 * 1.3 * speed / (mu * GRAVITY)) + 10)
    return float(pose_of(body).p[0] - start)


def threshold(slides: Callable[[float], bool], mu: float) -> float:
    """Smallest push [m g] that moves something, by bisection within ±10 % of `mu`."""
    low, high = 0.9 * mu, 1.1 * mu
    if slides(low) or not slides(high):
        return float("nan")
    for _ in range(4):
        middle = (low + high) / 2
        low, high = (low, middle) if slides(middle) else (middle, high)
    return (low + high) / 2


def breakaway(lab: Lab, values: Values, mu: float) -> float:
    """Smallest push [m g] that moves a plate on the table."""

    def slides(push: float) -> bool:
        world = lab.world([puck(x=0.0)], {**values, "external_force": push}, FALL)
        world.policy_stage = True
        wait(world, 100)
        # 1 % above breakaway gives 0.01 mu g over 0.4 s; creep below it stays far under that.
        speed = world.bodies[0].component.linear_velocity[0]
        return bool(speed > 2e-3 * push * GRAVITY * 0.4)

    return threshold(slides, mu)


BELOW, ABOVE = (0.03, 0.03, 0.03), (0.03, 0.03, 0.006)  # [m] half sizes of a block, and of a plate
OVER = 0.01  # [m] by which the plate stands beyond the block: two of its corners bear nothing


def breakaway_on_object(lab: Lab, values: Values, mu: float) -> float:
    """Smallest push [m g] that moves a plate on a block."""
    apart = Pose((0.15, -0.15, 0)), Pose((0.15, 0.05, 0))
    props = [
        Box(name=name, pose=pose, half_size=half)
        for name, pose, half in zip(("block", "plate"), apart, (BELOW, ABOVE), strict=True)
    ]
    world = lab.world(props, values)
    block, plate = world.bodies
    wait(world, FALL)
    up = number(values.get("object_scale", 1.0)) * (BELOW[2] + ABOVE[2]) + 1e-4
    offset = world.X_WT.R @ (OVER, 0.0, up)
    home = to_sapien(Pose(pose_of(block).p + offset, pose_of(plate).q))
    hold(block.component, True)
    lean = np.sin(np.radians(number(values.get("table_tilt", 0.0))))

    def slides(push: float) -> bool:
        plate.component.entity.set_pose(home)
        launch(plate, (0, 0, 0))
        plate.component.set_angular_velocity(NONE)  # pyright: ignore[reportAttributeAccessIssue]
        wait(world, FALL)
        start = pose_of(plate) @ plate.com
        # Weight pulls it down the slope, too.
        force = plate.mass * GRAVITY * np.sqrt(max(0.0, push**2 * (1 - lean**2) - lean**2))
        for _ in range(ONSET):
            plate.component.add_force_torque([force, 0.0, 0.0], NONE)
            world.step()
        way = float((pose_of(plate) @ plate.com - start)[0])
        return way > 0.003 * push * GRAVITY * (ONSET * TIME_STEP) ** 2

    return threshold(slides, mu)


def run(lab: Lab, value: Value, others: Values) -> list[Trial]:
    values, mu = {**others, "friction": value}, number(value)
    # On a tilted table a plate that is nearly without friction slides by itself.
    table = {**values, "table_tilt": 0.0} if mu < ROUGH else values
    distance = stopping(lab, table, mu)
    on = lab.between("friction", mu)  # of two objects
    trials = [
        Trial("stopping distance v²/2μg on the table", RUNWAY, distance, "m"),
        Trial("breakaway push on the table", mu, breakaway(lab, table, mu), "m·g"),
        Trial("breakaway push on an object", on, breakaway_on_object(lab, table, on), "m·g"),
        Trial("coefficient between finger and object", mu, finger_friction(lab, values, mu), "1"),
    ]
    if mu < ROUGH:  # the fingers lean by more than the angle of friction, as hands do
        return trials
    # A load aside of the pads turns between them before it slips.
    held = {**values, "center_of_mass": (0.0, 0.0, 0.0)}
    dropped, crept = lost_at(lab, held, mu), creep(lab, held, mu, HALF_LOAD)
    trials += [
        Trial("load that is lost from the hand", 1.0, dropped, "2μN", tolerance=HELD),
        Trial("creep under half that load", 0.0, crept, "mm/s", 1.0, CREPT),
    ]
    for name, grip in GRIPS.items():
        crept = creep(lab, held, mu, QUARTER, grip)
        trials.append(Trial(f"creep of {name}, a quarter", 0.0, crept, "mm/s", 1.0, grip.creeps))
    return trials


LAW = LawTest(
    "friction",
    "stopping distance = v² / 2 μ g;  breakaway push = μ m g;  F_slip = 2 μ N between fingers",
    (0.5, 0.01, 0.3, 1.25),
    run,
    ({"restitution": 0.5}, {"object_mass": 4.0, "restitution": 0.25}),
)
