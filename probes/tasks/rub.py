"""Press the fingertips on a plate and draw them across it: how rough is it?

Success: the closed hand pressed the plate, moved across it, and has left it.
"""

from rtphys.task import Draw, Robot, Scene, Task, condition, free_of

from ._right_hand import plate, press_plate

LEAN = 0.008  # [m] of the commanded tips below the touch: about 20 N
WAY = 0.05  # [m] across the plate, half to either side
UP = 0.05  # [m] off the plate
NEAR, FAR = -0.02, 0.02  # [m] of the tips from the plate's middle, both of which they must pass


def layout(draw: Draw):
    yield plate(draw, "plate", y=(-0.14, -0.08))


def rubbed(scene: Scene) -> bool:
    touches = scene.touching("right_gripper", "plate")
    out = float(scene.tcp("right").p[0] - scene.pose("plate").p[0])
    one = scene.once("rubbed on one side", touches and out < NEAR)
    other = scene.once("rubbed on the other side", touches and out > FAR)
    return one and other


def script(robot: Robot) -> None:
    robot.do(robot.right.close())
    arm = press_plate(robot, "plate", LEAN)
    robot.do(arm.shift(x=-0.7 * WAY))
    robot.do(arm.shift(x=1.4 * WAY))
    robot.do(arm.lift(UP))


task = Task(
    layout=layout,
    script=script,
    success=condition("the fingers rubbed the plate", rubbed, remembers=True)
    & free_of("plate", "right_gripper"),
    step_limit=200,
    mechanism="probe",
    info={"A": "plate", "a": "right"},
)
