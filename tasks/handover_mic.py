"""The hand near the microphone lifts it and gives it in the air, tail first, to the other.

Success: the other hand alone holds it, above the middle of the table and on its own side. Upstream
the receiver takes the upper handle beside the giver; these hands are as wide as most handles, so
here it takes the tail's end, along the microphone.
"""

import numpy as np

from rtphys.task import (
    UP_Z,
    Arm,
    Condition,
    Draw,
    Infeasible,
    Mesh,
    Pose,
    Prop,
    Robot,
    Scene,
    Task,
    axis_angle,
    condition,
    free_of,
    held_by,
    opened,
    quat_multiply,
)

# Axes of those that can roll, own frames; the head of model 4 lies crosswise.
AXES = {0: (0.0, -0.113, 0.994), 5: (0.0, -0.134, 0.991)}
UPPER = (0, *range(2, 9))
TIP = 0.1556  # [m] ee to fingertips
HALF_PAD = 0.0305  # [m] of the giver's fingers, along the microphone
UPWARD = 0.2  # [rad] of the offered tail: hands that point up at the middle are out of reach
LOWEST = 0.88  # [m] of a tail that is offered at 0.95 or higher
SWUNG = 0.13  # [rad] when let go: a tail held so weakly stays in the hand by luck alone
OFFERS = 4  # ways of holding it out after the first
GRIP = 0.034  # [m] of the tail that the receiver takes, where the giver leaves as much


def layout(draw: Draw):
    spot = draw.spot("microphone", x=[(-0.2, -0.15), (0.15, 0.2)], y=(-0.05, 0.0))
    model = draw.choice("model", 0, 4, 5)
    yield Mesh(
        name="microphone", category="018_microphone", model=model, pose=spot.pose(UP_Z),
        rolls_about=AXES.get(model),
    )  # fmt: skip


def offers(scene: Scene, taker: Arm) -> list[list[Pose]]:
    """Microphone poses over the table's middle whose tail points at the receiver."""
    here, tail = scene.pose("microphone"), scene.functional("microphone", 0)
    side = -1.0 if taker.side == "left" else 1.0
    found = []
    for aside, height in ((0.10, 0.95), (0.07, 0.97), (0.12, 0.98)):
        for roll in (1.0, 0.6, -1.0, -0.6, 1.4, -1.4):
            for yaw in (0.0, 0.4, -0.4, 0.8):
                towards = np.array([side * np.cos(yaw), -np.sin(yaw), 0.0])
                flat = tail.R[:, 2] * (1, 1, 0)
                angle = float(np.arctan2(np.cross(flat, towards)[2], flat @ towards))
                q = quat_multiply(axis_angle((0, 0, 1), angle), here.q)
                rise = UPWARD - np.arcsin(tail.R[2, 2])
                q = quat_multiply(axis_angle(np.cross(towards, (0, 0, 1)), rise), q)
                q = quat_multiply(axis_angle(towards, roll), q)
                found.append([Pose((-aside * side, -0.12, height), q)])
    return found


def takes(scene: Scene, giver: Arm) -> list[list[Pose]]:
    """Ways along the microphone onto its tail, with the hand turned about it."""
    tail = scene.functional("microphone", 0)
    into = -tail.R[:, 2]
    free = float((scene.tcp(giver.side).p - tail.p) @ into) - HALF_PAD - 0.002
    depth = min(GRIP, free)
    found = []
    for roll in (1.57, -1.57, 1.2, -1.2, 0.8, -0.8, 0.4, -0.4, 0.0):
        up = np.array([0, 0, 1.0]) - into[2] * into
        up = Pose((0, 0, 0), axis_angle(into, roll)).R @ (up / np.linalg.norm(up))
        q = Pose.from_matrix(np.column_stack([into, np.cross(up, into), up])).q
        at = Pose(tail.p + (depth - TIP) * into, q)
        found.append([at.moved(-0.08 * into), at])
    return found


def meet(robot: Robot, giver: Arm, taker: Arm) -> None:
    """Bring the receiver's hand to the tail, held out in other ways if it cannot be reached."""

    def reach() -> None:
        robot.do(taker.sweep(*takes(robot.scene, giver), prop="microphone"))

    if robot.tried(reach):
        return
    tried = 0
    for way in offers(robot.scene, taker)[1::2]:
        if robot.tried(lambda way=way: robot.do(giver.carry("microphone", way))):
            if robot.tried(reach):
                return
            tried += 1
        if tried == OFFERS:
            break
    raise Infeasible("unreachable", "the hands cannot meet on the microphone")


def script(robot: Robot) -> None:
    giver = robot.nearest("microphone")
    taker = robot.other(giver)

    def take() -> None:
        robot.do(giver.grasp("microphone", UPPER, pre=0.1))
        robot.do(giver.lift(0.12))
        robot.do(giver.carry("microphone", *offers(robot.scene, taker)))
        if robot.scene.functional("microphone", 0).p[2] < LOWEST:
            raise Infeasible("slipped", "the microphone hangs down")

    robot.retake(take)
    meet(robot, giver, taker)
    robot.do(taker.close(holds="microphone"))
    before = taker.ee().inverse() @ robot.scene.pose("microphone")
    robot.do(giver.open())
    robot.do(giver.retreat(0.07))
    after = taker.ee().inverse() @ robot.scene.pose("microphone")
    if 2 * np.arccos(min(abs(before.q @ after.q), 1.0)) > SWUNG:
        raise Infeasible("slipped", "the microphone swings down in the receiver's hand")
    aside = 0.08 if taker.side == "right" else -0.08
    robot.do(taker.shift(x=aside), giver.home())
    if not over_there(robot.scene, taker.side):
        raise Infeasible("slipped", "the microphone hangs too low")


def over_there(scene: Scene, side: str) -> bool:
    tail = scene.functional("microphone", 0).p
    return bool(tail[2] > 0.92 and (tail[0] > 0 if side == "right" else tail[0] < 0))


def success(props: list[Prop]) -> Condition:
    giver, taker = ("left", "right") if props[0].pose.p[0] < 0 else ("right", "left")
    return (
        condition(
            f"the microphone is in the air on the {taker} side", lambda s: over_there(s, taker)
        )
        & held_by("microphone", taker)
        & free_of("microphone", f"{giver}_gripper", "table")
        & opened(giver)
    )


task = Task(
    layout=layout,
    script=script,
    success=success,
    step_limit=600,
    arms="dual, in sequence",
    mechanism="handover",
    info={"A": "microphone", "a": "arm:microphone", "b": "other:microphone"},
)
