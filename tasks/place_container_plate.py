"""Set a bowl or a cup on the plate.

Success: the container stands upright on the plate's middle, at rest, and both hands are open.
"""

from rtphys.task import (
    UP_Y,
    Aim,
    Draw,
    Mesh,
    Placing,
    Robot,
    Task,
    at_rest,
    clear_of,
    hands_open,
    near,
    upright,
)

from ._by_the_rim import OUTER, release_rim

LIFT, RETREAT = 0.07, 0.08  # [m] to carry the container; up from it once it is released
ONTO = Placing(mode="free", pre=0.05, gap=0.008, along="point", release=False)


def layout(draw: Draw):
    sign = draw.choice("side", -1, 1)
    x = (0.02, 0.08) if sign > 0 else (-0.08, -0.02)
    plate = draw.spot("plate", x=x, y=(-0.15, -0.1))
    x = (0.2, 0.28) if sign > 0 else (-0.28, -0.2)
    # So far apart that wide rims do not overlap (not in upstream).
    container = draw.spot("container", x=x, y=(-0.1, 0.05), where=clear_of((plate, 0.2)))
    category = draw.choice("category", "002_bowl", "021_cup")
    models = (1, 2, 3, 5) if category == "002_bowl" else range(1, 8)
    model = draw.choice("model", *models)
    yield Mesh(name="container", category=category, model=model, pose=container.pose(UP_Y))
    yield Mesh(name="plate", category="003_plate", model=0, pose=plate.pose(UP_Y), fixed=True)


def script(robot: Robot) -> None:
    arm, spot = robot.nearest("container"), robot.scene.functional("plate", 0)
    robot.do(arm.grasp("container", OUTER[arm.side], aim=Aim(spot, 0, ONTO)))
    robot.do(arm.lift(LIFT))
    robot.do(arm.place("container", spot, point=0, how=ONTO))
    release_rim(robot, arm, RETREAT)


task = Task(
    layout=layout,
    script=script,
    success=near("container", "plate", within=(0.05, 0.05, 0.03))
    & upright("container", axis=1, within=0.2)
    & at_rest("container")
    & hands_open(),
    step_limit=400,
    mechanism="place",
    info={"A": "plate", "B": "container", "a": "arm:container"},
)
