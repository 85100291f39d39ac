"""Put a small object on the display stand.

Success: it rests on the stand, within 3 cm of its middle in x and y, and both hands are open.
Added to upstream's test: it touches the stand, at its top, and does not move.
"""

from math import pi

from rtphys.task import (
    UP_Z,
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
    hands_open,
    near,
    touching,
)

from ._everyday import everyday

KINDS = ("047_mouse", "048_stapler", "057_toycar", "073_rubikscube", "079_remotecontrol")
ONTO = Placing(mode="free", pre=0.07, gap=0.004)
LIFT, RETREAT = 0.1, 0.06  # [m] over the stand; back from the released object
BELOW = 0.01  # [m] of its origin under the stand's top, at most


def layout(draw: Draw):
    sides = [(-0.28, -0.2), (0.2, 0.28)]
    thing = draw.spot("thing", x=sides, y=(-0.05, 0.05), yaw=(-pi / 3, pi / 3))
    yield everyday(draw, "thing", thing.pose(UP_Z), KINDS)
    stand = draw.spot(
        "stand",
        x=(0.0, 0.05) if thing.x > 0 else (-0.05, 0.0),
        y=(-0.15, -0.1),
        yaw=(-pi / 6, pi / 6),
        where=clear_of((thing, 0.1)),
    )
    model, pose = draw.choice("stand model", *range(5)), stand.pose(UP_Z)
    yield Mesh(name="stand", category="074_displaystand", model=model, pose=pose)


def at_top(scene: Scene) -> bool:
    return bool(scene.pose("thing").p[2] > scene.functional("stand").p[2] - BELOW)


def script(robot: Robot) -> None:
    arm, top = robot.nearest("thing"), robot.scene.functional("stand")
    robot.do(arm.grasp("thing", aim=Aim(top, None, ONTO)))
    robot.do(arm.lift(LIFT))
    robot.do(arm.place("thing", top, how=ONTO))
    robot.do(arm.retreat(RETREAT))


task = Task(
    layout=layout,
    script=script,
    success=near("thing", "stand", within=(0.03, 0.03, 0.15))
    & condition("the thing is at the stand's top", at_top)
    & touching("thing", "stand")
    & at_rest("thing")
    & hands_open(),
    step_limit=400,
    mechanism="place: on top",
    info={"A": "thing", "B": "stand", "a": "arm:thing"},
)
