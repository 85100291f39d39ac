"""Measures what happens in a demonstration: forces on links, depths, creep in the hands, bits."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from rtphys.core.poses import Array
from rtphys.physics.handles import GRAVITY
from rtphys.sim.engine import RATE, TIME_STEP
from rtphys.sim.objects import SceneObject
from rtphys.sim.robot import SimArm
from rtphys.sim.strain import MAX_FORCE, MAX_SECONDS, STRIDE
from rtphys.sim.world import World

LONGEST = round(MAX_SECONDS * RATE) + STRIDE  # [steps]; whoever looks more rarely may miss the ends
DEEP, DEEP_STEPS = 0.003, 5  # [m] of one body in another, and steps in a row of it, that count
LOOK = 15  # [steps] between two looks at the hands
STILL, KEPT = 0.0003, 0.00006  # [m] between two looks: of a hand; of the gap between its fingers
LIGHT = 0.25  # share of what a grip bears, below which it is judged
CREEP = 0.008  # [m/s] friction's `scope`; docs/physics.md has the shares of looks below it
ENOUGH = 5  # looks at one grip
KINDS = ("point", "line", "flat")  # how a finger touches
WIDE = 0.002  # [m] spread (root mean square) of a contact's points that is more than none


@dataclass(frozen=True, eq=False)
class Held:
    """One look at a thing in a hand."""

    step: int
    hand: Array  # (3,) [m]
    gap: float  # [m]
    place: Array  # (3,) [m] of its centre of mass from the middle between the fingers, hand's frame
    share: float  # of what the grip bears
    kind: str  # where the fingers touch it: "flat", along a "line", or at a "point"


class Longest:
    """Of each pair of bodies that is named at a step, the most steps in a row that name it."""

    def __init__(self) -> None:
        self._row: dict[tuple[str, str], int] = {}
        self.steps: dict[tuple[str, str], int] = {}

    def add(self, pairs: Iterable[tuple[str, str]]) -> None:
        """One step."""
        self._row = {pair: self._row.get(pair, 0) + 1 for pair in pairs}
        for pair, steps in self._row.items():
            self.steps[pair] = max(steps, self.steps.get(pair, 0))


class Demonstration:
    """Watches a world from the moment on at which it is made.

    Args:
        friction: thing -> the label's coefficient; "": of the others.
    """

    def __init__(self, world: World, friction: Mapping[str, float]) -> None:
        self._world, self._friction = world, friction
        self._joints = world.robot.articulation.active_joints
        # Keyed by the component itself: held here, it is the same object in every contact.
        arms = world.robot.arms
        self._fingers: dict[object, SimArm] = {
            link: arm for arm in arms for link in arm.finger_links
        }
        links = (link for link in world.robot.articulation.links if link not in self._fingers)
        self._links: dict[object, str] = {link: link.name for link in links}
        loose = (o for o in world.objects.values() if o.articulation is None and o.bodies)
        self._things: dict[object, SceneObject] = {o.root: o for o in loose}
        self._looks: dict[tuple[str, str], list[Held]] = {}
        self.pressed = Longest()  # a link and what it met, above MAX_FORCE
        self.deep = Longest()  # two bodies, one more than DEEP in the other
        self.commands: list[Array] = []  # (joints, 2) position and velocity, of each step
        self.states: list[bytes] = []  # poses of all bodies after each step
        world.on_step("demonstration", self._before, self._after)

    def _before(self) -> None:
        targets = [(j.drive_target[0], j.drive_velocity_target[0]) for j in self._joints]
        self.commands.append(np.array(targets, float))

    def _after(self) -> None:
        self.states.append(self._world.scene.pack_poses())
        forces: dict[tuple[str, str], Array] = {}
        deep: set[tuple[str, str]] = set()
        for contact in self._world.solver.get_contacts():
            if min((p.separation for p in contact.points), default=0.0) < -DEEP:
                a, b = contact.bodies
                deep.add((a.entity.name, b.entity.name))
            for link, other in (contact.bodies, contact.bodies[::-1]):
                if link in self._links:
                    pair = self._links[link], other.entity.name
                    impulses = [np.asarray(p.impulse, float) for p in contact.points]
                    push = np.sum([np.zeros(3), *impulses], axis=0) / TIME_STEP
                    forces[pair] = forces.get(pair, np.zeros(3)) + push
        self.pressed.add(pair for pair, f in forces.items() if np.linalg.norm(f) > MAX_FORCE)
        self.deep.add(deep)
        if len(self.states) % LOOK == 0:
            self._look()

    def problems(self) -> list[str]:
        """A sentence on each link pressed for long, deep overlap, and grip that creeps."""
        pressed = [
            f"{link} and {other} press with over {MAX_FORCE:g} N for {steps / RATE:.2f} s"
            for (link, other), steps in self.pressed.steps.items()
            if steps > LONGEST
        ]
        deep = [
            f"{a} lies over {1000 * DEEP:g} mm deep in {b} for {steps} steps"
            for (a, b), steps in self.deep.steps.items()
            if steps > DEEP_STEPS
        ]
        crept = {grip: np.median(speeds) for grip, speeds in self.creep().items()}
        return [*pressed, *deep] + [
            f"{name} creeps in the {side} hand by {1000 * speed:.1f} mm/s, below a quarter of "
            f"what the grip bears"
            for (side, name), speed in crept.items()
            if speed > CREEP
        ]

    def creep(self) -> dict[tuple[str, str], list[float]]:
        """Hand and thing -> speeds [m/s] of looks at which the hand rests and the load is light."""
        found: dict[tuple[str, str], list[float]] = {}
        for grip, held, speed in self.at_rest():
            if held.share < LIGHT:
                found.setdefault(grip, []).append(speed)
        return {grip: speeds for grip, speeds in found.items() if len(speeds) >= ENOUGH}

    def at_rest(self) -> Iterator[tuple[tuple[str, str], Held, float]]:
        """Hand and thing, look, and speed [m/s], of each look at which hand and fingers rest."""
        for grip, looks in self._looks.items():
            for first, second, third in zip(looks, looks[1:], looks[2:], strict=False):
                rests = all(
                    b.step - a.step == LOOK
                    and np.linalg.norm(b.hand - a.hand) < STILL
                    and abs(b.gap - a.gap) < KEPT
                    for a, b in ((first, second), (second, third))
                )
                if rests:
                    way = float(np.linalg.norm(third.place - second.place))
                    yield grip, second, way / (LOOK * TIME_STEP)

    def _look(self) -> None:
        """At everything that touches the two fingers of one hand, and nothing else."""
        normal: dict[object, dict[object, float]] = {}  # thing -> finger or other -> force [N]
        points: dict[tuple[object, object], list[Array]] = {}  # thing, other -> where they press
        for contact in self._world.solver.get_contacts():
            for thing, other in (contact.bodies, contact.bodies[::-1]):
                if thing in self._things:
                    push = sum(abs(float(np.dot(p.impulse, p.normal))) for p in contact.points)
                    by = normal.setdefault(thing, {})
                    by[other] = by.get(other, 0.0) + push / TIME_STEP
                    pressed = [p.position for p in contact.points if np.any(p.impulse)]
                    points.setdefault((thing, other), []).extend(np.array(pressed, float))
        for thing, by in normal.items():
            pushing = {other: force for other, force in by.items() if force > 0}
            hands = {self._fingers.get(other) for other in pushing}
            arm = next(iter(hands), None)
            if len(pushing) == 2 and len(hands) == 1 and arm is not None:
                kind = min(KINDS.index(_kind(points[thing, finger])) for finger in pushing)
                held = self._held(self._things[thing], arm, sum(pushing.values()), KINDS[kind])
                self._looks.setdefault((arm.side, self._things[thing].name), []).append(held)

    def _held(self, thing: SceneObject, arm: SimArm, normal: float, kind: str) -> Held:
        X, body = arm.ee(), thing.bodies[0]
        a, b = (np.asarray(link.entity_pose.p, float) for link in arm.finger_links)
        along = (b - a) / np.linalg.norm(b - a)
        load = body.mass * GRAVITY * np.array([self._world.external_force, 0.0, -1.0])
        across = float(np.linalg.norm(load - (load @ along) * along))
        place = X.R.T @ (thing.pose @ body.com - (a + b) / 2)
        friction = self._friction.get(thing.name, self._friction[""])
        share = across / (friction * normal) if friction else np.inf
        return Held(len(self.states), X.p, arm.gap(), place, share, kind)


def _kind(points: list[Array]) -> str:
    """By the spread of contact points (3,) [m] about their mean, along their principal axes."""
    spread = np.linalg.svd(np.array(points) - np.mean(points, axis=0), compute_uv=False)
    extents = spread / len(points) ** 0.5
    return KINDS[int((extents[:2] > WIDE).sum())]


def replay(world: World, commands: Sequence[Array], states: Sequence[bytes]) -> int | None:
    """The step from which on a settled world, driven by the same commands, has other states."""
    joints = world.robot.articulation.active_joints
    world.policy_stage = True
    for step, (targets, before) in enumerate(zip(commands, states, strict=True)):
        for joint, (position, velocity) in zip(joints, targets, strict=True):
            joint.set_drive_target(float(position))
            joint.set_drive_velocity_target(float(velocity))
        world.step()
        if world.scene.pack_poses() != before:
            return step
    return None
