"""Of two laptops that look alike, open the one whose hinge moves easily; leave the stiff one.

Success: the loose hinge is past 40 % of its range and at rest, with a closed hand at its lid, and
the stiff one has not left its place.
"""

from collections.abc import Mapping
from math import pi

from rtphys.task import (
    IDENTITY,
    LEFT,
    RIGHT,
    Articulated,
    Draw,
    Robot,
    Scene,
    Task,
    condition,
)

from .._hinges import angle_to, opened_in_time, share_open
from .._lids import hands_at, lever, swing
from ._hidden import ranked, values

LAPTOPS = {"first": LEFT, "second": RIGHT}  # the arm on whose side it stands
SHUT, STILL_SHUT, OPEN = 0.2, 0.27, 0.4  # shares of the range: at first, at most, success
ENOUGH, DONE = 0.52, 0.43  # to which the hand goes, and that is enough
TRIED = 0.24  # to which a hinge is moved on trial
PUSH, MIN_TIME = 9.0, 1.5  # [N] on the edge that damping may cost; [s] of a swing
TRIAL_TIME = 1.0  # [s]
LOOKS = 10  # at the lid after a swing
RESTS = 0.05  # [m/s] slower than this; a hand that strikes a lid throws it open, and it falls shut
UP = 0.05  # [m] off the lid


def layout(draw: Draw):
    model = draw.choice("model", *range(11))
    for name, x in (("first", (-0.24, -0.2)), ("second", (0.2, 0.24))):
        spot = draw.spot(name, x=x, y=(0.0, 0.05), yaw=(pi / 2 - 0.2, pi / 2 + 0.2))
        yield Articulated(
            name=name, category="015_laptop", model=model, pose=spot.pose(IDENTITY), fixed=True,
            opening=SHUT,
        )  # fmt: skip


def loose_is_open(scene: Scene) -> bool:
    loose, stiff = ranked(scene, "object_joint_damping", list(LAPTOPS))
    if share_open(scene, loose) <= OPEN or share_open(scene, stiff) >= STILL_SHUT:
        return False
    return scene.speed(loose) < RESTS and bool(hands_at(scene, loose))


def script(robot: Robot) -> None:
    scene = robot.scene
    loose, _ = ranked(scene, "object_joint_damping", list(LAPTOPS))
    damping = values(scene, "object_joint_damping", LAPTOPS)[loose]
    arm = robot.arm(LAPTOPS[loose])
    seconds = angle_to(scene, loose, ENOUGH) * damping / (PUSH * lever(scene, loose))
    robot.do(robot.left.close(), robot.right.close())
    swing(robot, arm, loose, ENOUGH, max(seconds, MIN_TIME))
    opened_in_time(robot, arm, loose, DONE, LOOKS)


def feel(robot: Robot) -> Mapping[str, float]:
    return {f"object_joint_damping@{name}": moved(robot, name) for name in LAPTOPS}


def moved(robot: Robot, laptop: str) -> float:
    """Damping from the force that moves a lid a little, and how fast it goes [N m s/rad]."""
    arm, scene = robot.arm(LAPTOPS[laptop]), robot.scene
    robot.do(arm.close())
    before = scene.joint(laptop)[0]
    swing(robot, arm, laptop, TRIED, TRIAL_TIME)
    force = max(float((f[:3] ** 2).sum() ** 0.5) for f in arm.felt())
    speed = max(scene.joint(laptop)[0] - before, 1e-3) / TRIAL_TIME
    robot.do(arm.shift(z=-UP / 2))
    robot.do(arm.home())
    return force * lever(scene, laptop) / speed


task = Task(
    layout=layout,
    script=script,
    feel=feel,
    success=condition("the loose lid rests open, the stiff one is not", loose_is_open),
    step_limit=900,
    mechanism="hidden joint damping: choose",
)
