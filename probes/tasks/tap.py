"""Touch a near and a far plate with the fingertips: how high is the table, and does it lean?

Success: both plates were pressed, and the hand has left them.
"""

from rtphys.task import Draw, Robot, Scene, Task, condition, free_of

from ._right_hand import plate, press_plate

LEAN = 0.002  # [m] of the commanded tips below the touch
UP = 0.05  # [m] off a plate
PLATES = ("near plate", "far plate")


def layout(draw: Draw):
    yield plate(draw, "near plate", y=(-0.2, -0.16))
    yield plate(draw, "far plate", y=(-0.02, 0.02))


def tapped(scene: Scene) -> bool:
    hits = [scene.once(name, scene.touching("right_gripper", name)) for name in PLATES]
    return all(hits)


def script(robot: Robot) -> None:
    robot.do(robot.right.close())
    for name in PLATES:
        arm = press_plate(robot, name, LEAN)
        robot.do(arm.lift(UP))


task = Task(
    layout=layout,
    script=script,
    success=condition("both plates were tapped", tapped, remembers=True)
    & free_of("far plate", "right_gripper"),
    step_limit=300,
    mechanism="probe",
    info={"A": "near plate", "B": "far plate", "a": "right"},
)
