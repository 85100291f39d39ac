"""The collision pairs of one set of bodies, which the checker keeps to use again."""

from collections.abc import Sequence
from dataclasses import dataclass

import coal  # pyright: ignore[reportMissingImports]  (lives behind a .pth file)
import numpy as np
import pinocchio as pin  # pyright: ignore[reportMissingImports]

from rtphys.core.poses import Array
from rtphys.plan.pairs import Body, Rules, margins, robot_bodies
from rtphys.plan.robot_shapes import RobotShapes, bounding_sphere

_SLACK = 1e-4  # [m] more than any rounding


@dataclass(frozen=True, eq=False)
class Item:
    """A body that is not the robot's, as the geometry model wants it."""

    body: Body
    joint: int
    placement: pin.SE3
    geometry: coal.CollisionGeometry

    @property
    def kind(self) -> tuple[Body, int, type]:
        """Equal for two items that differ by their placement and dimensions alone."""
        return self.body, self.joint, type(self.geometry)


class PairModel:
    """A geometry model of the robot and some items, with margins by rules.

    Making one takes milliseconds where there are thousands of pairs. Moving or resizing its items,
    and saying under which rules it is asked, takes a tenth of that.
    """

    def __init__(self, robot: RobotShapes, own_margins: Array, items: Sequence[Item]) -> None:
        """
        Args:
            own_margins: of the robot's own shapes, see `rtphys.plan.pairs.own_margins`.
        """
        self._robot, self._own_margins = robot, own_margins
        self._items = list(items)
        own = robot_bodies(robot)
        self.bodies = [*own, *(item.body for item in items)]
        self.geometry = pin.GeometryModel()
        for i, shape in enumerate((*robot.shapes, *items)):
            self.geometry.addGeometryObject(
                pin.GeometryObject(str(i), shape.joint, shape.placement, shape.geometry)
            )
        self._balls = [bounding_sphere(shape.geometry) for shape in (*robot.shapes, *items)]
        self._tables: dict[object, Array] = {}  # margins under rules seen
        self.geometry.setCollisionPairs(np.isfinite(self._margins(Rules())), True)
        self.data = pin.GeometryData(self.geometry)
        self._in_force: object = None
        self._margins_in_force = np.empty((0, 0))

    def __len__(self) -> int:
        """How many pairs there are."""
        return len(self.geometry.collisionPairs)

    def put(self, items: Sequence[Item]) -> None:
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
                self._in_force = None  # the broad phase keeps shapes
        self._items = list(items)

    def enforce(self, rules: Rules) -> None:
        """Ask by these rules from now on."""
        key = frozenset(rules.ignored), rules.carried_margin
        if key == self._in_force:
            return
        distances = self._margins(rules)
        self.data.setActiveCollisionPairs(self.geometry, np.isfinite(distances), True)
        self.data.setSecurityMargins(self.geometry, np.nan_to_num(distances), True, True)
        # Of the broad phases this one alone agreed with the full loop on every posture tried.
        # It is made anew because it inflates its boxes by the margins once and for all.
        self.broad_phase = pin.BroadPhaseManager_DynamicAABBTreeCollisionManager(
            self._robot.model, self.geometry, self.data
        )
        self._in_force, self._margins_in_force = key, distances

    def _margins(self, rules: Rules) -> Array:
        key = frozenset(rules.ignored), rules.carried_margin
        if key not in self._tables:
            self._tables[key] = margins(self.bodies, self._own_margins, rules)
        return self._tables[key]

    def clear(self, data: pin.Data, q: Array) -> bool:
        """Nothing nearer than its margin at q of the robot's model."""
        return not pin.computeCollisions(self._robot.model, data, self.broad_phase, q, True)

    def touching(self, data: pin.Data, q: Array) -> list[int]:
        """Indices of the pairs that are too near, without the broad phase: it keeps no names."""
        pin.updateGeometryPlacements(self._robot.model, data, self.geometry, self.data, q)
        return [k for k in self._near() if pin.computeCollision(self.geometry, self.data, k)]

    def _near(self) -> list[int]:
        """Indices of the pairs whose bounding spheres are too near, where all bodies are now."""
        placed = zip(self.data.oMg, self._balls, strict=True)
        centres = np.array([X_WG.act(centre) for X_WG, (centre, _) in placed])
        radii = np.array([radius for _, radius in self._balls])
        offsets = centres[:, None] - centres
        gaps = np.sqrt(np.einsum("ijk,ijk->ij", offsets, offsets)) - radii[:, None] - radii
        # Pairs that are not checked have no margin, and nothing is less than NaN.
        near = gaps < self._margins_in_force + _SLACK
        return np.sort(self.geometry.collisionPairMapping[near]).tolist()

    def pair(self, k: int) -> tuple[int, int]:
        """The two bodies of a pair."""
        pair = self.geometry.collisionPairs[k]
        return pair.first, pair.second

    def names(self, k: int) -> str:
        """A pair as "fl_link4 and table"."""
        first, second = self.pair(k)
        return f"{self.bodies[first].name} and {self.bodies[second].name}"
