"""One hand takes an object, the other pulls the drawer out, then the object goes into the drawer.

Success: the drawer is well open and the object rests in it, let go. Upstream compares heights and
places only, so an object in front of the drawer's point would do.
"""

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

DRAWER = "link_1"
OBJECTS = {  # and how many models of each; the fifth phone lies on its face
    "047_mouse": 3, "048_stapler": 7, "057_toycar": 6, "073_rubikscube": 3, "075_bread": 7,
    "077_phone": 4, "081_playingcards": 3, "112_tea-box": 6, "113_coffee-box": 7, "107_soap": 4,
}  # fmt: skip
PULL = 8.0  # [N] on the handle that the drawer's damping may cost
OUT = (0.15, 0.135, 0.12, 0.105)  # [m] of 0.178
BACK = (0.08, 0.06)  # [m] by which the hand that pulled must be able to leave the handle
TURN, TCP = 0.3, 0.12  # [rad] of that hand about the handle; [m] from its frame to its TCP
TILTS = (0.3, 0.4, 0.5, 0.6)  # [rad]
INTO = Placing(pre=0.11, gap=0.0, along="point")
BEHIND, DROP = 0.015, 0.06  # [m] from the drawer's point: the hand stays over the drawer's front


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
    """Over the drawer's floor and no higher than its front."""
    gap = scene.pose("object").p - scene.functional("cabinet", 0).p
    return bool(max(abs(gap[0]), abs(gap[1])) < 0.05 and -0.005 < gap[2] < 0.11)


def inside(scene: Scene, out: float, tilt: float) -> Pose:
    """Target over the drawer's floor, `out` further than now, seen by a hand tilted forward."""
    floor = scene.functional("cabinet", 0).p + np.array([0, BEHIND - out, DROP])
    return Pose(floor, quat_multiply(axis_angle((1, 0, 0), tilt), DOWN))


def ways_out(arm: Arm) -> list[list[Pose]]:
    """The hand as it is, at the drawer's end, and clear of the handle: farthest and straight first.

    On a low table a hand that comes straight soon has its elbow folded: then it turns a little
    about the handle, or leaves towards the middle.
    """
    ee, inward = arm.ee(), 1.0 if arm.side == "left" else -1.0
    tcp = ee.p + TCP * ee.R[:, 0]

    def at(turn: float, out: float, aside: float = 0.0) -> Pose:
        q = quat_multiply(axis_angle((0, 0, 1), inward * turn), ee.q)
        back = TCP * Pose((0, 0, 0), q).R[:, 0]
        return Pose(tcp - back + np.array([inward * aside, -out, 0.0]), q)

    return [
        [ee, at(turn, out), at(turn_back, out + back, aside)]
        for out in OUT
        for back in BACK
        for turn in (0.0, TURN)
        for turn_back, aside in ((turn, 0.0), (0.0, 0.04), (0.0, 0.08))
    ]


def pull(robot: Robot, arm: Arm) -> None:
    """Out no faster than the drawer's damping allows, and off the handle."""
    damping = robot.scene.physics.scalar("object_joint_damping", 2.0)
    for way in ways_out(arm):
        if robot.tried(lambda way=way: arm.sweep(way, prop="cabinet")):
            break
    else:
        raise Infeasible("unreachable", f"no way out for the {arm.side} hand at the handle")
    robot.do(arm.sweep(way[:2], seconds=max(OUT[0] * damping / PULL, 1.5), prop="cabinet"))
    if robot.scene.joint("cabinet")[0] < 0.1:
        raise Infeasible("too_slow", "the drawer did not follow the hand")
    robot.do(arm.open())
    robot.do(arm.line(way[2]))


def script(robot: Robot) -> None:
    arm = robot.nearest("object")
    puller, scene = robot.other(arm), robot.scene
    aim = Aim(inside(scene, OUT[0], TILTS[0]), None, INTO)
    robot.do(arm.grasp("object", pre=0.1, aim=aim))
    robot.do(puller.grasp("cabinet", pre=0.05))
    pull(robot, puller)
    robot.do(puller.lift(0.1), arm.lift(0.15))
    robot.do(puller.home())
    for tilt in TILTS:
        goal = inside(scene, 0.0, tilt)
        if robot.tried(lambda goal=goal: robot.do(arm.place("object", goal, how=INTO))):
            break
    else:
        raise Infeasible("unreachable", "no way over the drawer's front")
    robot.do(arm.lift(0.08))


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
