"""Lift a bottle, turn it upright in the hand, and shake it up and down.

Success: the upright bottle went up and down three times by 3 cm, in the air and in a hand, and is
still there. Upstream tests that the bottle was lifted; the shaking is what the name demands.
"""

from rtphys.task import (
    DOWN,
    UP_Y,
    Aim,
    Draw,
    Placing,
    Pose,
    Robot,
    Task,
    axis_angle,
    in_either_hand,
    quat_multiply,
    upright,
    yawed,
)

from ._shaken_bottle import (
    APPROACH,
    DEPTH,
    LIFT,
    OUT,
    TILT,
    lying_bottle,
    shaken_in_air,
    up_and_down,
)

YAWS = tuple(0.4 * k for k in range(16))  # [rad] of the upright bottle
HEIGHTS = (0.88, 0.92)  # [m] of its origin, at the bottom of the shaking
# [m] of the hand: nearer, its camera is in the way of a thick bottle, and it takes it upside down.
BACK = 0.008
HIGH = 1.02  # [m] of its middle: a grasp is taken from which it can be upright there
UPRIGHT = Placing(mode="free", pre=0.0, gap=0.0, release=False, yaws=YAWS)


def layout(draw: Draw):
    yield lying_bottle(draw)


def shakes(x: float, z: float, yaw: float) -> list[Pose]:
    """Poses of the bottle: upright, shaken about the robot's y axis, upright."""
    standing = yawed(UP_Y, yaw)
    leaning = [quat_multiply(axis_angle((0, 1, 0), tilt), standing) for tilt in (TILT, -TILT)]
    return up_and_down(Pose((x, DEPTH, z), standing), *leaning)


def script(robot: Robot) -> None:
    arm = robot.nearest("bottle")
    x = -OUT if arm.side == "left" else OUT
    high = Aim(Pose((x, DEPTH, HIGH), DOWN), 0, UPRIGHT)
    robot.do(arm.grasp("bottle", pre=APPROACH, depth=BACK, aim=high))
    robot.do(arm.lift(LIFT))
    robot.do(arm.carry("bottle", *(shakes(x, z, yaw) for z in HEIGHTS for yaw in YAWS)))


task = Task(
    layout=layout,
    script=script,
    success=shaken_in_air(upright("bottle", axis=1, within=0.7))
    & upright("bottle", axis=1, within=0.35)
    & in_either_hand("bottle"),
    step_limit=700,
    mechanism="lift, shake",
    info={"A": "bottle", "a": "arm:bottle"},
)
