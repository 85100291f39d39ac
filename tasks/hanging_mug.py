"""The left hand brings the mug to the middle, the right hangs it by its handle on the rack.

Success: the handle's hole is round the peg between its tip and the post, the right hand is open,
and nothing but the rack carries the mug.
"""

import numpy as np

from rtphys.task import (
    DOWN,
    TABLE_TOP,
    UP_Z,
    Arm,
    Draw,
    Infeasible,
    Mesh,
    Placing,
    Pose,
    Robot,
    Scene,
    Task,
    condition,
    free_of,
    opened,
    reachable,
    touching,
)

UPRIGHT_RACK = (-0.22, -0.22, 0.67, 0.67)
AJAR = 0.35  # opening with which a finger fits into the mug
LOOSE = 0.6  # opening that lets go of the mug and does not touch the rack
SLOWLY = 0.5  # share of the usual speed: shaken less, a heavy mug turns less in the hand
MIDDLE = Pose((0.03, -0.15, TABLE_TOP), DOWN)
DOWN_THERE = Placing(mode="free", pre=0.06, gap=0.0, along="point", speed=SLOWLY)
SLID = 0.007  # [m] in the hand that lifts it: such a mug is hardly held, and lost at the next jolt
BACK = 0.06  # [m] that frees the fingers from the hanging mug
BACKS = (0.1, 0.05)  # [m] off the hanging mug, as far as the arm can fold
APPROACH, LIFT = 0.06, 0.08  # [m] straight on to the mug; up with it
AWAY, HANG_LIFT = 0.1, 0.15  # [m] of the left hand up from the mug; of the right up with it
LEANS = (0.0, 0.3, -0.3)  # [rad] of the handle to either side as it is hung
BEFORE = 0.05  # [m] from the handle's hole to the peg's tip, before it goes on
ACROSS, ON_PEG = 0.02, 0.86  # [m] of the hole from the middle of the peg, in x and y; its height
DEEP = 0.054  # [m] from the peg's tip to where the handle is let go: past the bend, or it may stick


def layout(draw: Draw):
    spot = draw.spot("mug", x=(-0.25, -0.1), y=(-0.05, 0.05), yaw=(-1.57, 1.57), where=reachable)
    model = draw.choice("model", *range(10))
    yield Mesh(name="mug", category="039_mug", model=model, pose=spot.pose(UP_Z))
    spot = draw.spot("rack", x=(0.1, 0.3), y=(0.13, 0.17), yaw=(-0.2, 0.2))
    pose = spot.pose(UPRIGHT_RACK)
    yield Mesh(name="rack", category="040_rack", model=0, pose=pose, fixed=True)


def on_peg(scene: Scene) -> bool:
    hole = scene.functional("mug", 0).p
    middle = (scene.pose("rack").p + scene.functional("rack", 0).p) / 2
    return bool(np.all(np.abs(hole - middle)[:2] < ACROSS) and hole[2] > ON_PEG)


def hangings(scene: Scene) -> list[list[Pose]]:
    """Mug poses that lead its hole onto the peg, the mug lying on its side below its handle."""
    peg, X_MH = scene.functional("rack", 0), scene.pose("mug").inverse() @ scene.functional("mug")
    inward = peg.R[:, 2]
    paths: list[list[Pose]] = []
    for lean in LEANS:
        up = np.array([0, 0, 1.0]) - inward[2] * inward
        handle = up / np.linalg.norm(up)
        aside = np.cross(inward, handle)
        handle = np.cos(lean) * handle + np.sin(lean) * aside
        for sign in (1.0, -1.0):
            axis = sign * np.cross(inward, handle)  # of the mug, towards its mouth
            q = Pose.from_matrix(np.column_stack([np.cross(axis, -handle), axis, -handle])).q
            R = Pose((0, 0, 0), q).R
            depths = (-BEFORE, 0.0, DEEP)
            paths.append([Pose(peg.p + d * inward - R @ X_MH.p, q) for d in depths])
    return paths


def leaving_room(robot: Robot, arm: Arm, paths: list[list[Pose]]) -> list[list[Pose]]:
    """Those paths of the mug onto the peg after which the hand can draw straight back."""
    X_ME = robot.scene.pose("mug").inverse() @ arm.ee()

    def can_leave(path: list[Pose]) -> bool:
        back = path[-1].moved(-BACK * (path[-1] @ X_ME).R[:, 0])
        return robot.tried(lambda: arm.carry("mug", [*path, back]))

    return [path for path in paths if can_leave(path)]


def lift(robot: Robot, arm: Arm, height: float) -> float:
    """Lift the mug; how far it slid down in the hand meanwhile [m]."""

    def above() -> float:
        return float(arm.ee().p[2] - robot.scene.pose("mug").p[2])

    before = above()
    robot.do(arm.lift(height, SLOWLY))
    return above() - before


def check(slid: float) -> None:
    """Give up a mug that has slid [m] too far in its hand."""
    if slid > SLID:
        raise Infeasible("slipped", f"the mug slid by {1e3 * slid:.0f} mm as it was lifted")


def script(robot: Robot) -> None:
    left, right, scene = robot.left, robot.right, robot.scene
    slid: list[float] = []

    def take() -> None:
        robot.do(left.close(AJAR), right.close(AJAR))
        robot.do(left.grasp("mug", pre=APPROACH))
        slid.append(lift(robot, left, LIFT))

    robot.retake(take)
    check(slid[-1])
    robot.do(left.place("mug", MIDDLE, how=DOWN_THERE))
    robot.do(left.lift(AWAY))
    robot.do(left.home(), right.grasp("mug", pre=APPROACH))
    check(lift(robot, right, HANG_LIFT))
    paths = hangings(scene)
    robot.do(right.carry("mug", *leaving_room(robot, right, paths), *paths, speed=SLOWLY))
    robot.do(right.open(LOOSE))
    robot.first_feasible(BACKS, lambda back: robot.do(right.retreat(back)))
    robot.do(right.home())
    robot.do(right.open())
    if not on_peg(scene):
        raise Infeasible("slipped", "the mug does not hang on the peg")


task = Task(
    layout=layout,
    script=script,
    success=condition("the handle is round the peg", on_peg)
    & opened("right")
    & touching("mug", "rack")
    & free_of("mug", "left_gripper", "right_gripper", "table"),
    step_limit=900,
    arms="dual, in sequence",
    mechanism="hang",
    info={"A": "mug", "B": "rack"},
)
