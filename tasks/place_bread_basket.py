"""Put two breads into the bread basket.

Success: both breads lie inside the basket, not on the table, at rest, and both hands are open.
Upstream's height test always holds, and it drops the second bread where the first is close.
"""

from math import pi

from rtphys.task import (
    DOWN,
    UP_Y,
    UP_Z,
    Arm,
    Condition,
    Draw,
    Mesh,
    Motion,
    Placing,
    Pose,
    Robot,
    Spot,
    Task,
    at_rest,
    clear_of,
    free_of,
    hands_open,
    near,
    off_centre,
)

BASKET = Spot(0.0, -0.2)
BREADS = ("bread0", "bread1")
LENGTHWISE, ASIDE = 0, 0.03  # the basket's longer axis; [m] along it from its middle
WITHIN = (0.05, 0.05, 0.08)  # [m] of the basket's frame: between its walls
APPROACH, LIFT = 0.07, 0.1  # [m] straight down to a bread; clear of the basket and the other
INTO = Placing(mode="free", pre=0.12, gap=0.03, along="point")


def layout(draw: Draw):
    yaw = draw.uniform("basket yaw", -pi, pi)
    model = draw.choice("basket model", *range(5))
    pose = Spot(BASKET.x, BASKET.y, yaw).pose(UP_Y)
    yield Mesh(name="basket", category="076_breadbasket", model=model, pose=pose)
    taken = [(BASKET, 0.15)]
    for number, name in enumerate(BREADS):
        free = clear_of(*taken)

        def room(spot: Spot, free=free) -> bool:
            return off_centre(0.15)(spot) and free(spot)

        spot = draw.spot(name, x=(-0.27, 0.27), y=(-0.2, 0.05), yaw=(-pi / 4, pi / 4), where=room)
        taken.append((spot, 0.12))
        model = draw.choice(f"model{number}", 0, 1, 3, 5, 6)
        yield Mesh(name=name, category="075_bread", model=model, pose=spot.pose(UP_Z))


def place(arm: Arm, robot: Robot, name: str, end: str) -> Motion:
    """Onto the left or right end of the floor, so that both breads find room."""
    floor = robot.scene.functional("basket", 0).p
    axis = robot.scene.pose("basket").R[:, LENGTHWISE]
    towards = axis if (axis[0] > 0) == (end == "right") else -axis
    return arm.place(name, Pose(floor + ASIDE * towards, DOWN), how=INTO)


def together(robot: Robot) -> None:
    """A bread in each hand: lift both, put them in one after the other."""
    left, right = robot.left, robot.right
    ours = {robot.nearest(name).side: name for name in BREADS}
    robot.do(left.grasp(ours["left"], pre=APPROACH), right.grasp(ours["right"], pre=APPROACH))
    robot.do(left.lift(LIFT), right.lift(LIFT))
    robot.do(place(left, robot, ours["left"], "left"))
    robot.do(left.lift(LIFT))
    robot.do(left.home(), place(right, robot, ours["right"], "right"))
    robot.do(right.lift(LIFT))


def script(robot: Robot) -> None:
    if robot.nearest("bread0") is not robot.nearest("bread1"):
        together(robot)
        return
    nearest_first = sorted(BREADS, key=lambda name: robot.scene.pose(name).p[1])
    for end, name in zip(("left", "right"), nearest_first, strict=True):
        arm = robot.nearest(name)
        robot.do(arm.grasp(name, pre=APPROACH))
        robot.do(arm.lift(LIFT))
        robot.do(place(arm, robot, name, end))
        robot.do(arm.lift(LIFT))


def inside(bread: str) -> Condition:
    close = near(bread, "basket", within=WITHIN)
    return close & free_of(bread, "table") & at_rest(bread)


task = Task(
    layout=layout,
    script=script,
    success=inside("bread0") & inside("bread1") & hands_open(),
    step_limit=700,
    arms="dual, in sequence",
    mechanism="place into",
    info={"A": "basket", "B": "bread0", "C": "bread1"},
)
