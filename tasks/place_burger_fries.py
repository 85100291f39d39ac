"""Serve a burger and fries: the left hand puts the burger on a tray, the right hand the fries.

Success: both lie on their halves of the tray, at rest, and both hands are open. Upstream does not
test the height.
"""

from rtphys.task import (
    IDENTITY,
    UP_Y,
    UP_Z,
    Aim,
    Draw,
    Mesh,
    Placing,
    Robot,
    Scene,
    Spot,
    Task,
    at_rest,
    condition,
    hands_open,
    touching,
)

MEAL = {"burger": 0, "fries": 1}  # and the functional point of the tray where each goes
ACROSS, UPWARD = 0.08, 0.03  # [m] by which the food may miss its point of the tray
ONTO = Placing(mode="free", pre=0.08, gap=0.005, along="point")
LIFT, RETREAT = 0.1, 0.08  # [m] to carry the food; up from it once it is released


def layout(draw: Draw):
    tray = Spot(0.0, draw.uniform("tray", -0.15, -0.1), -0.0824).pose(UP_Z)
    model = draw.choice("tray model", *range(4))
    yield Mesh(name="tray", category="008_tray", model=model, pose=tray, fixed=True)
    spot = draw.spot("burger", x=(-0.3, -0.25), y=(-0.15, -0.07))
    model = draw.choice("burger model", *range(6))
    yield Mesh(name="burger", category="006_hamburg", model=model, pose=spot.pose(UP_Y))
    # From 0.22 m, upstream's 0.20 leaves no room for a finger beside the tray.
    spot = draw.spot("fries", x=(0.22, 0.3), y=(-0.15, -0.07))
    model = draw.choice("fries model", 0, 1)
    yield Mesh(name="fries", category="005_french-fries", model=model, pose=spot.pose(IDENTITY))


def served(scene: Scene) -> bool:
    for food, point in MEAL.items():
        gap = scene.functional(food).p - scene.functional("tray", point).p
        if (gap[:2] ** 2).sum() ** 0.5 > ACROSS or abs(gap[2]) > UPWARD:
            return False
    return True


def script(robot: Robot) -> None:
    left, right, scene = robot.left, robot.right, robot.scene
    places = {food: scene.functional("tray", point) for food, point in MEAL.items()}
    robot.do(
        left.grasp("burger", aim=Aim(places["burger"], 0, ONTO)),
        right.grasp("fries", aim=Aim(places["fries"], 0, ONTO)),
    )
    robot.do(left.lift(LIFT), right.lift(LIFT))
    robot.do(left.place("burger", places["burger"], point=0, how=ONTO))
    robot.do(left.lift(RETREAT))
    robot.do(left.home(), right.place("fries", places["fries"], point=0, how=ONTO))
    robot.do(right.lift(RETREAT))


task = Task(
    layout=layout,
    script=script,
    success=condition("burger and fries are on their halves of the tray", served)
    & touching("burger", "tray")
    & touching("fries", "tray")
    & at_rest("burger")
    & at_rest("fries")
    & hands_open(),
    step_limit=500,
    arms="dual",
    mechanism="place two",
    info={"A": "burger", "B": "tray", "C": "fries"},
)
