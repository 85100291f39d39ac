"""Lay a bar on a narrow support so that it rests there: its load is hidden, and not in its middle.

Success: the bar rests on the support alone, level, and both hands are open.
"""

from math import pi

from rtphys.task import (
    BLUE,
    DOWN,
    GREEN,
    TABLE_TOP,
    Box,
    Draw,
    Infeasible,
    Placing,
    Pose,
    Robot,
    Scene,
    Task,
    at_rest,
    condition,
    hands_open,
    lifted,
    yawed,
)

from ._hidden import APPROACH, OFF, hold_up

HALF = (0.15, 0.0125, 0.0125)  # [m] of the bar
MASS = 0.15  # [kg]
SUPPORT, AT = (0.02, 0.04, 0.015), (0.0, -0.05)  # [m] half size of the support; where it stands
LIFT = 0.08  # [m] over the support
ONTO = Placing(mode="align", pre=0.03, gap=0.002, along="point")
TURNS = tuple(side + lean for lean in (0.0, 0.3, -0.3, 0.6, -0.6) for side in (0.0, pi))  # [rad]
LEVEL = 0.99  # cosine of the bar's tilt


def layout(draw: Draw):
    yield Box(
        name="support", half_size=SUPPORT, colour=GREEN, fixed=True,
        pose=Pose((*AT, TABLE_TOP)), phrase="green block",
    )  # fmt: skip
    spot = draw.spot("bar", x=((-0.2, -0.1), (0.1, 0.2)), y=(-0.2, -0.15), yaw=(-0.4, 0.4))
    yield Box(name="bar", half_size=HALF, colour=BLUE, mass_kg=MASS, pose=spot.pose())


def balanced(scene: Scene) -> bool:
    level = abs(scene.pose("bar").R[2, 0]) < (1 - LEVEL**2) ** 0.5
    return level and scene.touching("bar", "support") and not scene.touching("bar", "table")


def centre(scene: Scene) -> float:
    """[m] along the bar, from its middle."""
    return scene.physics.vector("center_of_mass@bar")[0]


def script(robot: Robot) -> None:
    arm = robot.nearest("bar")
    robot.do(arm.grasp("bar", (1, 3), pre=APPROACH))
    robot.do(arm.lift(LIFT))
    lay_down(robot)


def lay_down(robot: Robot) -> None:
    """The held bar with its centre of mass over the middle of the support, either way round."""
    arm, scene = robot.nearest("bar"), robot.scene
    top = scene.functional("support", 1).p

    def lay(turn: float) -> None:
        along = Pose((0, 0, 0), yawed((1.0, 0.0, 0.0, 0.0), turn)).R[:, 0]
        goal = Pose(top - centre(scene) * along, yawed(DOWN, turn))
        robot.do(arm.place("bar", goal, point=0, how=ONTO))

    if robot.first_feasible(TURNS, lay) is None:
        raise Infeasible("unreachable", "the hand cannot lay the bar on the support")
    robot.do(arm.lift(OFF))


def feel(robot: Robot) -> dict[str, tuple[float, ...]]:
    arm, felt = hold_up(robot, "bar", (1, 3))
    bar, force, moment = robot.scene.pose("bar"), felt[:3], felt[3:]
    # moment = r x force, of which the weight's line is found, not the point on it
    r = (-moment[1] / force[2], moment[0] / force[2], 0.0)
    x = float((robot.scene.tcp(arm.side).p + r - bar.p) @ bar.R[:, 0])
    robot.do(arm.open())
    robot.do(arm.lift(OFF))
    return {"center_of_mass@bar": (x, 0.0, 0.0)}


task = Task(
    layout=layout,
    script=script,
    feel=feel,
    success=condition("the bar lies level on the support alone", balanced)
    & lifted("bar", 0.02)
    & at_rest("bar")
    & hands_open(),
    step_limit=800,
    mechanism="hidden centre of mass: balance",
)
