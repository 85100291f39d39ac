"""Press a seal onto the coloured square on its side of the table.

Success: the seal stands within 1 cm of the square's middle, both hands are open, and a hand has
pressed it down there. Upstream tests place and hands only, so a seal pushed aside would pass.
"""

from rtphys.task import (
    COLOURS,
    DOWN,
    TABLE_TOP,
    UP_Y,
    Aim,
    Box,
    Draw,
    Mesh,
    Placing,
    Pose,
    Robot,
    Scene,
    Task,
    at_rest,
    clear_of,
    condition,
    hands_open,
    in_hand,
    near,
    off_centre,
    on_table,
    upright,
)

MISS = 0.01  # [m] of the seal from the square's middle, per axis
FLAT = 0.97  # cosine of the seal's tilt, at least, while it is pressed
SIDES = (4, 5, 6, 7)  # contact points of the seal
LIFT, RETREAT = 0.05, 0.06  # [m] to carry the seal; back from it once it is released
ONTO = Placing(pre=0.06, gap=-0.002, along="point", until="table")


def layout(draw: Draw):
    spot = draw.spot("seal", x=(-0.25, 0.25), y=(-0.05, 0.05), where=off_centre(0.05))
    model = draw.choice("model", 0, 2, 3, 4, 6)
    yield Mesh(name="seal", category="100_seal", model=model, pose=spot.pose(UP_Y))
    side = (0.05, 0.25) if spot.x > 0 else (-0.25, -0.05)
    mark = draw.spot("mark", x=side, y=(-0.05, 0.1), where=clear_of((spot, 0.1)))
    colour = draw.choice("colour", *COLOURS)
    yield Box(
        name="mark", half_size=(0.035, 0.035, 0.0005), colour=COLOURS[colour], fixed=True,
        pose=mark.pose(), visual_only=True, phrase=f"{colour} square", label=colour,
    )  # fmt: skip


def on_mark(scene: Scene) -> bool:
    gap = scene.pose("seal").p - scene.pose("mark").p
    return bool(max(abs(gap[0]), abs(gap[1])) < MISS)


def stamped(scene: Scene) -> bool:
    """A hand that held the seal pressed it flat on the square."""
    flat = scene.pose("seal").R[2, 1] > FLAT
    pressed = in_hand(scene, "seal") and flat and scene.touching("seal", "table")
    return scene.once("stamped", bool(pressed and on_mark(scene)))


def script(robot: Robot) -> None:
    arm = robot.nearest("seal")
    target = Pose((*robot.scene.pose("mark").p[:2], TABLE_TOP), DOWN)

    def take() -> None:
        robot.do(arm.grasp("seal", SIDES, aim=Aim(target, None, ONTO)))
        robot.do(arm.lift(LIFT))

    robot.retake(take)
    robot.do(arm.place("seal", target, how=ONTO))
    robot.do(arm.retreat(RETREAT))


task = Task(
    layout=layout,
    script=script,
    success=near("seal", "mark", within=(MISS, MISS, 0.02))
    & hands_open()
    & on_table("seal")
    & upright("seal", axis=1, within=0.15)
    & at_rest("seal")
    & condition("the seal was pressed on the square", stamped, remembers=True),
    step_limit=400,
    mechanism="tool: stamp",
    info={"A": "seal", "B": "mark", "a": "arm:seal"},
)
