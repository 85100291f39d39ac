"""Lift a lying bottle and hold it upright, out to the side on which it lay.

Success: the bottle's middle is more than 15 cm out and 16 cm above the table, the bottle stands
upright within 20 deg, and a hand holds it. Upstream tests neither the bottle's attitude nor the
grip; both are what the name demands.
"""

from math import pi

from rtphys.task import (
    DOWN,
    TABLE_TOP,
    Aim,
    Condition,
    Draw,
    Mesh,
    Placing,
    Pose,
    Prop,
    Robot,
    Scene,
    Task,
    condition,
    held_by,
    upright,
    yawed,
)

LYING = (0.7071067811865476, 0.0, 0.0, -0.7071067811865476)  # top towards +x
ASIDE, HIGH = 0.15, 0.16  # [m] to the side and above the table: more than that is success
UPRIGHT = 0.35  # [rad] that the bottle may lean
OUT, Y, Z = 0.24, -0.08, 1.01  # [m] where its middle is brought
APPROACH, LIFT = 0.075, 0.1  # [m] straight on to the bottle; up before it turns
# The level hand points forward and inward; a turn about DOWN is clockwise from above.
INWARD = tuple(0.785 + d for d in (0.0, 0.3, -0.3, 0.6, -0.6))


def layout(draw: Draw):
    side = draw.choice("side", -1, 1)
    x = (-0.12, -0.08) if side < 0 else (0.08, 0.12)
    spot = draw.spot("bottle", x=x, y=(-0.13, -0.08), yaw=(-0.4, 0.4))
    model = draw.choice("model", 13, 16)
    pose = spot.pose(LYING if side < 0 else yawed(LYING, pi))
    yield Mesh(name="bottle", category="001_bottle", model=model, pose=pose, rolls_about=1)


def script(robot: Robot) -> None:
    arm = robot.nearest("bottle")
    sign = -1 if arm.side == "left" else 1
    aside = Pose((OUT * sign, Y, Z), DOWN)
    yaws = tuple(sign * yaw for yaw in INWARD)
    how = Placing(mode="free", pre=0.0, gap=0.0, release=False, yaws=yaws)
    robot.do(arm.grasp("bottle", pre=APPROACH, aim=Aim(aside, 0, how)))
    robot.do(arm.lift(LIFT))
    robot.do(arm.place("bottle", aside, point=0, how=how))


def success(props: list[Prop]) -> Condition:
    side = "left" if props[0].pose.p[0] < 0 else "right"
    sign = -1 if side == "left" else 1

    def aside(scene: Scene) -> bool:
        middle = scene.functional("bottle", 0).p
        return bool(sign * middle[0] > ASIDE and middle[2] > TABLE_TOP + HIGH)

    return (
        condition(f"the bottle is out to the {side} and high", aside)
        & held_by("bottle", side)
        & upright("bottle", axis=1, within=UPRIGHT)
    )


task = Task(
    layout=layout,
    script=script,
    success=success,
    step_limit=400,
    keep_clear=(((-0.36, 0.36), (-0.28, 0.1)),),  # the arms swing out
    mechanism="lift, turn upright",
    info={"A": "bottle", "a": "arm:bottle"},
)
