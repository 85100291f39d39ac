"""A ball that drops from height h bounces to e² h; objects of tasks leave slow impacts at e v."""

import numpy as np

from rtphys.core.poses import Pose
from rtphys.laws.lab import Lab, launch, pose_of, record, wait
from rtphys.laws.law import LawTest, Trial, Values, number
from rtphys.physics.attributes.restitution import deviation_at
from rtphys.physics.handles import GRAVITY
from rtphys.physics.values import Value
from rtphys.sim.body import SimBody
from rtphys.sim.engine import TIME_STEP, to_sapien
from rtphys.sim.world import World
from rtphys.task.props import TABLE_TOP, UP_Y, Ball, Box, Mesh, Prop

RADIUS, DROP = 0.025, 0.4  # [m] the drop is a free fall of the ball's lowest point
FULL = 0.25 * DROP  # [m] the bounce at the domain's end, e = 0.5
TOLERANCE = 0.06  # 250 Hz: an impact falls up to one step too early or late


def bounce(lab: Lab, values: Values) -> float:
    """Height [m] to which a ball bounces."""
    radius = RADIUS * number(values.get("object_scale", 1.0))
    start = TABLE_TOP + radius + DROP
    ball = Ball(name="ball", pose=Pose((0.15, 0, start)), radius=RADIUS, resting=False)
    world = lab.world([ball], values)
    body = world.bodies[0]
    t, z = record(world, 250, lambda: world.to_task(pose_of(body)).p[2] - TABLE_TOP - radius)
    first = int(np.argmax(t > np.sqrt(2 * DROP / GRAVITY) + 0.02))
    return float(z[first:].max())


SPEEDS = (0.3, 0.5, 1.0, 2.0)  # [m/s] at the impact
PHASES = 6  # places between two steps at which the impact falls
STRAIGHT = [True, True, False, True, True, True]  # it falls without turning
SETTLE = 50  # [steps] until an object stands


def rebounds(world: World, body: SimBody, speed: float, e: float) -> list[float]:
    """Two coefficients [1] of each of PHASES impacts: by speeds and by heights.

    The body must stand on the table or a little above it. It falls straight, without turning,
    wherever its centre of mass is.
    """
    rigid = body.component
    rigid.set_locked_motion_axes(STRAIGHT)  # pyright: ignore[reportAttributeAccessIssue]
    wait(world, SETTLE)
    home, found = pose_of(body), list[float]()
    for phase in range(PHASES):
        gap = speed * TIME_STEP * (1 + phase / PHASES)
        rigid.entity.set_pose(to_sapien(home.moved((0.0, 0.0, gap))))
        launch(body, (0, 0, -np.sqrt(max(0.0, speed**2 - 2 * GRAVITY * gap))))
        steps = int((gap / speed + e * speed / GRAVITY) / TIME_STEP) + 5
        _, path = record(world, steps, lambda: (pose_of(body).p[2], rigid.linear_velocity[2]))
        z, v = path[:, 0] - home.p[2], path[:, 1]
        back = int(np.argmax(v > 0)) if v.max() > 0 else len(v) - 1
        height, fast = (max(0.0, float(x[back:].max())) for x in (z, v))
        found += [fast / speed, float(np.sqrt(2 * GRAVITY * height)) / speed]
    return found


PLACE = Pose((0.15, 0, 0), UP_Y)
THINGS: tuple[Prop, ...] = (
    Box(name="block", pose=Pose(PLACE.p), half_size=(0.025, 0.025, 0.025)),
    Mesh(name="can", pose=PLACE, category="071_can", model=0),
    Mesh(name="cup", pose=PLACE, category="021_cup", model=0),
)


def run(lab: Lab, value: Value, others: Values) -> list[Trial]:
    e, values = number(value), {**others, "restitution": value}
    trials = [Trial("bounce height e² h", e**2 * DROP, bounce(lab, values), "m", FULL, TOLERANCE)]
    for thing in THINGS:
        world = lab.world([thing], values)
        for speed in SPEEDS:
            found = rebounds(world, world.bodies[0], speed, e)
            worst = max(found, key=lambda measured: abs(measured - e))
            what = f"{thing.name} leaves an impact at {speed:g} m/s"
            trials.append(Trial(what, e, worst, "1", 1.0, deviation_at(speed)))
    return trials


LAW = LawTest(
    "restitution",
    "bounce height = e² h;  speed after an impact = e v",
    (0.0, 0.25, 0.5),
    run,
    ({"friction": 1.25}, {"object_mass": 4.0, "friction": 0.01}),
    {"center_of_mass": (0.0, 0.0, -0.01)},  # aside it would turn a part of the bounce into spin
)
