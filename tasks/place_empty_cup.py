"""Put the cup on the coaster.

Success: the cup's foot is on the coaster's middle, the cup upright and at rest, and both hands
are open.
"""

from rtphys.task import (
    UP_Y,
    Aim,
    Draw,
    Mesh,
    Placing,
    Robot,
    Task,
    at_rest,
    clear_of,
    hands_open,
    points_meet,
    upright,
)

from ._by_the_rim import HALF_OPEN, OUTER, release_rim

LIFT, RETREAT = 0.08, 0.06  # [m] to carry the cup; up from it once it is released
# The coaster's point is 5 to 8 mm under its surface.
ONTO = Placing(mode="free", pre=0.05, gap=-0.006, along="point", release=False)


def layout(draw: Draw):
    sign = draw.choice("side", -1, 1)
    cup_x, coaster_x = ((0.15, 0.3), (-0.05, 0.1)) if sign > 0 else ((-0.3, -0.15), (-0.1, 0.05))
    cup = draw.spot("cup", x=cup_x, y=(-0.2, 0.05))
    yield Mesh(name="cup", category="021_cup", model=0, pose=cup.pose(UP_Y))
    coaster = draw.spot("coaster", x=coaster_x, y=(-0.2, 0.05), where=clear_of((cup, 0.14)))
    yield Mesh(
        name="coaster", category="019_coaster", model=0, pose=coaster.pose(UP_Y), fixed=True
    )  # fmt: skip


def script(robot: Robot) -> None:
    arm, spot = robot.nearest("cup"), robot.scene.functional("coaster", 0)
    robot.do(arm.close(HALF_OPEN))
    robot.do(arm.grasp("cup", OUTER[arm.side], aim=Aim(spot, 0, ONTO)))
    robot.do(arm.lift(LIFT))
    robot.do(arm.place("cup", spot, point=0, how=ONTO))
    release_rim(robot, arm, RETREAT)


task = Task(
    layout=layout,
    script=script,
    success=points_meet("cup", 0, "coaster", 0, within=(0.035, 0.035, 0.015))
    & upright("cup", axis=1, within=0.2)
    & at_rest("cup")
    & hands_open(),
    step_limit=500,
    mechanism="place",
    info={"A": "cup", "B": "coaster"},
)
