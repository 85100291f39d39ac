"""Put the computer mouse on the coloured pad, lengthwise.

Success: the mouse lies on the pad's centre along its length, at rest, and both hands are open.
Added to upstream's test: height and rest.
"""

from math import pi

from rtphys.task import (
    IDENTITY,
    SHORT_COLOURS,
    UP_Y,
    Aim,
    Draw,
    Mesh,
    Placing,
    Pose,
    Robot,
    Task,
    at_rest,
    clear_of,
    hands_open,
    near,
    off_centre,
    parallel,
    yawed,
)

from ._pads import coloured_pad

LENGTHWISE = Placing(mode="align", pre=0.07, gap=0.003, yaws=(0.0, pi))
LIFT, RETREAT = 0.1, 0.07  # [m] to carry the mouse; back from it once it is released


def layout(draw: Draw):
    mouse = draw.spot(
        "mouse", x=(-0.25, 0.25), y=(-0.2, 0.0), yaw=(-pi, pi), where=off_centre(0.05)
    )
    model = draw.choice("model", 0, 1, 2)
    yield Mesh(name="mouse", category="047_mouse", model=model, pose=mouse.pose(UP_Y))
    side = (0.05, 0.25) if mouse.x > 0 else (-0.25, -0.05)
    pad = draw.spot("pad", x=side, y=(-0.2, 0.0), where=clear_of((mouse, 0.1)))
    yield coloured_pad(draw, pad, (0.035, 0.065, 0.0005), SHORT_COLOURS)


def script(robot: Robot) -> None:
    arm = robot.nearest("mouse")
    pad = Pose(robot.scene.functional("pad", 1).p, yawed(IDENTITY, pi))
    robot.do(arm.grasp("mouse", aim=Aim(pad, None, LENGTHWISE)))
    robot.do(arm.lift(LIFT))
    robot.do(arm.place("mouse", pad, how=LENGTHWISE))
    robot.do(arm.retreat(RETREAT))


task = Task(
    layout=layout,
    script=script,
    success=near("mouse", "pad", within=(0.015, 0.012, 0.01))
    & parallel("mouse", 2, (0, 1, 0), within=0.45)
    & at_rest("mouse")
    & hands_open(),
    step_limit=400,
    mechanism="place: aligned",
    info={"A": "mouse", "B": "pad", "a": "arm:mouse"},
)
