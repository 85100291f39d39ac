"""Push a puck so that it slides and stops on the mark; the hand must let go of it before a line.

Success: the puck rests on the mark, and no hand has touched it since it crossed the line.
"""

from collections.abc import Mapping

import numpy as np

from rtphys.task import (
    BLUE,
    DOWN,
    GREEN,
    LEFT,
    RED,
    RIGHT,
    TABLE_TOP,
    Box,
    Draw,
    Pose,
    Robot,
    Scene,
    Task,
    at_rest,
    condition,
)

from ._hidden import BACK

PUCK = (0.025, 0.02, 0.012)  # [m] half size
MASS = 0.1  # [kg]
START, LINE = -0.24, -0.08  # [m] y of the puck's middle at first; of the line
LOW = 0.006  # [m] of the fingertips above the table
BEHIND = 0.035  # [m] of the hand behind the puck's middle before it pushes
MARK = 0.02  # [m] half width of the mark
OVER, UP, REST = 0.1, 0.06, 1.2  # [m] over the puck; off the table; [s] until it is at rest
LENGTH = 0.17  # [m] of the stroke
# The puck leaves the hand where that brakes harder than friction does. Its way is a function of
# speed² / friction alone, as the stroke is the same at every speed; measured at 0.06, 0.1, 0.2.
STROKE, PER_SPEED = 0.0875, 0.01057  # [m] with no slide; more per speed² / friction
FASTEST = 1.42  # share of the usual speed of lines that arms can go
TRIALS, SLID = (0.9, FASTEST), 0.19  # speeds of strokes that find the friction; [m] that says it


def layout(draw: Draw):
    spot = draw.spot("puck", x=((-0.18, -0.14), (0.14, 0.18)), y=(START, START))
    yield Box(name="puck", half_size=PUCK, colour=BLUE, pose=spot.pose(), mass_kg=MASS)
    y = draw.uniform("mark", START + 0.2, START + 0.25)
    for name, at, half, colour in (
        ("line", LINE, (0.06, 0.002, 0.0005), RED),
        ("mark", y, (MARK, MARK, 0.0005), GREEN),
    ):
        yield Box(
            name=name, half_size=half, colour=colour, fixed=True, visual_only=True,
            pose=Pose((spot.x, at, TABLE_TOP)), phrase=name,
        )  # fmt: skip


def on_mark(scene: Scene) -> bool:
    return bool(np.all(np.abs((scene.pose("puck").p - scene.pose("mark").p)[:2]) < MARK))


def let_go(scene: Scene) -> bool:
    """Whether no hand has touched the puck beyond the line since it crossed that."""
    behind = scene.pose("puck").p[1] < LINE
    hand = not behind and any(scene.touching(f"{side}_gripper", "puck") for side in (LEFT, RIGHT))
    crossed = scene.peak("behind the line", scene.time if behind else 0.0)
    return scene.peak("touched beyond the line", scene.time if hand else 0.0) <= crossed


def script(robot: Robot) -> None:
    scene = robot.scene
    way = float(scene.pose("mark").p[1] - scene.pose("puck").p[1])
    friction = scene.physics.scalar("friction@puck")
    stroke(robot, min(FASTEST, ((way - STROKE) * friction / PER_SPEED) ** 0.5))


def stroke(robot: Robot, speed: float) -> None:
    """Push the puck along with the closed fingertips, stop, and wait until it is at rest."""
    arm, scene = robot.nearest("puck"), robot.scene
    puck = scene.pose("puck").p
    robot.do(arm.close())
    robot.do(arm.hover("puck", gap=OVER, straight_down=True))
    hand, low = arm.ee(), TABLE_TOP + LOW + arm.hand.tip
    behind = puck[1] - BEHIND
    robot.do(arm.reach(Pose((puck[0], behind, low + UP), hand.q)))
    robot.do(arm.shift(z=-UP))
    robot.do(arm.line(Pose((puck[0], behind + LENGTH, low), hand.q), speed=speed))
    robot.do(arm.wait(REST))
    robot.do(arm.lift(UP))


def feel(robot: Robot) -> Mapping[str, float]:
    """Strokes on trial: how far does it slide? Then it is set back."""
    start, friction = robot.scene.functional("puck", 0), 0.0
    for speed in TRIALS:
        stroke(robot, speed)
        way = float(robot.scene.functional("puck", 0).p[1] - start.p[1])
        friction = PER_SPEED * speed**2 / max(way - STROKE, 1e-3)
        arm = robot.nearest("puck")
        robot.do(arm.open())
        robot.do(arm.grasp("puck", pre=UP))
        robot.do(arm.lift(UP))
        robot.do(arm.place("puck", Pose(start.p, DOWN), point=0, how=BACK))
        robot.do(arm.lift(UP))
        if way > SLID:
            break
    return {"friction@puck": friction}


task = Task(
    layout=layout,
    script=script,
    feel=feel,
    success=condition("the puck is on the mark", on_mark)
    & condition("the hand let go before the line", let_go, remembers=True)
    & at_rest("puck"),
    step_limit=600,
    mechanism="hidden friction: slide",
)
