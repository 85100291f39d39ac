"""Take hold of a pack of cards and slide it outward, off to its own side.

Success: the pack lies more than 23 cm to the side on which it began, on the table and at rest, and
both hands are open. Upstream accepts either side and any height, and
also spawns where a hand cannot turn to every yaw (y > 0).
"""

from math import pi

from rtphys.task import (
    UP_Y,
    Draw,
    Mesh,
    Robot,
    Scene,
    Task,
    at_rest,
    condition,
    hands_open,
    on_table,
    reachable,
)

AWAY = 0.23  # [m] |x| that is far enough
GOAL = 0.3  # [m] |x| to which the pack is slid
APPROACH, RETREAT = 0.05, 0.06  # [m] straight down to the pack; off it
DEPTH = 0.01  # [m] at which the TCP stops short of the contact point: the pack is thin


def layout(draw: Draw):
    sides = [(-0.1, -0.05), (0.05, 0.1)]
    spot = draw.spot("cards", x=sides, y=(-0.2, 0.05), yaw=(-pi, pi), where=reachable)
    model = draw.choice("model", 0, 1, 2)
    yield Mesh(name="cards", category="081_playingcards", model=model, pose=spot.pose(UP_Y))


def outward(scene: Scene) -> bool:
    sign = 1 if scene.start("cards").p[0] > 0 else -1
    return bool(sign * scene.pose("cards").p[0] > AWAY)


def script(robot: Robot) -> None:
    arm = robot.nearest("cards")
    robot.do(arm.grasp("cards", pre=APPROACH, depth=DEPTH))
    x = robot.scene.pose("cards").p[0]
    robot.do(arm.shift(x=GOAL - x if x > 0 else -GOAL - x))
    robot.do(arm.open())
    robot.do(arm.retreat(RETREAT))


task = Task(
    layout=layout,
    script=script,
    success=condition("the cards are far out on their side", outward)
    & on_table("cards")
    & at_rest("cards")
    & hands_open(),
    step_limit=400,
    keep_clear=(((-0.45, 0.45), (-0.28, 0.12)),),  # the whole strip, as upstream
    mechanism="slide",
    info={"A": "cards", "a": "arm:cards"},
)
