"""What a script can say: verbs of one arm, and a robot that carries out motions of both.

A verb returns a `Motion`; nothing moves until `robot.do(...)`. Motions of both arms in one `do` run
together, step by step. Poses are task-frame. The expert implements these; tasks see nothing else.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TypeVar

from rtphys.assets.embodiment import Hand
from rtphys.core.errors import Infeasible, UnknownName
from rtphys.core.poses import Array, Pose
from rtphys.task.scene import Scene

T = TypeVar("T")  # an option of `Robot.first_feasible`


@dataclass(frozen=True)
class Reach:
    """Go to an ee pose along any clear path. The first reachable of `candidates` is taken."""

    candidates: tuple[Pose, ...]
    posture: tuple[float, ...] = ()  # (n,) [rad] for the first candidate, where already found
    room: float = 0.0  # [m] that what is carried keeps to everything on the way; 0: may graze
    speed: float = 1.0  # scales the usual one


@dataclass(frozen=True)
class Line:
    """Move the ee in a straight line to a pose."""

    goal: Pose
    speed: float = 1.0  # scales the usual one
    until: str = ""  # stop early once the gripper (or what it holds) presses on this prop


@dataclass(frozen=True)
class Shift:
    """Move the ee in a straight line by an offset from wherever it is then.

    `shares` are tried in order until the line stays in reach: (1.0, 0.8) accepts 80 % of it.
    """

    offset: tuple[float, float, float]  # [m]
    tool: bool = False  # offset in the ee frame (x approach) instead of the task frame
    turn: tuple[float, ...] = ()  # new ee orientation wxyz, task frame; empty: keep
    speed: float = 1.0
    until: str = ""
    must: bool = False  # touching `until` is the point: not touching it ends the attempt
    shares: tuple[float, ...] = (1.0,)


@dataclass(frozen=True)
class Follow:
    """Move the ee through poses in one motion, as straight lines with rounded corners."""

    poses: tuple[Pose, ...]
    seconds: float = 0.0  # take at least this long


@dataclass(frozen=True)
class Grip:
    """Move the fingers to an opening 0..1. `holds` names what must be between them after."""

    opening: float
    holds: str = ""
    releases: str = ""


@dataclass(frozen=True)
class Wait:
    """Keep still [s]."""

    seconds: float


@dataclass(frozen=True)
class Home:
    """Return to the joint configuration of the start."""


Step = Reach | Line | Shift | Follow | Grip | Wait | Home


@dataclass(frozen=True)
class Motion:
    """Steps of one arm, with the name of the stage they belong to."""

    side: str
    stage: str
    steps: tuple[Step, ...]

    def then(self, other: "Motion") -> "Motion":
        """Both motions of the same arm, one after the other."""
        if other.side != self.side:
            raise ValueError("`then` joins motions of one arm; give two motions to robot.do")
        return Motion(self.side, self.stage, self.steps + other.steps)


@dataclass(frozen=True)
class Placing:
    """How a held prop's point, or its frame, meets its target: z onto z, then a turn about z.

    `mode` "align" turns x onto the target's x; "auto" a hand that holds from the side forwards and
    inwards, and one from above with its camera away from the robot; "free" does not turn. `pre` and
    `gap` [m] are left before and after the last straight line. It runs along the "grasp" (gripper
    to prop) or the "point" (the target's z), and stops `lean` [m] after the load touches the prop
    `until`: at a replay's slower pace a load hangs a little higher.
    `yaws` [rad] are further turns, tried in order. `clear`: hand and load must touch nothing at the
    end, in a box or beside others. `speed` is that of the way there; slower, a load turns less.
    """

    mode: str = "auto"
    pre: float = 0.1
    gap: float = 0.02
    along: str = "grasp"
    release: bool = True
    until: str = ""
    lean: float = 0.006
    yaws: tuple[float, ...] = (0.0,)
    clear: bool = False
    speed: float = 1.0

    def __post_init__(self) -> None:
        for key, name, known in (
            ("placing mode", self.mode, ("align", "auto", "free")),
            ("way to place along", self.along, ("grasp", "point")),
        ):
            if name not in known:
                raise UnknownName(key, name, known)


@dataclass(frozen=True)
class Aim:
    """Where a thing will be placed, so that it is grasped in a way that allows it."""

    target: Pose
    point: int | None = None
    how: Placing = Placing()


def leaning(offset: tuple[float, float, float], tool: bool = False) -> tuple[Step, Step]:
    """Press on and stay, for recorded actions are 0.06 s apart: one must see the deepest."""
    return Shift(offset, tool), Wait(0.12)


class Arm(ABC):
    """Verbs of one arm. Distances in metres, angles in radians, openings 0..1."""

    side: str  # "left" or "right"
    hand: Hand  # measures of its gripper: ee to TCP, TCP to fingertips, size of the pads [m]

    @abstractmethod
    def ee(self) -> Pose:
        """Commanded end-effector pose, task frame."""

    @abstractmethod
    def grasp(
        self,
        prop: str,
        contacts: Sequence[int] = (),
        pre: float = 0.1,
        depth: float = 0.0,
        grip: float = 0.0,
        aim: Aim | None = None,
    ) -> Motion:
        """Reach `pre` in front of a contact point, advance to `depth` short of it, close.

        Args:
            aim: prefer a grasp from which this placement will be reachable.
            contacts: allowed contact point ids; empty: all of the prop's.
            grip: commanded opening to close to; 0 presses as hard as the servo can.

        Raises:
            Infeasible: "unreachable" or "ungraspable".
        """

    @abstractmethod
    def hover(
        self, prop: str, contact: int = 0, gap: float = 0.1, straight_down: bool = False
    ) -> Motion:
        """Bring the TCP `gap` in front of a contact point, fingers pointing at it."""

    @abstractmethod
    def place(
        self, prop: str, target: Pose, point: int | None = None, how: Placing | None = None
    ) -> Motion:
        """Bring the held prop (its functional point, or its origin) to a target pose and let go."""

    @abstractmethod
    def sweep(
        self, *paths: Sequence[Pose], seconds: float = 0.0, prop: str = "", speed: float = 1.0
    ) -> Motion:
        """Reach the start of the first feasible path, then follow it in one motion.

        Args:
            paths: ee poses each; the first that is reachable without a change of branch counts.
            seconds: least duration of the path itself.
            prop: what the hand may touch at the start.
            speed: share of the usual one on the way to the start of the path.

        Raises:
            Infeasible: "unreachable", when no path is.
        """

    @abstractmethod
    def carry(
        self, prop: str, *paths: Sequence[Pose], seconds: float = 0.0, speed: float = 1.0
    ) -> Motion:
        """Sweep the held prop itself through poses of its frame; else as `sweep`."""

    @abstractmethod
    def open(self, opening: float = 1.0) -> Motion:
        """Open the fingers, releasing whatever is held."""

    @abstractmethod
    def felt(self) -> Array:
        """(T, 6) force [N] and moment [N m] that things exert on the hand, task frame.

        One row a frame (60 ms) of the last `robot.do`, as joint efforts say it. The moment is about
        the TCP. While the arm accelerates, its own inertia is in it.
        """

    def close(self, opening: float = 0.0, holds: str = "") -> Motion:
        """Close the fingers; `holds` names what must then be between them."""
        return self.motion("close", Grip(opening, holds=holds))

    def shift(self, x: float = 0, y: float = 0, z: float = 0, turn: Sequence[float] = ()) -> Motion:
        """Straight line by a task-frame displacement [m]; `turn`: new ee orientation wxyz."""
        return self.motion("shift", Shift((x, y, z), turn=tuple(turn)))

    def lift(self, z: float, speed: float = 1.0) -> Motion:
        """Straight up by z [m], or as far as the arm reaches (at least half of it)."""
        shares = (1.0, 0.85, 0.7, 0.5)
        return self.motion("lift", Shift((0.0, 0.0, z), speed=speed, shares=shares))

    def retreat(self, distance: float) -> Motion:
        """Back off against the approach direction [m], or as far as the arm reaches."""
        shares = (1.0, 0.75, 0.5)
        return self.motion("retreat", Shift((-distance, 0.0, 0.0), tool=True, shares=shares))

    def advance(self, distance: float, until: str = "", speed: float = 1.0) -> Motion:
        """Straight on along the approach direction [m], or until it presses on a prop."""
        step = Shift((distance, 0.0, 0.0), tool=True, until=until, speed=speed)
        return self.motion("advance", step)

    def press(self, prop: str, reach: float, push: float = 0.004) -> Motion:
        """Straight on until the hand touches the prop, at most `reach` [m]; lean in by `push`.

        Raises:
            Infeasible: "stalled", when nothing was touched.
        """
        until = Shift((reach, 0.0, 0.0), tool=True, until=prop, must=True, speed=0.5)
        lean = leaning((push, 0.0, 0.0), tool=True)
        return self.motion(f"press {prop}", until, *lean)

    def reach(self, *candidates: Pose) -> Motion:
        """Go to the first reachable ee pose."""
        return self.motion("reach", Reach(candidates))

    def line(self, goal: Pose, speed: float = 1.0, until: str = "") -> Motion:
        """Straight line of the ee to a pose, or until it presses on a prop."""
        return self.motion("line", Line(goal, speed=speed, until=until))

    def home(self) -> Motion:
        """Back to where the arm started."""
        return self.motion("home", Home())

    def wait(self, seconds: float) -> Motion:
        """Hold still."""
        return self.motion("wait", Wait(seconds))

    def motion(self, stage: str, *steps: Step) -> Motion:
        """Steps of this arm as a motion."""
        return Motion(self.side, f"{self.side} {stage}", steps)


class Robot(ABC):
    """Both arms and what a script may know about the world (everything the scene shows)."""

    left: Arm
    right: Arm
    scene: Scene

    @abstractmethod
    def do(self, *motions: Motion) -> None:
        """Carry out motions: those of different arms together, those of one arm in order.

        Raises:
            Infeasible: with the reason; it ends the attempt.
        """

    @abstractmethod
    def seen(self, prop: str) -> Array:
        """(T, 3) places of a prop's origin, task frame, one a frame (60 ms) of the last `do`."""

    @abstractmethod
    def tried(self, action: Callable[[], object]) -> bool:
        """Run `action`; False when it was infeasible by planning (nothing has moved then)."""

    @abstractmethod
    def retake(self, action: Callable[[], None]) -> None:
        """Run `action`, which takes hold of something; once more if its load slips or is missed.

        The hand that lost it opens and backs off first. Once in an episode; from then on all
        stages begin with "recover", and loads are carried more slowly.

        Raises:
            Infeasible: "recovered", where the recipe excludes it; else as the action.
        """

    def first_feasible(self, options: Iterable[T], act: Callable[[T], object]) -> T | None:
        """Run `act` on each option until one can be planned (see `tried`); that one, or None."""
        return next((option for option in options if self.tried(partial(act, option))), None)

    def arm(self, side: str) -> Arm:
        """The arm of a side."""
        return self.left if side == "left" else self.right

    def nearest(self, prop: str) -> Arm:
        """The arm on whose half of the table the prop stands (x < 0: left)."""
        return self.left if self.scene.pose(prop).p[0] < 0 else self.right

    def other(self, arm: Arm) -> Arm:
        """The opposite arm."""
        return self.right if arm.side == "left" else self.left


def place_at_first(
    arm: Arm, prop: str, goals: Sequence[Pose], how: Placing, point: int | None = None
) -> Motion:
    """`arm.place` at the first of the goals (task frame) that the arm can reach.

    Args:
        point: functional point of the prop that arrives; None: its origin.

    Raises:
        Infeasible: "unreachable", when no goal is.
    """
    for goal in goals:
        try:
            return arm.place(prop, goal, point=point, how=how)
        except Infeasible:
            continue
    raise Infeasible("unreachable", f"the {arm.side} hand finds no place for {prop}")
