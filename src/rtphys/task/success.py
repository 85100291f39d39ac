"""Success as a composition of named conditions on measured, task-frame quantities.

`a & b` needs both, `~a` its opposite; a failed check can name the conditions that do not hold.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from rtphys.core.poses import Array
from rtphys.task.props import TABLE_TOP
from rtphys.task.scene import LEFT, RIGHT, Scene

Vector = Sequence[float]


@dataclass(frozen=True)
class Condition:
    """A named statement about the scene. `parts` is empty unless it is a conjunction.

    A condition that remembers (`Scene.once`, `Scene.peak`) must be asked at every instant;
    `rtphys.sim.rollout` sees to that, and spares the others.
    """

    text: str
    holds: Callable[[Scene], bool]
    parts: tuple["Condition", ...] = ()
    remembers: bool = False
    quick: bool = False  # costs little: asked before the others, as there is a poll every step
    measured: Callable[[Scene], str] | None = None  # what it judges, for people

    def __and__(self, other: "Condition") -> "Condition":
        parts = (self.parts or (self,)) + (other.parts or (other,))
        remembers = any(part.remembers for part in parts)

        def holds(scene: Scene) -> bool:
            verdicts = (part.holds(scene) for part in parts)
            return all(list(verdicts) if remembers else verdicts)  # ask all that remember

        return Condition(" and ".join(part.text for part in parts), holds, parts, remembers)

    def __invert__(self) -> "Condition":
        return condition(f"not ({self.text})", lambda s: not self.holds(s), self.remembers)

    def __bool__(self) -> bool:
        # `a and b` would be `b` alone, without a word.
        raise TypeError("conditions are joined by & and ~, not by `and`, `or` and `not`")

    def failing(self, scene: Scene) -> list[str]:
        """Texts of the parts that do not hold now, each with what was measured."""
        return [part.said(scene) for part in (self.parts or (self,)) if not part.holds(scene)]

    def said(self, scene: Scene) -> str:
        """The text, and what is measured now."""
        return f"{self.text} ({self.measured(scene)})" if self.measured else self.text


def near(prop: str, target: str | Vector, within: Vector, offset: Vector = (0, 0, 0)) -> Condition:
    """Origin of `prop` within (dx, dy, dz) [m] of a prop's origin or a point, plus offset."""
    bounds = tuple(float(w) for w in within)
    shift = tuple(float(o) for o in offset)

    def off(scene: Scene) -> list[float]:
        here = scene.pose(prop).p.tolist()
        goal = scene.pose(target).p.tolist() if isinstance(target, str) else target
        return [h - g - o for h, g, o in zip(here, goal, shift, strict=True)]

    def holds(scene: Scene) -> bool:
        return all(abs(x) < w for x, w in zip(off(scene), bounds, strict=True))

    text = f"{prop} within {bounds} m of {target}"
    return Condition(text, holds, measured=lambda s: _metres("off by", off(s)))


def points_meet(prop: str, point: int, target: str, target_point: int, within: Vector) -> Condition:
    """Functional point of `prop` within (dx, dy, dz) [m] of one of `target`."""

    def off(scene: Scene) -> Array:
        return scene.functional(prop, point).p - scene.functional(target, target_point).p

    def holds(scene: Scene) -> bool:
        return bool(np.all(np.abs(off(scene)) < np.asarray(within, float)))

    text = f"point {point} of {prop} at point {target_point} of {target}"
    return Condition(text, holds, measured=lambda s: _metres("off by", off(s)))


def in_row(*props: str, within: tuple[float, float] = (0.13, 0.03)) -> Condition:
    """Props stand in the given order from left to right.

    Args:
        within: (dx, dy) [m] between neighbours, at most.
    """

    def holds(scene: Scene) -> bool:
        places = np.array([scene.pose(prop).p for prop in props])
        gaps = np.diff(places, axis=0)
        ordered = np.all((gaps[:, 0] > 0) & (gaps[:, 0] < within[0]))
        return bool(ordered and np.all(np.abs(gaps[:, 1]) < within[1]))

    return Condition(f"{', '.join(props)} in a row", holds)


def beside(prop: str, other: str, side: str) -> Condition:
    """Directly to the left or right of another: 8 to 20 cm away, less than 5 cm in depth."""
    sign = -1.0 if side == LEFT else 1.0

    def holds(scene: Scene) -> bool:
        gap = scene.pose(prop).p - scene.pose(other).p
        distance = float(np.hypot(gap[0], gap[1]))
        return bool(0.08 < distance < 0.2 and sign * gap[0] > 0 and abs(gap[1]) < 0.05)

    return Condition(f"{prop} {side} of {other}", holds)


def on_table(*props: str) -> Condition:
    """Each prop's lowest point within 1 cm of the table's surface: neither held up nor stacked."""
    text = f"{', '.join(props)} on the table"
    return Condition(
        text,
        lambda s: all(abs(s.lowest(p) - TABLE_TOP) < 0.01 for p in props),
        measured=lambda s: _metres("higher by", [s.lowest(p) - TABLE_TOP for p in props]),
    )


def above(prop: str, height: float) -> Condition:
    """Origin of `prop` higher than `height` [m], task frame."""
    return Condition(
        f"{prop} above {height} m",
        lambda s: bool(s.pose(prop).p[2] > height),
        measured=lambda s: _metres("at", s.pose(prop).p[2:]),
    )


def lifted(prop: str, by: float) -> Condition:
    """The prop's lowest point at least `by` [m] above the table."""
    return Condition(
        f"{prop} lifted by {by} m",
        lambda s: bool(s.lowest(prop) > TABLE_TOP + by),
        measured=lambda s: _metres("by", [s.lowest(prop) - TABLE_TOP]),
    )


def opened(side: str, more_than: float = 0.8) -> Condition:
    """Measured opening of one gripper above a share of its range (official: 0.8)."""
    return Condition(
        f"{side} gripper open",
        lambda s: s.opening(side) > more_than,
        quick=True,
        measured=lambda s: f"{s.opening(side):.0%} of {more_than:.0%}",
    )


def hands_open() -> Condition:
    """Both grippers open, measured."""
    return opened(LEFT) & opened(RIGHT)


def touching(a: str, b: str) -> Condition:
    """Two things press on each other now."""
    return Condition(f"{a} touches {b}", lambda s: s.touching(a, b))


def free_of(prop: str, *others: str) -> Condition:
    """Nothing of `others` touches the prop."""
    text = f"{prop} free of {', '.join(others)}"
    return Condition(text, lambda s: not any(s.touching(prop, other) for other in others))


def held_by(prop: str, *sides: str) -> Condition:
    """Each of the named grippers presses on the prop, now."""
    text = f"{prop} held by {' and '.join(sides)}"
    return Condition(text, lambda s: all(in_hand(s, prop, side) for side in sides))


def in_hand(scene: Scene, prop: str, *sides: str) -> bool:
    """Whether a gripper of the named sides (none named: either) presses on the prop now."""
    return any(scene.touching(f"{side}_gripper", prop) for side in sides or (LEFT, RIGHT))


def in_either_hand(prop: str) -> Condition:
    """A gripper presses on the prop, now."""
    return Condition(f"the {prop} is in a hand", lambda s: in_hand(s, prop))


def at_rest(*props: str, slower_than: float = 0.05) -> Condition:
    """Linear speed of each prop below a bound [m/s]."""
    text = f"{', '.join(props)} at rest"
    return Condition(
        text,
        lambda s: all(s.speed(prop) < slower_than for prop in props),
        measured=lambda s: f"{max(s.speed(prop) for prop in props):.2f} m/s",
    )


def upright(prop: str, axis: int, within: float) -> Condition:
    """The prop's own axis (0 x, 1 y, 2 z) within an angle [rad] of the table normal."""
    text = f"{prop} upright within {within:.2f} rad"
    return Condition(
        text,
        lambda s: bool(s.pose(prop).R[2, axis] > np.cos(within)),
        measured=lambda s: _radians(s.pose(prop).R[2, axis]),
    )


def parallel(prop: str, axis: int, to: Vector, within: float) -> Condition:
    """The prop's own axis (0 x, 1 y, 2 z) within an angle [rad] of a direction, either way."""
    line = np.asarray(to, float) / np.linalg.norm(to)
    text = f"{prop} along {tuple(np.round(line, 2).tolist())} within {within:.2f} rad"
    return Condition(
        text,
        lambda s: bool(abs(s.pose(prop).R[:, axis] @ line) > np.cos(within)),
        measured=lambda s: _radians(float(abs(s.pose(prop).R[:, axis] @ line))),
    )


def turned_to(prop: str, q: Vector, within: float) -> Condition:
    """Orientation within an angle [rad] of a task-frame quaternion wxyz."""
    goal = np.asarray(q, float) / np.linalg.norm(q)

    def off(scene: Scene) -> float:
        return 2 * float(np.arccos(min(1.0, abs(float(scene.pose(prop).q @ goal)))))

    text = f"{prop} turned to {tuple(np.round(goal, 3).tolist())} within {within:.2f} rad"
    return Condition(text, lambda s: off(s) < within, measured=lambda s: f"{off(s):.2f} rad")


OFF = 0.03  # [m] of the TCP from what is pressed, outward, at least; the expert's is 3.4 to 6.5 cm
ASIDE = 0.01  # [m] of the pressed point from the hand's axis, at most; the expert's is 0.4 mm


def pressed(
    prop: str, contact: int, within: Vector, closed_below: float = 0.1, tilted_below: float = 0.55
) -> Condition:
    """A closed hand that points at a contact point, against its +y, touched the prop there, once.

    A hand whose TCP is not OFF the point, or whose axis passes ASIDE of it, meets the prop with its
    side: of 140 clocks, random motion brushed one so.

    Args:
        within: (dx, dy, dz) [m] between a measured contact and the declared point.
        closed_below: largest measured opening of the pressing gripper that counts.
        tilted_below: largest angle [rad] between its approach (TCP +x) and the point's -y.
    """
    bounds = np.asarray(within, float)

    def holds(scene: Scene) -> bool:
        hit = False
        for side in (LEFT, RIGHT):
            if scene.opening(side) >= closed_below:
                continue  # asked first: contacts cost ten times as much
            points = scene.contact_points(f"{side}_gripper", prop)
            if not len(points):
                continue
            tcp, point = scene.tcp(side), scene.contact(prop, contact)
            outward = point.R[:, 1]
            straight = -(tcp.R[:, 0] @ outward) >= np.cos(tilted_below)
            off = (tcp.p - point.p) @ outward
            aside = np.linalg.norm(np.cross(tcp.p - point.p, tcp.R[:, 0]))
            there = np.all(np.abs(points - point.p) < bounds, axis=1).any()
            hit |= bool(straight and off > OFF and aside < ASIDE and there)
        return scene.once(f"pressed {prop} {contact}", hit)

    return Condition(f"{prop} pressed at its point {contact}", holds, remembers=True)


def joint_beyond(prop: str, share: float, index: int = 0) -> Condition:
    """An articulated prop's joint past a share of its range."""

    def holds(scene: Scene) -> bool:
        q, low, high = scene.joint(prop, index)
        return q >= low + share * (high - low)

    def now(scene: Scene) -> str:
        q, low, high = scene.joint(prop, index)
        return f"{(q - low) / (high - low):.0%}"

    return Condition(f"{prop} joint {index} beyond {share:.0%}", holds, measured=now)


def shaken(prop: str, by: float, turns: int, during: Condition) -> Condition:
    """The prop's height has turned round at least `turns` times, by at least `by` [m] each.

    Only what happens while `during` holds counts.
    """

    def holds(scene: Scene) -> bool:
        turn = 0
        while scene.once(f"{prop} turned round {turn}", False):
            turn += 1
        if turn < turns and during.holds(scene):
            height = float(scene.pose(prop).p[2]) * (-1) ** turn
            fallen = scene.peak(f"{prop} height {turn}", height) - height
            turn += scene.once(f"{prop} turned round {turn}", fallen > by)
        return turn >= turns

    return Condition(f"{prop} shaken {turns} times by {by} m", holds, remembers=True)


def _metres(word: str, numbers: Iterable[float]) -> str:
    return f"{word} {', '.join(f'{x:.3f}' for x in numbers)} m"


def _radians(cosine: float) -> str:
    return f"{float(np.arccos(np.clip(cosine, -1, 1))):.2f} rad"


def condition(
    text: str,
    holds: Callable[[Scene], bool],
    remembers: bool = False,
    measured: Callable[[Scene], str] | None = None,
) -> Condition:
    """A task's own condition, with the sentence that names it.

    `remembers` must be true when it uses `Scene.once` or `Scene.peak`. `measured` says what it
    judges, with its unit; it is shown where the condition does not hold.
    """
    return Condition(text, holds, remembers=remembers, measured=measured)
