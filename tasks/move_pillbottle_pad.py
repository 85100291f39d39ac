"""Stand the pill bottle on the small blue pad.

Success: the bottle stands upright on the pad's middle, at rest, and both hands are open.
"""

from rtphys.task import (
    BLUE,
    UP_Y,
    Aim,
    Box,
    Draw,
    Mesh,
    Placing,
    Robot,
    Task,
    at_rest,
    clear_of,
    hands_open,
    near,
    off_centre,
    on_table,
    upright,
)

ONTO = Placing(mode="free", pre=0.05, gap=0.002, along="point")
APPROACH, LIFT = 0.06, 0.05  # [m] straight on to the bottle; up before it is carried
RETREAT, ABOVE = 0.06, 0.1  # [m] off the bottle, or else up from it


def layout(draw: Draw):
    bottle = draw.spot("bottle", x=(-0.25, 0.25), y=(-0.1, 0.1), where=off_centre(0.05))
    model = draw.choice("model", 1, 2, 3, 4, 5)
    yield Mesh(name="bottle", category="080_pillbottle", model=model, pose=bottle.pose(UP_Y))
    side = (0.05, 0.25) if bottle.x > 0 else (-0.25, -0.05)
    pad = draw.spot("pad", x=side, y=(-0.2, 0.1), where=clear_of((bottle, 0.1)))
    yield Box(
        name="pad", half_size=(0.04, 0.04, 0.0005), colour=BLUE, pose=pad.pose(), fixed=True,
        phrase="blue pad",
    )  # fmt: skip


def script(robot: Robot) -> None:
    arm, pad = robot.nearest("bottle"), robot.scene.functional("pad", 1)
    robot.do(arm.grasp("bottle", pre=APPROACH, aim=Aim(pad, 0, ONTO)))
    robot.do(arm.lift(LIFT))
    robot.do(arm.place("bottle", pad, point=0, how=ONTO))
    # Near its base the arm cannot draw back any further: it leaves the bottle upwards.
    if not robot.tried(lambda: robot.do(arm.retreat(RETREAT))):
        robot.do(arm.lift(ABOVE))


task = Task(
    layout=layout,
    script=script,
    success=near("bottle", "pad", within=(0.03, 0.03, 0.01))
    & on_table("bottle")
    & upright("bottle", axis=1, within=0.2)
    & at_rest("bottle")
    & hands_open(),
    step_limit=400,
    mechanism="place",
    info={"A": "bottle", "a": "arm:bottle"},
)
