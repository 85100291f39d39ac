"""Throw three bottles into the bin beside the table, which only the left hand reaches.

Bottles of the right half are first set down on the left. Success: all three rest in the bin, and
no hand touches them.
"""

from rtphys.task import (
    DOWN,
    UP_Y,
    UP_Z,
    Aim,
    Draw,
    Mesh,
    Motion,
    Placing,
    Pose,
    Robot,
    Scene,
    Task,
    at_rest,
    clear_of,
    condition,
    free_of,
    off_centre,
    place_at_first,
)

BOTTLES = ("bottle1", "bottle2", "bottle3")  # and their models 1, 2, 3
BIN = Pose((-0.45, 0.0, 0.0), UP_Y)  # on the ground, whatever the table does
YAWS = tuple(0.4 * k for k in range(16))
OVER = Placing(mode="free", pre=0.0, gap=0.0, yaws=YAWS)
STAND = Placing(mode="free", pre=0.05, gap=0.0, along="point", yaws=YAWS, clear=True)
HALFWAY_AIM = Pose((-0.05, 0.07, 0.741), DOWN)
HALFWAY = [(x, y) for x in (-0.05, -0.1, 0.0) for y in (0.07, 0.12, 0.02, -0.06)]


def layout(draw: Draw):
    yield Mesh(
        name="dustbin", category="011_dustbin", model=0, pose=BIN, fixed=True, on_table=False
    )
    taken = []
    for model, name in enumerate(BOTTLES, start=1):
        free = clear_of(*taken)
        spot = draw.spot(
            name,
            x=(-0.25, 0.3),
            y=(0.03, 0.23),
            where=lambda s, free=free: off_centre(0.05)(s) and free(s),
        )
        taken.append((spot, 0.13))
        yield Mesh(name=name, category="114_bottle", model=model, pose=spot.pose(UP_Z))


def all_in_bin(scene: Scene) -> bool:
    """Every bottle's origin 20 to 70 cm above the ground between the bin's walls.

    The bounds shrink with the bin: its floor is at 21.5 cm.
    """
    X_BT = scene.pose("dustbin").inverse()
    scale = scene.physics.scalar("object_scale", 1.0)
    for name in BOTTLES:
        along, height, across = (X_BT @ scene.pose(name)).p / scale
        if not (abs(along) < 0.325 and abs(across) < 0.221 and 0.2 < height < 0.7):
            return False
    return True


def over_bin(scene: Scene, name: str) -> list[Pose]:
    """Where a bottle's foot may be let go: well above rim and table, lower where it must.

    Upright, or else as it hangs in the hand.
    """
    rim = max(0.74, (scene.pose("dustbin") @ Pose((0.0, 0.74, 0.0))).p[2])
    return [
        Pose((x, y, rim + gap), q)
        for q in (DOWN, scene.functional(name, 0).q)
        for gap in (0.06, 0.03)
        for x, y in ((-0.4, -0.1), (-0.36, -0.1), (-0.4, 0.0), (-0.36, -0.05))
    ]


def halfway(scene: Scene, name: str) -> list[Pose]:
    """Free places where the right hand can stand a bottle and the left can take it."""
    standing = [scene.pose(other).p[:2] for other in BOTTLES if other != name]
    return [
        Pose((x, y, 0.741), DOWN)
        for x, y in HALFWAY
        if all(((p - (x, y)) ** 2).sum() > 0.13**2 for p in standing)
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
        aim = Aim(HALFWAY_AIM, 0, STAND)
        return (right.grasp(passed[0], pre=0.1, aim=aim), right.lift(0.16))

    if passed == order:
        robot.do(*fetch())
    home: tuple[Motion, ...] = ()  # the left hand's way back from the bin
    for name in order:
        away: tuple[Motion, ...] = ()
        if passed and name == passed[0]:
            passed.pop(0)
            robot.do(place_at_first(right, name, halfway(scene, name), STAND, 0), *home)
            robot.do(right.lift(0.15))  # drawing back, it would sweep over what stands behind
            away, home = (right.home(),), ()
        robot.do(*home)
        robot.do(left.grasp(name, pre=0.1, aim=Aim(over_bin(scene, name)[0], 0, OVER)), *away)
        robot.do(left.lift(0.1))
        robot.do(place_at_first(left, name, over_bin(scene, name), OVER, 0), *fetch())
        home = (left.home(),)
    robot.do(*home)
    for _ in range(6):  # bottles may roll about in the bin
        robot.do(left.wait(0.5))
        if all(scene.speed(name) < 0.03 for name in BOTTLES):
            return


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
