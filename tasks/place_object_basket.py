"""Put a toy car or a pack of cards into a basket, then lift it with the other hand.

Success: the object lies in the basket, touching neither table nor hand, and a hand carries both.
"""

from rtphys.task import (
    DOWN,
    UP_Y,
    UP_Z,
    Aim,
    Arm,
    Draw,
    Mesh,
    Placing,
    Pose,
    Robot,
    Scene,
    Task,
    claim,
    free_of,
    touching,
    upright,
)

ENDS = (-0.055, 0.055)  # [m] from the arch to the middle of each half: near, far
INTO = Placing(mode="free", pre=0.08, gap=0.0, along="point")
THINGS = {"081_playingcards": 3, "057_toycar": 6}  # and their number of models


def layout(draw: Draw):
    side = draw.choice("side", -1, 1)  # of the object; the other hand takes the basket
    basket = draw.spot("basket", x=(-0.02 * side, -0.02 * side), y=(-0.08, -0.05))
    model = draw.choice("basket model", 0, 1)
    yield Mesh(name="basket", category="110_basket", model=model, pose=basket.pose(UP_Y))
    x = (0.2, 0.25) if side > 0 else (-0.25, -0.2)
    spot = draw.spot("object", x=x, y=(-0.1, 0.1), yaw=(-0.552, 0.496))
    category = draw.choice("object", *THINGS)
    model = draw.choice("object model", *range(THINGS[category]))
    yield Mesh(name="object", category=category, model=model, pose=spot.pose(UP_Z))


def inside(scene: Scene) -> bool:
    """The object's origin between the basket's walls, in the basket's own frame."""
    x, y, z = (scene.pose("basket").inverse() @ scene.pose("object")).p
    return abs(x) < 0.115 and abs(z) < 0.075 and -0.01 < y < 0.085


def carried(scene: Scene) -> bool:
    """Both at least 2 cm higher than at the start, the basket in a hand."""
    rises = [scene.pose(p).p[2] - scene.start(p).p[2] for p in ("basket", "object")]
    held = any(scene.touching(f"{side}_gripper", "basket") for side in ("left", "right"))
    return bool(min(rises) > 0.02) and held


def drop(robot: Robot, arm: Arm, end: float) -> None:
    place = robot.scene.pose("basket") @ Pose((end, 0.03, 0.0))
    robot.do(arm.place("object", Pose(place.p, DOWN), how=INTO))


def script(robot: Robot) -> None:
    arm = robot.nearest("object")
    other = robot.other(arm)
    goal = robot.scene.pose("basket") @ Pose((ENDS[0], 0.03, 0.0))
    aim = Aim(Pose(goal.p, DOWN), None, INTO)
    robot.do(arm.grasp("object", pre=0.08, aim=aim))
    robot.do(arm.lift(0.12))
    if not robot.tried(lambda: drop(robot, arm, ENDS[0])):
        drop(robot, arm, ENDS[1])
    robot.do(arm.lift(0.08))
    robot.do(arm.home())
    robot.do(other.grasp("basket", pre=0.08))
    aside = 0.03 if other.side == "right" else -0.03
    robot.do(other.shift(x=aside, z=0.06))


task = Task(
    layout=layout,
    script=script,
    success=claim("the object is in the basket", inside)
    & claim("a hand carries both", carried)
    & upright("basket", axis=1, within=1.047)
    & touching("object", "basket")
    & free_of("object", "table", "left_gripper", "right_gripper"),
    step_limit=700,
    arms="dual, in sequence",
    mechanism="place, lift container",
    info={"A": "object", "B": "basket", "a": "arm:object", "b": "arm:basket"},
)
