"""Lift two bottles at once, one in each hand, and bring them together in front.

Success: both stand side by side in the air, each in its own hand, near its place and off the
table. Upstream asks for position and height only.
"""

from rtphys.task import (
    DOWN,
    UP_Z,
    Aim,
    Draw,
    Mesh,
    Placing,
    Pose,
    Robot,
    Scene,
    Task,
    claim,
    free_of,
    held_by,
    upright,
)

PLACES = {"left": (-0.06, -0.105, 1.0), "right": (0.06, -0.105, 1.0)}
MODELS = {"left": 13, "right": 16}
YAW = {"left": -0.724, "right": 0.789}  # [rad] about which the spawns turn
OFFER = Placing(pre=0.0, gap=0.0, release=False)


def layout(draw: Draw):
    for side, x in (("left", (-0.25, -0.05)), ("right", (0.05, 0.25))):
        yaw = (YAW[side] - 1.0, YAW[side] + 1.0)
        spot = draw.spot(side, x=x, y=(0.03, 0.23), yaw=yaw)
        pose = spot.pose(UP_Z)
        yield Mesh(name=f"{side}_bottle", category="001_bottle", model=MODELS[side], pose=pose)


def together(scene: Scene) -> bool:
    """Each bottle's middle within 10 cm of its place in x and y, and above 0.89 m."""
    for side, place in PLACES.items():
        x, y, z = scene.functional(f"{side}_bottle", 0).p
        if abs(x - place[0]) > 0.1 or abs(y - place[1]) > 0.1 or z < 0.89:
            return False
    return True


def script(robot: Robot) -> None:
    left, right = robot.left, robot.right
    goals = {side: Pose(place, DOWN) for side, place in PLACES.items()}
    robot.do(
        left.grasp("left_bottle", pre=0.08, aim=Aim(goals["left"], 0, OFFER)),
        right.grasp("right_bottle", pre=0.08, aim=Aim(goals["right"], 0, OFFER)),
    )
    robot.do(left.lift(0.1), right.lift(0.1))
    robot.do(
        left.place("left_bottle", goals["left"], point=0, how=OFFER),
        right.place("right_bottle", goals["right"], point=0, how=OFFER),
    )


task = Task(
    layout=layout,
    script=script,
    success=claim("the bottles are together in front", together)
    & held_by("left_bottle", "left")
    & held_by("right_bottle", "right")
    & free_of("left_bottle", "table")
    & free_of("right_bottle", "table")
    & upright("left_bottle", axis=1, within=0.7)
    & upright("right_bottle", axis=1, within=0.7),
    step_limit=400,
    arms="dual, in step",
    mechanism="pick two",
    info={"A": "left_bottle", "B": "right_bottle"},
)
