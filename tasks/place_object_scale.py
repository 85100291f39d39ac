"""Put a small object on the kitchen scale.

Success: it rests on the platform within 3.5 cm of its centre and both hands are open.
Added to upstream's test: it touches the scale, does not move, and no hand touches it.
"""

from math import hypot, pi

from rtphys.task import (
    UP_Y,
    Aim,
    Draw,
    Mesh,
    Placing,
    Robot,
    Scene,
    Task,
    at_rest,
    clear_of,
    condition,
    free_of,
    hands_open,
    off_centre,
    touching,
)

from ._everyday import everyday

ONTO = Placing(mode="free", pre=0.06, gap=0.004)
LIFT, RETREAT = 0.12, 0.06  # [m] over the scale; back from the released object
RADIUS, BELOW = 0.035, 0.01  # [m] of its origin from the platform's centre, across and downward


def layout(draw: Draw):
    thing = draw.spot(
        "thing", x=(-0.25, 0.25), y=(-0.2, 0.05), yaw=(-pi, pi), where=off_centre(0.02)
    )
    yield everyday(draw, "thing", thing.pose(UP_Y), ["047_mouse", "048_stapler"])
    side = (0.02, 0.25) if thing.x > 0 else (-0.25, -0.02)
    scale = draw.spot("scale", x=side, y=(-0.2, 0.05), yaw=(-pi, pi), where=clear_of((thing, 0.15)))
    model, pose = draw.choice("scale model", 0, 1, 5, 6), scale.pose(UP_Y)
    yield Mesh(name="scale", category="072_electronicscale", model=model, pose=pose)


def on_platform(scene: Scene) -> bool:
    x, y, z = scene.pose("thing").p - scene.functional("scale").p
    return hypot(x, y) < RADIUS and z > -BELOW


def script(robot: Robot) -> None:
    arm, platform = robot.nearest("thing"), robot.scene.functional("scale")
    robot.do(arm.grasp("thing", aim=Aim(platform, None, ONTO)))
    robot.do(arm.lift(LIFT))
    robot.do(arm.place("thing", platform, how=ONTO))
    robot.do(arm.retreat(RETREAT))


task = Task(
    layout=layout,
    script=script,
    success=condition("the thing is on the platform", on_platform)
    & touching("thing", "scale")
    & free_of("thing", "left_gripper", "right_gripper")
    & at_rest("thing")
    & hands_open(),
    step_limit=400,
    mechanism="place: on top",
    info={"A": "scale", "B": "thing", "a": "arm:thing"},
)
