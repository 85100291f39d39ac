"""Whether the arms of a robot touch anything, by exact distances of convex shapes.

A `PairModel` holds the pairs of one set of bodies; `CollisionChecker` keeps some, because most sets
come back.
"""

from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass, field
from itertools import combinations
from typing import Any, NamedTuple

import coal  # pyright: ignore[reportMissingImports]  (lives behind a .pth file)
import numpy as np
import pinocchio as pin  # pyright: ignore[reportMissingImports]

from rtphys.assets.action_layout import SIDES
from rtphys.assets.embodiment import Embodiment
from rtphys.core.poses import Array, Pose
from rtphys.plan.robot_shapes import STATIC, RobotShapes, Shape, bounding_sphere, hull

OBSTACLE = "obstacle"

# Least distances [m]. A negative one allows that much overlap.
ARM_MARGIN = 0.005  # arm links and the hand's body to the surroundings and the other arm
FINGER_MARGIN = 0.0015  # fingers to anything; grasps keep 2 mm to the table, servo error takes some
LINE_MARGIN = 0.001  # links to what is grasped, and to anything along a straight line
SELF_MARGIN = 0.0  # links of one arm
CARRIED_MARGIN = 0.003  # a carried body to the robot and to what the other hand carries
RESTING_MARGIN = -0.002  # a carried body to obstacles: it starts and ends in contact with them

_SLACK = 1e-4  # [m] more than any rounding
_KEPT_PAIRS = 64_000  # of all models kept for use again: 5 KB each
_KEPT_HULLS = 512  # shapes seen before are not made again; objects change size every episode


class Rules(NamedTuple):
    """What the caller may change about pairs."""

    ignored: frozenset[tuple[str, str]] = frozenset()
    # [m] from carried bodies to obstacles. The default lets them overlap, so that a body may leave
    # and reach what it rests on; a transfer needs a positive one, or its shortcuts graze things.
    carried_margin: float = RESTING_MARGIN
    links_only: bool = False  # fingers and loads may touch all but links that are no fingers


@dataclass(frozen=True, eq=False)
class Obstacle:
    """A convex body in the world. A body of several convex parts is several obstacles of one name.

    `vertices` is (n, 3), the points whose hull is the body, or (3,), the half sizes of a box; both
    in metres in the body's frame. `pose` is X_WO.
    """

    name: str
    vertices: Array
    pose: Pose = field(default_factory=Pose)


# ---- pairs and margins ---------------------------------------------------------------------------


def own_margins(robot: RobotShapes) -> Array:
    """Least distance of every pair (i < j) of the robot's own n shapes (n, n) [m].

    NaN for pairs that are not checked: neighbours, and what cannot meet in any posture.
    """
    balls = [robot.reach(shape) for shape in robot.shapes]
    table = np.full((len(balls), len(balls)), np.nan)
    for i, j in combinations(range(len(balls)), 2):
        a, b = robot.shapes[i], robot.shapes[j]
        if a.owner == b.owner and abs(a.depth - b.depth) <= 1:  # static shapes have depth 0
            continue
        gap = float(np.linalg.norm(balls[i][0] - balls[j][0]))
        if gap > balls[i][1] + balls[j][1] + ARM_MARGIN:
            continue
        between = FINGER_MARGIN if a.finger or b.finger else ARM_MARGIN
        table[i, j] = SELF_MARGIN if a.owner == b.owner else between
    return table


def margins(bodies: Sequence[Shape], own: Array, rules: Rules) -> Array:
    """Least distance of every pair (i < j) of n bodies (n, n) [m], NaN for what is not checked.

    Args:
        bodies: the robot's own shapes first, then obstacles, then carried bodies.
        own: `own_margins` of the robot's own shapes.
    """
    n = len(own)
    owner = np.array([body.owner for body in bodies])
    name = np.array([body.name for body in bodies])
    hand = np.array([body.hand for body in bodies])
    carried = np.array([body.carried for body in bodies])
    finger = np.array([body.finger for body in bodies])
    still, obstacle = (owner == OBSTACLE) | (owner == STATIC), owner == OBSTACLE

    # Columns of what is not the robot's, all at once, for speed.
    loaded = carried[:, None] | carried[n:]
    resting = obstacle[:, None] | obstacle[n:]
    margin = np.where(finger, FINGER_MARGIN, ARM_MARGIN)[:, None] + np.zeros(len(bodies) - n)
    margin[loaded] = CARRIED_MARGIN
    margin[loaded & resting] = rules.carried_margin
    unchecked = still[:, None] & still[n:]
    unchecked |= (owner[:, None] == owner[n:]) & hand[:, None] & hand[n:]
    # Two hands on one body: each may touch the body that the other one carries.
    carried_by = {(body.owner, body.name) for body in bodies if body.carried}
    for side, touched in rules.ignored | carried_by:
        soft, body = (finger | carried) & (owner == side), name == touched
        unchecked |= soft[:, None] & body[n:] | body[:, None] & soft[n:]
        hard = hand & ~soft & (owner == side)  # palm and camera come near
        margin[hard[:, None] & body[n:]] = LINE_MARGIN
    margin[unchecked] = np.nan

    table = np.full((len(bodies), len(bodies)), np.nan)
    table[:n, :n], table[:, n:] = own, margin
    table[n:, n:][np.tri(len(bodies) - n, dtype=bool)] = np.nan
    if rules.links_only:
        link = ~(still | finger | carried)
        table[~(link[:, None] | link)] = np.nan
        table = np.minimum(table, LINE_MARGIN)
    return table


class PairModel:
    """A geometry model of the robot and some items, with margins by rules.

    Making one takes milliseconds where there are thousands of pairs. Moving or resizing its items,
    and saying under which rules it is asked, takes a tenth of that.
    """

    def __init__(self, robot: RobotShapes, own: Array, items: Sequence[Shape]) -> None:
        """
        Args:
            own: `own_margins` of the robot's own shapes.
        """
        self._robot, self._own, self._items = robot, own, items
        self.bodies = [*robot.shapes, *items]
        self.geometry = pin.GeometryModel()
        for i, shape in enumerate(self.bodies):
            self.geometry.addGeometryObject(
                pin.GeometryObject(str(i), shape.joint, shape.placement, shape.geometry)
            )
        self._balls = [bounding_sphere(shape.geometry) for shape in self.bodies]
        self._tables: dict[Rules, Array] = {}  # margins under rules seen
        self._broad: dict[Rules, Any] = {}  # and what finds collisions
        self._rules: Rules | None = None  # in force
        self.geometry.setCollisionPairs(np.isfinite(self._margins(Rules())), True)
        self.data = pin.GeometryData(self.geometry)  # milliseconds, so there is one for all rules

    @property
    def pairs(self) -> int:
        """How many pairs it has."""
        return len(self.geometry.collisionPairs)

    def put(self, items: Sequence[Shape]) -> None:
        """Put these items, of the same kinds in the same order, in the place of the present ones.

        A pair looks up the shapes of its two bodies each time it is asked, so they may be others;
        only their types are settled when it is made.
        """
        replaced = zip(self._items, items, strict=True)
        for k, (old, new) in enumerate(replaced, len(self._robot.shapes)):
            geometry_object = self.geometry.geometryObjects[k]
            geometry_object.placement = new.placement
            if new.geometry is not old.geometry:
                geometry_object.geometry = new.geometry
                self._balls[k] = bounding_sphere(new.geometry)
                self._broad.clear()  # it keeps shapes
        self._items = items

    def enforce(self, rules: Rules) -> None:
        """Ask by these rules from now on."""
        if rules.links_only:  # the others are about fingers and loads: one model for all
            rules = Rules(links_only=True)
        if rules != self._rules:
            self._rules, distances = rules, self._margins(rules)
            self.data.setActiveCollisionPairs(self.geometry, np.isfinite(distances), True)
            self.data.setSecurityMargins(self.geometry, np.nan_to_num(distances), True, True)
            self._margins_in_force = distances
        if rules not in self._broad:
            # Of the broad phases this one alone agreed with the full loop on every posture tried.
            # It inflates its boxes by the margins once and for all.
            self._broad[rules] = pin.BroadPhaseManager_DynamicAABBTreeCollisionManager(
                self._robot.model, self.geometry, self.data
            )
        self.broad_phase = self._broad[rules]

    def _margins(self, rules: Rules) -> Array:
        if rules not in self._tables:
            self._tables[rules] = margins(self.bodies, self._own, rules)
        return self._tables[rules]

    def clear(self, data: pin.Data, q: Array) -> bool:
        """Nothing nearer than its margin at q of the robot's model."""
        return not pin.computeCollisions(self._robot.model, data, self.broad_phase, q, True)

    def touching(self, data: pin.Data, q: Array) -> list[tuple[int, int]]:
        """Pairs of bodies that are too near, without the broad phase: it keeps no names."""
        pin.updateGeometryPlacements(self._robot.model, data, self.geometry, self.data, q)
        placed = zip(self.data.oMg, self._balls, strict=True)
        centres = np.array([X_WG.act(centre) for X_WG, (centre, _) in placed])
        radii = np.array([radius for _, radius in self._balls])
        offsets = centres[:, None] - centres
        gaps = np.sqrt(np.einsum("ijk,ijk->ij", offsets, offsets)) - radii[:, None] - radii
        # Pairs that are not checked have no margin, and nothing is less than NaN.
        near = gaps < self._margins_in_force + _SLACK
        pairs = np.sort(self.geometry.collisionPairMapping[near]).tolist()
        found = [k for k in pairs if pin.computeCollision(self.geometry, self.data, k)]
        ends = [self.geometry.collisionPairs[k] for k in found]
        return [(pair.first, pair.second) for pair in ends]


# ---- the checker ---------------------------------------------------------------------------------


class CollisionChecker:
    """The robot, what stands around it and what it carries.

    Never checked: neighbours in the chain, the parts of one hand among themselves, static parts
    with one another, pairs too far apart to meet in any posture, and pairs of the robot's own
    shapes that touch at home or in the bent posture (hulls of concave links overlap at their
    joints).
    """

    def __init__(self, embodiment: Embodiment) -> None:
        """
        Args:
            embodiment: its URDF has `<collision>` primitives or meshes (stl, obj, dae, glb).

        Raises:
            BadFile, UnknownName: see `RobotShapes.of`.
        """
        self._robot = robot = RobotShapes.of(embodiment)
        left, right = embodiment.limbs
        self._open = left.hand.finger_open, right.hand.finger_open
        self._q = pin.neutral(robot.model)
        self._fingers: tuple[float, float] | None = None  # as they are in it
        self._data = robot.model.createData()
        self._hulls: dict[tuple, coal.CollisionGeometry] = {}
        self._models: dict[tuple, PairModel] = {}  # by the kinds of items, latest last
        self._own = own_margins(robot)
        self.reset()
        self._model = model = PairModel(robot, self._own, [])
        at_rest: set[tuple[int, int]] = set()
        for postures in ((left.home, right.home), (left.bent, right.bent)):
            for fingers in ((0.0, 0.0), self._open):
                self._asked(*postures, fingers)
                at_rest.update(model.touching(self._data, self._q))
        for pair in at_rest:
            self._own[pair] = np.nan
        self._model = None

    def reset(self) -> None:
        """Forget everything but the robot, for a new episode."""
        self._obstacles: list[Shape] = []
        self._carried: list[Shape] = []
        self._hulls.clear()  # scaled objects differ in every episode: it would grow for ever
        self.rules = Rules()
        self._model: PairModel | None = None  # None when items have changed since

    def set_obstacles(self, obstacles: Sequence[Obstacle]) -> None:
        """Replace all obstacles. Those with the name of a carried body are left out."""
        carried = {item.name for item in self._carried}
        self._obstacles = []
        # The parts of a body share its pose.
        pose, X_WO = None, pin.SE3.Identity()
        for obstacle in obstacles:
            if obstacle.name in carried:
                continue
            if obstacle.pose is not pose:
                pose = obstacle.pose
                X_WO = pin.SE3(pose.R, pose.p)
            shape = self._shape(obstacle.vertices)
            self._obstacles.append(Shape(obstacle.name, OBSTACLE, 0, shape, X_WO))
        self._model = None

    def attach(self, side: str, name: str, vertices: Array) -> None:
        """Let a hand carry a convex body; call again with the same name for further parts.

        The obstacle of the same name is dropped; after `detach` call `set_obstacles` to say where
        the body is now.

        Args:
            vertices: (n, 3) hull points in the end-effector frame [m].
        """
        joint, X_JE = self._robot.wrists[side]
        shape = self._shape(vertices)
        self._carried.append(Shape(name, side, joint, shape, X_JE, hand=True, carried=True))
        self._obstacles = [o for o in self._obstacles if o.name != name]
        self._model = None

    def detach(self, side: str) -> None:
        """Forget what a hand carries."""
        self._carried = [item for item in self._carried if item.owner != side]
        self._model = None

    @contextmanager
    def under(self, rules: Rules) -> Iterator[None]:
        """Within: other rules are in force."""
        before, self.rules = self.rules, rules
        try:
            yield
        finally:
            self.rules = before

    def ignoring(self, *pairs: tuple[str, str]) -> AbstractContextManager[None]:
        """Within: the fingers and the load of a pair's hand may touch the body.

        Bodies that the checker does not know are passed over: a mark has no collision shape.
        """
        known = {item.name for item in (*self._obstacles, *self._carried)}
        ignored = self.rules.ignored.union(pair for pair in pairs if pair[1] in known)
        return self.under(self.rules._replace(ignored=ignored))

    def clear(
        self, q_left: Array, q_right: Array, fingers: tuple[float, float] | None = None
    ) -> bool:
        """True when nothing is nearer than its margin.

        Args:
            q_left: (n,) [rad].
            q_right: (n,) [rad].
            fingers: position of each finger of the left and of the right hand [m], 0 closed;
                the opening between them is twice that. Clamped to the joint's range. None: both
                hands are open.
        """
        return self._asked(q_left, q_right, fingers).clear(self._data, self._q)

    def contacts(
        self, q_left: Array, q_right: Array, fingers: tuple[float, float] | None = None
    ) -> frozenset[str]:
        """All pairs nearer than their margins, each as "fl_link4 and table"; see `clear`."""
        model = self._asked(q_left, q_right, fingers)
        names = [body.name for body in model.bodies]
        touching = model.touching(self._data, self._q)
        return frozenset(f"{names[i]} and {names[j]}" for i, j in touching)

    def _asked(
        self, q_left: Array, q_right: Array, fingers: tuple[float, float] | None
    ) -> PairModel:
        """The model of the bodies that there are, under the rules in force, at these postures."""
        robot, q = self._robot, self._q
        fingers = fingers or self._open
        q[robot.arm_index["left"]], q[robot.arm_index["right"]] = q_left, q_right
        if fingers != self._fingers:
            self._fingers = fingers
            for side, finger in zip(SIDES, fingers, strict=True):
                low, high = robot.finger_limits[side]
                opened = finger * robot.finger_signs[side]
                q[robot.finger_index[side]] = np.minimum(np.maximum(opened, low), high)
        if self._model is None:
            items = [*self._obstacles, *self._carried]
            # Two items of one kind differ by their placement and dimensions alone. A body that was
            # set down is an obstacle again: most sets of bodies come back.
            kinds = tuple((i.name, i.owner, i.joint, type(i.geometry)) for i in items)
            model = self._models.pop(kinds, None)
            if model is None:
                model = PairModel(robot, self._own, items)
            else:
                model.put(items)
            model.enforce(self.rules)
            self._models[kinds] = self._model = model
            while (
                len(self._models) > 1 and sum(m.pairs for m in self._models.values()) > _KEPT_PAIRS
            ):
                del self._models[next(iter(self._models))]
        self._model.enforce(self.rules)
        return self._model

    def _shape(self, vertices: Array) -> coal.CollisionGeometry:
        points = np.asarray(vertices, float)
        key = (points.shape, points.tobytes())
        if len(self._hulls) > _KEPT_HULLS:
            self._hulls.clear()
        if key not in self._hulls:
            self._hulls[key] = coal.Box(*(2 * points)) if points.ndim == 1 else hull(points)
        return self._hulls[key]
