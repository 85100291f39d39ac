"""Put the sauce can beside the pot, on its own side.

Success: the can stands upright on the table beside the pot, on the side it came from, level with
the pot's middle, at rest, and both hands are open.
"""

from math import pi

from rtphys.task import (
    DOWN,
    UP_Y,
    Aim,
    Articulated,
    Condition,
    Draw,
    Mesh,
    Placing,
    Pose,
    Prop,
    Robot,
    Scene,
    Spot,
    Task,
    at_rest,
    clear_of,
    condition,
    hands_open,
    off_centre,
    on_table,
    upright,
)

ASIDE, REACH, LEVEL = 0.18, 0.2, 0.035  # [m] from the pot: aimed at, farthest, and in y
APPROACH = 0.05  # [m] straight on to the can
RETREATS = (0.06, 0.04, 0.025)  # [m] off it, as far as the arm folds; else up
UP, BACK = 0.1, 0.1  # [m] the way of the lift: up, and towards the robot
UPRIGHT = 0.26  # [rad] that the can may lean
POT = (0.0, 0.0, 0.0, 1.0)
BESIDE = Placing(mode="free", pre=0.05, gap=0.003, along="point")


def layout(draw: Draw):
    def room(spot: Spot) -> bool:
        return off_centre(0.2)(spot) and clear_of(((0.0, 0.0), 0.25))(spot)

    yaw = draw.uniform("pot", -pi / 8, pi / 8)
    pot = Spot(0.0, 0.0, yaw)
    model = draw.choice("pot model", *range(7))
    yield Articulated(name="pot", category="060_kitchenpot", model=model, pose=pot.pose(POT))
    can = draw.spot("can", x=(-0.3, 0.3), y=(0.05, 0.15), yaw=(-pi / 4, pi / 4), where=room)
    model = draw.choice("can model", 0, 2, 4, 5, 6)
    yield Mesh(name="can", category="105_sauce-can", model=model, pose=can.pose(UP_Y))


def script(robot: Robot) -> None:
    arm, pot = robot.nearest("can"), robot.scene.pose("pot").p
    sign = -1 if arm.side == "left" else 1
    foot = robot.scene.pose("can").p[2]
    beside = Pose((pot[0] + sign * ASIDE, pot[1], foot), DOWN)
    robot.do(arm.grasp("can", pre=APPROACH, aim=Aim(beside, None, BESIDE)))
    robot.do(arm.shift(y=-BACK, z=UP))
    robot.do(arm.place("can", beside, how=BESIDE))
    if robot.first_feasible(RETREATS, lambda way: robot.do(arm.retreat(way))) is None:
        robot.do(arm.shift(z=UP))


def success(props: list[Prop]) -> Condition:
    sign = -1 if props[1].pose.p[0] < 0 else 1

    def beside(scene: Scene) -> bool:
        gap = scene.pose("can").p - scene.pose("pot").p
        return bool(0 < sign * gap[0] < REACH and abs(gap[1]) < LEVEL)

    return (
        condition("the can is beside the pot, on its own side", beside)
        & on_table("can")
        & upright("can", axis=1, within=UPRIGHT)
        & at_rest("can")
        & hands_open()
    )


task = Task(
    layout=layout,
    script=script,
    success=success,
    step_limit=400,
    keep_clear=(((-0.33, 0.33), (-0.25, 0.15)),),  # level hands need room before the can
    mechanism="place beside",
    info={"A": "pot", "B": "can", "a": "arm:can"},
)
