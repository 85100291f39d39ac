"""Lift a lying bottle and shake it while it lies level in the hand.

Success: the lying bottle went up and down three times by 3 cm, in the air, and is then level
within 20 deg and in a hand. Upstream tests that the bottle was lifted; the shaking and the
attitude are what the name demands.
"""

from math import pi

import numpy as np

from rtphys.task import (
    Draw,
    Mesh,
    Pose,
    Robot,
    Scene,
    Task,
    above,
    axis_angle,
    condition,
    quat_multiply,
    shaken,
)

LYING = (0.0, 0.0, 1.0, 0.0)  # top away from the robot
TILT = 0.3927  # [rad] 22.5 deg
STROKE = 0.05  # [m]
COUNTS = 0.03  # [m] least stroke that counts
SPINS = (pi / 2, pi / 3, pi / 4, 0.4, 0.0)  # [rad] from a hand above to a level one


def layout(draw: Draw):
    sides = [(-0.15, -0.1), (0.1, 0.15)]
    spot = draw.spot("bottle", x=sides, y=(-0.15, -0.05), yaw=(-pi / 4, pi / 4))
    model = draw.choice("model", *range(20))
    pose = spot.pose(LYING)
    yield Mesh(name="bottle", category="001_bottle", model=model, pose=pose, rolls_about=1)


def shake(scene: Scene, centre: tuple[float, float, float], yaw: float, spin: float) -> list[Pose]:
    """Poses of the bottle: level, three times up leaning one way and down the other, level.

    Args:
        yaw: turn about the vertical, away from where the top points now.
        spin: turn about the bottle's own axis, which brings the hand from above to behind it.
    """
    now, middle = scene.pose("bottle"), scene.functional("bottle", 0).p
    turned = quat_multiply(axis_angle((0, 0, 1), yaw), now.q)
    axis = Pose((0, 0, 0), turned).R[:, 1]
    level = Pose(centre, quat_multiply(axis_angle(axis, spin), turned))
    across = np.cross((0, 0, 1), axis)
    X_MB = Pose(middle, now.q).inverse() @ now
    path = [level]
    for _ in range(3):
        for height, tilt in ((STROKE, TILT), (0.0, -TILT)):
            lean = quat_multiply(axis_angle(across, tilt), level.q)
            path.append(Pose((*centre[:2], centre[2] + height), lean))
    return [pose @ X_MB for pose in [*path, level]]


def lying(within: float):
    """The bottle's axis within an angle [rad] of level."""
    return condition(
        f"the bottle lies level within {within:.2f} rad",
        lambda s: bool(abs(s.pose("bottle").R[2, 1]) < np.sin(within)),
    )


def in_hand(scene: Scene) -> bool:
    return any(scene.touching(f"{side}_gripper", "bottle") for side in ("left", "right"))


def script(robot: Robot) -> None:
    arm = robot.nearest("bottle")
    robot.do(arm.grasp("bottle", pre=0.075))
    robot.do(arm.lift(0.1))
    sign = -1 if arm.side == "left" else 1
    top = robot.scene.pose("bottle").R[:, 1]
    heading = float(np.arctan2(top[1], top[0]))
    ways = [
        shake(robot.scene, (0.15 * sign, -0.08, z), way - heading, spin)
        for spin in SPINS
        for z in (0.95, 1.0)
        for way in (0.0, 0.4, -0.4, 0.8, -0.8, pi / 2)
    ]
    robot.do(arm.carry("bottle", *ways))


in_air = above("bottle", 0.8)
task = Task(
    layout=layout,
    script=script,
    success=shaken("bottle", by=COUNTS, turns=5, during=in_air & lying(0.7))
    & in_air
    & lying(0.35)
    & condition("the bottle is in a hand", in_hand),
    step_limit=700,
    mechanism="lift, shake",
    info={"A": "bottle", "a": "arm:bottle"},
)
