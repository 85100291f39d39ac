"""Put two cans into an open plastic box, one with each hand.

Success: both cans stand or lie on the box's floor, one at each place, at rest and released.
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
    in_hand,
)

PLACES = {"left": 1, "right": 0}  # functional point of the box for each hand's can
FROM_ABOVE = tuple(range(8, 16))  # contact points of a can
ASIDE = 0.0425  # [m] of each can from the box's middle: two wide cans fit
FLOOR = 0.004  # [m] of a can's origin above the box's
MISS, RISE = 0.04, 0.02  # [m] of a can from its place, per axis; of its foot above it, at most
INTO = Placing(mode="free", pre=0.06, gap=-0.01, along="point", release=False)
APPROACH, DEPTH = 0.08, 0.02  # [m] of the TCP above the contact point: before the grasp, in it
LIFT, RETREAT = 0.12, 0.08  # [m] over the box's wall; up from the released can
LOOSEN = 0.12  # share of the opening: a wide-open hand would push the walls or the other can


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
        places = [scene.functional("box", point).p for point in sorted(PLACES.values())]
        near = [n for n, place in enumerate(places) if max(abs((can - place)[:2])) < MISS]
        if not near or scene.lowest(f"{side}_can") > places[0][2] + RISE:
            return False
        if in_hand(scene, f"{side}_can"):
            return False
        taken.append(near[0])
    return taken[0] != taken[1]


def place_of(scene: Scene, side: str) -> Pose:
    """On the floor, as far from the middle of the box as two wide cans need."""
    box, point = scene.pose("box"), scene.functional("box", PLACES[side])
    x = ASIDE if (box.inverse() @ point).p[0] > 0 else -ASIDE
    return Pose((box @ Pose((x, FLOOR, 0.0))).p, DOWN)


def put_in(robot: Robot, arm: Arm) -> None:
    can = f"{arm.side}_can"
    robot.do(arm.place(can, place_of(robot.scene, arm.side), how=INTO))
    robot.do(arm.open(min(1.0, robot.scene.opening(arm.side) + LOOSEN)))
    robot.do(arm.lift(RETREAT))
    robot.do(arm.home(), arm.open())


def script(robot: Robot) -> None:
    left, right, scene = robot.left, robot.right, robot.scene
    aims = {side: Aim(place_of(scene, side), None, INTO) for side in PLACES}
    robot.do(
        left.grasp("left_can", FROM_ABOVE, APPROACH, DEPTH, aim=aims["left"]),
        right.grasp("right_can", FROM_ABOVE, APPROACH, DEPTH, aim=aims["right"]),
    )
    robot.do(left.lift(LIFT), right.lift(LIFT))
    left_is_done = robot.tried(lambda: put_in(robot, left))
    put_in(robot, right)  # first, where it was in the left hand's way
    if not left_is_done:
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
