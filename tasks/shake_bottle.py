"""Lift a bottle, turn it upright in the hand, and shake it up and down.

Success: the upright bottle went up and down three times by 3 cm, in the air and in a hand, and is
still there. Upstream tests that the bottle was lifted; the shaking is what the name demands.
"""

from math import pi

from rtphys.task import (
    DOWN,
    UP_Y,
    Aim,
    Draw,
    Mesh,
    Placing,
    Pose,
    Robot,
    Scene,
    Task,
    above,
    axis_angle,
    condition,
    quat_multiply,
    shaken,
    upright,
    yawed,
)

LYING = (0.0, 0.0, 1.0, 0.0)  # top away from the robot
TILT = 0.3927  # [rad] 22.5 deg
YAWS = tuple(0.4 * k for k in range(16))
UPRIGHT = Placing(mode="free", pre=0.0, gap=0.0, release=False, yaws=YAWS)
STROKE = 0.05  # [m]
COUNTS = 0.03  # [m] least stroke that counts


def layout(draw: Draw):
    sides = [(-0.15, -0.1), (0.1, 0.15)]
    spot = draw.spot("bottle", x=sides, y=(-0.15, -0.05), yaw=(-pi / 4, pi / 4))
    model = draw.choice("model", *range(20))
    pose = spot.pose(LYING)
    yield Mesh(name="bottle", category="001_bottle", model=model, pose=pose, rolls_about=1)


def shake(x: float, z: float, yaw: float) -> list[Pose]:
    """Poses of the bottle: upright, three times up leaning one way and down the other, upright."""
    standing = yawed(UP_Y, yaw)
    path = [Pose((x, -0.08, z), standing)]
    for _ in range(3):
        for height, tilt in ((STROKE, TILT), (0.0, -TILT)):
            lean = quat_multiply(axis_angle((0, 1, 0), tilt), standing)
            path.append(Pose((x, -0.08, z + height), lean))
    return [*path, path[0]]


def in_hand(scene: Scene) -> bool:
    return any(scene.touching(f"{side}_gripper", "bottle") for side in ("left", "right"))


def script(robot: Robot) -> None:
    arm = robot.nearest("bottle")
    x = -0.15 if arm.side == "left" else 0.15
    robot.do(arm.grasp("bottle", pre=0.075, aim=Aim(Pose((x, -0.08, 1.02), DOWN), 0, UPRIGHT)))
    robot.do(arm.lift(0.1))
    ways = [shake(x, z, yaw) for z in (0.88, 0.92) for yaw in YAWS]
    robot.do(arm.carry("bottle", *ways))


in_air = above("bottle", 0.8)
task = Task(
    layout=layout,
    script=script,
    success=shaken("bottle", by=COUNTS, turns=5, during=in_air & upright("bottle", 1, 0.7))
    & in_air
    & upright("bottle", axis=1, within=0.35)
    & condition("the bottle is in a hand", in_hand),
    step_limit=700,
    mechanism="lift, shake",
    info={"A": "bottle", "a": "arm:bottle"},
)
