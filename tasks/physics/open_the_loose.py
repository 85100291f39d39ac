"""Of two laptops that look alike, open the one whose hinge moves easily; leave the stiff one.

Success: a closed hand at its lid has moved the loose hinge past 40 % of its range, and is still
there; the stiff one has not left its place.
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
    if share_open(scene, loose) <= OPEN:
        return False
    at_lid = bool(hands_at(scene, loose))
    # A lid that something struck stays open, and some hand passes by later.
    opened = scene.once("opened by a hand", at_lid and not scene.once("thrown open", False))
    scene.once("thrown open", not opened)
    return at_lid and opened and share_open(scene, stiff) < STILL_SHUT


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
    success=condition("a hand has opened the loose lid alone", loose_is_open, remembers=True),
    step_limit=900,
    mechanism="hidden joint damping: choose",
)
