"""Put two cans into an open plastic box, one with each hand.

Success: both cans stand or lie on the box's floor, one at each place, at rest and let go.
Upstream compares positions seen from above only.
"""

from rtphys.task import (
    DOWN,
    UP_Y,
    Aim,
    Arm,
    Draw,
    Mesh,
    Placing,
    Pose,
    Robot,
    Scene,
    Task,
    at_rest,
    condition,
    hands_open,
)

PLACES = {"left": 1, "right": 0}  # functional points of the box: near and far
FROM_ABOVE = tuple(range(8, 16))  # contact points of a can
APART = 0.0425  # [m] of each place from the box's middle: two wide cans fit
INTO = Placing(mode="free", pre=0.06, gap=-0.01, along="point", release=False)


def layout(draw: Draw):
    box = draw.spot("box", x=(0.0, 0.0), y=(-0.15, -0.1))
    model = draw.choice("box model", 3, 5)
    yield Mesh(name="box", category="062_plasticbox", model=model, pose=box.pose(UP_Y))
    for side, x in (("left", (-0.25, -0.15)), ("right", (0.15, 0.25))):
        spot = draw.spot(side, x=x, y=(-0.15, -0.07))
        model = draw.choice(f"{side} model", 0, 1, 2, 3, 5, 6)
        yield Mesh(name=f"{side}_can", category="071_can", model=model, pose=spot.pose(UP_Y))


def inside(scene: Scene) -> bool:
    """Each can within 4 cm of a place of its own, lower than the box's rim, and in no hand."""
    taken = []
    for side in PLACES:
        can = scene.pose(f"{side}_can").p
        gaps = [can - scene.functional("box", point).p for point in (0, 1)]
        near = [n for n, gap in enumerate(gaps) if max(abs(gap[:2])) < 0.04]
        if not near or scene.lowest(f"{side}_can") > scene.functional("box", 0).p[2] + 0.02:
            return False
        if any(scene.touching(f"{hand}_gripper", f"{side}_can") for hand in PLACES):
            return False
        taken.append(near[0])
    return taken[0] != taken[1]


def place_of(scene: Scene, side: str) -> Pose:
    """On the floor, as far from the middle of the box as two wide cans need."""
    box, point = scene.pose("box"), scene.functional("box", PLACES[side])
    out = APART if (box.inverse() @ point).p[0] > 0 else -APART
    return Pose((box @ Pose((out, 0.004, 0.0))).p, DOWN)


def put_in(robot: Robot, arm: Arm) -> None:
    can = f"{arm.side}_can"
    robot.do(arm.place(can, place_of(robot.scene, arm.side), how=INTO))
    # Half open: a wide-open hand would push the walls or the other can.
    robot.do(arm.open(min(1.0, robot.scene.opening(arm.side) + 0.12)))
    robot.do(arm.lift(0.08))
    robot.do(arm.home(), arm.open())


def script(robot: Robot) -> None:
    left, right, scene = robot.left, robot.right, robot.scene
    aims = {side: Aim(place_of(scene, side), None, INTO) for side in PLACES}
    robot.do(
        left.grasp("left_can", FROM_ABOVE, pre=0.08, depth=0.02, aim=aims["left"]),
        right.grasp("right_can", FROM_ABOVE, pre=0.08, depth=0.02, aim=aims["right"]),
    )
    robot.do(left.lift(0.12), right.lift(0.12))
    # Where the other hand is in the way, it goes first.
    first = robot.tried(lambda: put_in(robot, left))
    put_in(robot, right)
    if not first:
        put_in(robot, left)


task = Task(
    layout=layout,
    script=script,
    success=condition("each can is at a place of its own on the box's floor", inside)
    & at_rest("left_can")
    & at_rest("right_can")
    & hands_open(),
    step_limit=800,
    arms="dual, in sequence",
    mechanism="place two",
    info={"A": "left_can", "B": "box", "C": "right_can"},
)
