"""Throw three bottles into the bin beside the table, which only the left hand reaches.

Bottles of the right half are first set down on the left. Success: all three rest in the bin, and
no hand touches them.
"""

from rtphys.task import (
    DOWN,
    TABLE_TOP,
    UP_Z,
    Aim,
    Draw,
    Mesh,
    Motion,
    Placing,
    Pose,
    Robot,
    Scene,
    Spot,
    Task,
    at_rest,
    clear_of,
    condition,
    free_of,
    off_centre,
    place_at_first,
)

from ._dustbin import DUSTBIN, RIM, in_dustbin, wait_for_rest

BOTTLES = ("bottle1", "bottle2", "bottle3")  # and their models 1, 2, 3
YAWS = tuple(0.4 * k for k in range(16))
OVER = Placing(mode="free", pre=0.0, gap=0.0, yaws=YAWS)
STAND = Placing(mode="free", pre=0.05, gap=0.0, along="point", yaws=YAWS, clear=True)
APART = 0.13  # [m] between two bottles, at least: room for open fingers
FOOT = TABLE_TOP + 0.001  # [m] height of the foot of a bottle that is set down
# Where the right hand may set a bottle down for the left one.
HALFWAY = [Pose((x, y, FOOT), DOWN) for x in (-0.05, -0.1, 0.0) for y in (0.07, 0.12, 0.02, -0.06)]
OVER_BIN = ((-0.5, -0.1), (-0.47, -0.1), (-0.5, 0.0), (-0.46, -0.05))  # [m] x and y
GAPS = (0.06, 0.03)  # [m] from the rim, or the table where it is higher, up to a bottle's foot
IN_BIN = (0.2, 0.7)  # [m] heights of a bottle's origin above the ground; the floor is at 21.5 cm
LIFT = 0.1  # [m] of a bottle on its way to the bin
FETCHED, AWAY = 0.16, 0.15  # [m] lift of one that is passed on; of the hand that has set it down
PAUSE, STILL = 0.5, 0.03  # [s], [m/s] bottles may roll about in the bin


def layout(draw: Draw):
    yield DUSTBIN
    taken: list[tuple[Spot, float]] = []
    for model, name in enumerate(BOTTLES, start=1):
        free = clear_of(*taken)
        spot = draw.spot(
            name,
            x=(-0.25, 0.3),
            y=(0.03, 0.23),
            where=lambda s, free=free: off_centre(0.05)(s) and free(s),
        )
        taken.append((spot, APART))
        yield Mesh(name=name, category="114_bottle", model=model, pose=spot.pose(UP_Z))


def all_in_bin(scene: Scene) -> bool:
    return in_dustbin(scene, BOTTLES, IN_BIN, scene.physics.scalar("object_scale", 1.0))


def over_bin(scene: Scene, name: str) -> list[Pose]:
    """Where a bottle's foot may be let go: well above rim and table, lower where it must.

    Upright, or else as it hangs in the hand.
    """
    rim = max(TABLE_TOP, (scene.pose("dustbin") @ Pose((0.0, RIM, 0.0))).p[2])
    return [
        Pose((x, y, rim + gap), q)
        for q in (DOWN, scene.functional(name, 0).q)
        for gap in GAPS
        for x, y in OVER_BIN
    ]


def halfway(scene: Scene, name: str) -> list[Pose]:
    """Free places where the right hand can stand a bottle and the left can take it."""
    standing = [scene.pose(other).p[:2] for other in BOTTLES if other != name]
    return [
        place
        for place in HALFWAY
        if all(((p - place.p[:2]) ** 2).sum() > APART**2 for p in standing)
    ]


def script(robot: Robot) -> None:
    left, right, scene = robot.left, robot.right, robot.scene
    start = {name: scene.pose(name).p for name in BOTTLES}
    # The right half last, and of each half first what stands nearest to the hand's side: a hand
    # that reaches past a bottle knocks it over.
    order = sorted(BOTTLES, key=lambda n: (start[n][0] > 0, start[n][1] - abs(start[n][0])))
    passed = [name for name in order if start[name][0] > 0]

    def fetch() -> tuple[Motion, ...]:
        """The right hand takes the next bottle while the left is busy elsewhere."""
        if not passed:
            return ()
        aim = Aim(HALFWAY[0], 0, STAND)
        return (right.grasp(passed[0], aim=aim), right.lift(FETCHED))

    if passed == order:
        robot.do(*fetch())
    home: tuple[Motion, ...] = ()  # the left hand's way back from the bin
    for name in order:
        away: tuple[Motion, ...] = ()
        if passed and name == passed[0]:
            passed.pop(0)
            robot.do(place_at_first(right, name, halfway(scene, name), STAND, 0), *home)
            robot.do(right.lift(AWAY))  # drawing back, it would sweep over what stands behind
            away, home = (right.home(),), ()
        robot.do(*home)
        robot.do(left.grasp(name, aim=Aim(over_bin(scene, name)[0], 0, OVER)), *away)
        robot.do(left.lift(LIFT))
        robot.do(place_at_first(left, name, over_bin(scene, name), OVER, 0), *fetch())
        home = (left.home(),)
    robot.do(*home)
    wait_for_rest(robot, BOTTLES, PAUSE, STILL)


task = Task(
    layout=layout,
    script=script,
    success=condition("the bottles are in the bin", all_in_bin)
    & at_rest("bottle1")
    & at_rest("bottle2")
    & at_rest("bottle3")
    & free_of("bottle1", "left_gripper", "right_gripper")
    & free_of("bottle2", "left_gripper", "right_gripper")
    & free_of("bottle3", "left_gripper", "right_gripper"),
    step_limit=1700,
    arms="dual, in sequence",
    mechanism="pass on, throw away",
    table_shift=(0.3, 0.0),
    info={"A": "bottle1", "B": "bottle2", "C": "bottle3", "D": "dustbin"},
)
