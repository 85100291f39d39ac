"""One hand takes an object, the other pulls the drawer out, then the object goes into the drawer.

Success: the drawer is well open and the object rests in it, released. Upstream compares heights and
places only, so an object in front of the drawer's point would do.
"""

from itertools import product

import numpy as np

from rtphys.task import (
    DOWN,
    IDENTITY,
    UP_Z,
    Aim,
    Arm,
    Articulated,
    Draw,
    Infeasible,
    Mesh,
    Motion,
    Placing,
    Pose,
    Robot,
    Scene,
    Task,
    at_rest,
    axis_angle,
    condition,
    free_of,
    joint_beyond,
    quat_multiply,
)

OBJECTS = {  # and how many models of each; the fifth phone lies on its face
    "047_mouse": 3, "048_stapler": 7, "057_toycar": 6, "073_rubikscube": 3, "075_bread": 7,
    "077_phone": 4, "081_playingcards": 3, "112_tea-box": 6, "113_coffee-box": 7, "107_soap": 4,
}  # fmt: skip
DAMPING = 2.0  # [N s/m] of the drawer where physics does not vary it
PULL, MIN_TIME = 8.0, 1.5  # [N] on the handle that damping may cost at most; [s] of the pull
DISTANCES = (0.15, 0.135, 0.12, 0.105)  # [m] to pull the drawer out, of 0.178
FOLLOWED = 0.1  # [m] that the drawer is then open, unless the hand has slipped off the handle
BACK = (0.08, 0.06, 0.045)  # [m] by which the hand that pulled must be able to leave the handle
TURNS = (0.0, 0.3, 0.5)  # [rad] of that hand about the handle
ASIDE = (0.04, 0.08, 0.12)  # [m] towards the middle, for a hand that leaves the handle unturned
TILTS = (0.3, 0.4, 0.5, 0.6)  # [rad] of the hand over the drawer, forward
INTO = Placing(pre=0.11, gap=0.0, along="point")
BEHIND, DROP = 0.015, 0.06  # [m] from the drawer's point: the hand stays over the drawer's front
APPROACH, LIFT = 0.05, 0.15  # [m] before the handle; of the object over the drawer's front
# What is held from the side: [m] of its middle above that drop and behind the drawer's point, and
# of the last line down; [wxyz] of a hand straight down whose camera is towards the robot.
HEIGHTS, BEHINDS, LOWERED = (0.02, 0.05, 0.08), (0.0, -0.02, -0.04), 0.05
CAMERA_NEAR = Pose.from_matrix(np.column_stack([(0, 0, -1), (1, 0, 0), (0, -1, 0)])).q
RETREAT = 0.1  # [m] up from the handle
DROPPED = (0.08, 0.05, 0.03)  # [m] up from the object in the drawer, or back
# [m] from the drawer's point to its side walls; to its front and back; to its floor and edge
WALLS, ENDS, HEIGHT = 0.095, (-0.065, 0.11), (-0.005, 0.11)


def layout(draw: Draw):
    spot = draw.spot("cabinet", x=(-0.05, 0.05), y=(0.155, 0.155), yaw=(np.pi / 2, np.pi / 2))
    yield Articulated(
        name="cabinet", category="036_cabinet", model=46653, pose=spot.pose(IDENTITY), fixed=True
    )
    place = draw.spot(
        "object", x=[(-0.32, -0.2), (0.2, 0.32)], y=(-0.2, -0.1), yaw=(-np.pi / 3, np.pi / 3)
    )
    category = draw.choice("category", *OBJECTS)
    model = draw.choice("model", *range(OBJECTS[category]))
    yield Mesh(name="object", category=category, model=model, pose=place.pose(UP_Z))


def in_drawer(scene: Scene) -> bool:
    """The object is between the drawer's walls and no higher than its front."""
    x, y, z = scene.pose("object").p - scene.functional("cabinet").p
    between = abs(x) < WALLS and ENDS[0] < y < ENDS[1]
    return bool(between and HEIGHT[0] < z < HEIGHT[1])


def inside(scene: Scene, distance: float, tilt: float) -> Pose:
    """Target in the drawer once it is `distance` [m] further out, for a hand tilted forward."""
    floor = scene.functional("cabinet").p + np.array([0, BEHIND - distance, DROP])
    return Pose(floor, quat_multiply(axis_angle((1, 0, 0), tilt), DOWN))


def pulling_paths(arm: Arm) -> list[list[Pose]]:
    """Hand poses now, with the drawer open, and clear of the handle: farthest and straight first.

    On a low table the elbow of a hand that pulls straight is soon folded. Then the hand turns a
    little about the handle, or leaves it towards the middle.
    """
    ee, inward, to_tcp = arm.ee(), 1.0 if arm.side == "left" else -1.0, arm.hand.tcp
    tcp = ee.p + to_tcp * ee.R[:, 0]

    def pulled(turn: float, distance: float, aside: float = 0.0) -> Pose:
        q = quat_multiply(axis_angle((0, 0, 1), inward * turn), ee.q)
        back = to_tcp * Pose((0, 0, 0), q).R[:, 0]
        return Pose(tcp - back + np.array([inward * aside, -distance, 0.0]), q)

    return [
        [ee, pulled(turn, distance), pulled(last_turn, distance + back, aside)]
        for distance in DISTANCES
        for back in BACK
        for turn in TURNS
        for last_turn, aside in ((turn, 0.0), *((0.0, aside) for aside in ASIDE))
    ]


def pull(robot: Robot, arm: Arm) -> None:
    """Pull the drawer out, no faster than its damping allows, and leave the handle."""
    path = robot.first_feasible(pulling_paths(arm), lambda path: arm.sweep(path, prop="cabinet"))
    if path is None:
        raise Infeasible("unreachable", f"no way out for the {arm.side} hand at the handle")
    *opening, clear = path
    damping = robot.scene.physics.scalar("object_joint_damping", DAMPING)
    seconds = max(DISTANCES[0] * damping / PULL, MIN_TIME)
    robot.do(arm.sweep(opening, seconds=seconds, prop="cabinet"))
    if robot.scene.joint("cabinet")[0] < FOLLOWED:
        raise Infeasible("too_slow", "the drawer did not follow the hand")
    robot.do(arm.open())
    robot.do(arm.line(clear))


def put_in(robot: Robot, arm: Arm, tilt: float) -> None:
    robot.do(arm.place("object", inside(robot.scene, 0.0, tilt), how=INTO))


def turned_down(robot: Robot, arm: Arm) -> Motion:
    """Let the object down with a hand from above, so that what was held from the side lies down."""
    held = Pose((0, 0, 0), arm.ee().inverse().q) @ Pose((0, 0, 0), robot.scene.pose("object").q)

    def path(height: float, tilt: float, behind: float) -> list[Pose]:
        hand = quat_multiply(axis_angle((1, 0, 0), tilt), CAMERA_NEAR)
        spot = inside(robot.scene, 0.0, tilt).p + np.array([0, behind, height])
        q = (Pose((0, 0, 0), hand) @ held).q
        return [Pose(spot + np.array([0, 0, up]), q) for up in (LOWERED, 0.0)]

    return arm.carry("object", *(path(*way) for way in product(HEIGHTS, TILTS, BEHINDS)))


def script(robot: Robot) -> None:
    arm = robot.nearest("object")
    puller = robot.other(arm)
    aim = Aim(inside(robot.scene, DISTANCES[0], TILTS[0]), None, INTO)
    robot.do(arm.grasp("object", aim=aim))
    robot.do(puller.grasp("cabinet", pre=APPROACH))
    pull(robot, puller)
    robot.do(puller.lift(RETREAT), arm.lift(LIFT))
    robot.do(puller.home())
    if robot.first_feasible(TILTS, lambda tilt: put_in(robot, arm, tilt)) is None:
        if not robot.tried(lambda: robot.do(turned_down(robot, arm))):
            raise Infeasible("unreachable", "no way over the drawer's front")
        robot.do(arm.open())
    ways = [way(distance) for distance in DROPPED for way in (arm.lift, arm.retreat)]
    if robot.first_feasible(ways, robot.do) is None:
        raise Infeasible("unreachable", "no way out of the drawer")


task = Task(
    layout=layout,
    script=script,
    success=joint_beyond("cabinet", 0.5)
    & condition("the object is in the drawer", in_drawer)
    & free_of("object", "left_gripper", "right_gripper", "table")
    & at_rest("object"),
    step_limit=700,
    arms="dual",
    mechanism="articulated: pull, place inside",
    info={"A": "object", "B": "cabinet", "a": "arm:object", "b": "other:object"},
)
