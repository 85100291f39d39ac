"""Lift a pot level by its two handles.

Success: the pot is up and level, with each hand closed on its own handle. Upstream tests where the
hands are, not whether they hold.
"""

from rtphys.task import (
    IDENTITY,
    Aim,
    Articulated,
    Draw,
    Infeasible,
    Placing,
    Pose,
    Robot,
    Scene,
    Task,
    above,
    condition,
    held_by,
)

YAW = 1.5765  # [rad] turns the pot's front to the robot
HEIGHTS = (0.88, 0.87, 0.86, 0.85)  # [m] of the pot's frame; success asks for 0.82
UP = Placing(mode="align", pre=0.0, gap=0.0, release=False)
AJAR = 0.3  # opening of the hands that fits round a handle
APPROACH = 0.035  # [m] straight on to the handles
# [m] at which the TCP stops short of the handle: a small pot's is too low for the wrist
DEPTHS = (0.0, 0.008, 0.016)
HANDLE = {"left": 0, "right": 1}  # contact points
AT_HANDLE, LEVEL = 0.03, 0.8  # [m] from the TCP to its handle; cosine of the pot's tilt


def layout(draw: Draw):
    spot = draw.spot("pot", x=(-0.05, 0.05), y=(-0.05, 0.05), yaw=(YAW - 0.3927, YAW + 0.3927))
    model = draw.choice("model", 0, 1)
    yield Articulated(name="pot", category="060_kitchenpot", model=model, pose=spot.pose(IDENTITY))


def at_handles(scene: Scene) -> bool:
    for side, handle in HANDLE.items():
        gap = scene.tcp(side).p - scene.contact("pot", handle).p
        if (gap**2).sum() ** 0.5 > AT_HANDLE:
            return False
    return True


def level(scene: Scene) -> bool:
    return bool(scene.pose("pot").R[2, 2] > LEVEL)


def rise(robot: Robot, height: float) -> None:
    gap = height - float(robot.scene.pose("pot").p[2])
    robot.do(robot.left.shift(z=gap), robot.right.shift(z=gap))


def take(robot: Robot, up: Aim, depth: float) -> None:
    robot.do(
        robot.left.grasp("pot", (HANDLE["left"],), pre=APPROACH, depth=depth, aim=up),
        robot.right.grasp("pot", (HANDLE["right"],), pre=APPROACH, depth=depth, aim=up),
    )


def script(robot: Robot) -> None:
    left, right = robot.left, robot.right
    robot.do(left.close(AJAR), right.close(AJAR))
    pot = robot.scene.pose("pot")
    # `align` compares the prop's y with the target's z: the same pot, higher.
    turned = Pose.from_matrix(pot.R[:, [0, 2, 1]] * (1, -1, 1)).q
    up = Aim(Pose((pot.p[0], pot.p[1], HEIGHTS[0]), turned), None, UP)
    if robot.first_feasible(DEPTHS, lambda depth: take(robot, up, depth)) is None:
        raise Infeasible("unreachable", "the hands cannot take the handles")
    # Both hands rise by the same, or not at all: a shorter lift of one would tear the pot.
    if robot.first_feasible(HEIGHTS, lambda height: rise(robot, height)) is None:
        raise Infeasible("unreachable", "the pot cannot be lifted from there")


task = Task(
    layout=layout,
    script=script,
    success=above("pot", 0.82)
    & held_by("pot", "left", "right")
    & condition("each hand is at its handle", at_handles)
    & condition("the pot is level", level),
    step_limit=400,
    arms="dual, in step",
    mechanism="dual lift",
    info={"A": "pot"},
)
