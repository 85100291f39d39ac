"""Swing the lid of a laptop further open.

Success: the hinge is past 40 % of its range, and the hand that pushed is still at the lid.
"""

from math import pi

from rtphys.task import (
    IDENTITY,
    Articulated,
    Draw,
    Infeasible,
    Robot,
    Scene,
    Task,
    claim,
    joint_beyond,
)

LID, CARROT = 0, 1  # contact points: the lid's free edge, and 2-3 cm further open
ENOUGH = 0.5  # share of the range at which the script stops


def layout(draw: Draw):
    yaw = (pi / 2 - pi / 3, pi / 2 + pi / 3)
    spot = draw.spot("laptop", x=(-0.05, 0.05), y=(-0.1, 0.05), yaw=yaw)
    model = draw.choice("model", *range(11))
    yield Articulated(
        name="laptop", category="015_laptop", model=model, pose=spot.pose(IDENTITY), fixed=True,
        opening=0.2,
    )  # fmt: skip


def share(scene: Scene) -> float:
    q, low, high = scene.joint("laptop")
    return (q - low) / (high - low)


def hand_at_lid(scene: Scene) -> bool:
    edge = scene.contact("laptop", CARROT).p
    gaps = [((scene.tcp(side).p - edge) ** 2).sum() ** 0.5 for side in ("left", "right")]
    return min(gaps) < 0.1


def script(robot: Robot) -> None:
    facing = robot.scene.pose("laptop").R[0, 0]
    arm = robot.left if facing > 0 else robot.right
    robot.do(arm.grasp("laptop", (LID,), pre=0.08))
    for _ in range(30):
        before = share(robot.scene)
        robot.do(arm.grasp("laptop", (CARROT,), pre=0.0))
        if share(robot.scene) > ENOUGH:
            return
        if share(robot.scene) - before < 0.001:
            raise Infeasible("stalled", f"the lid stopped at {share(robot.scene):.0%}")


task = Task(
    layout=layout,
    script=script,
    success=joint_beyond("laptop", 0.4) & claim("a hand is at the lid", hand_at_lid),
    step_limit=700,
    mechanism="articulated: open",
    info={"A": "laptop", "a": "arm:laptop"},
)
