"""What happened in an episode on which an attribute acts that otherwise changes not one bit."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from rtphys.core.poses import Array, quat_to_matrix
from rtphys.physics.handles import Happened
from rtphys.sim.contacts import Body, presses
from rtphys.sim.engine import FLOATS, TIME_STEP
from rtphys.sim.world import World

# [m/s] Things bounce from BOUNCE_THRESHOLD on. Here speeds are estimated from poses, and gravity
# adds 0.04 in the step of the impact: a hammer bounced at 0.138, a finger on a block at 0.128. So
# what is softer than this hardly ever bounced; what is harder need not have (a bell at 0.16).
HARD = 0.11
# [m] What is hit at HARD changes its speed by more than 0.041 m/s in a step, what falls by 0.04.
LIMIT = 0.041 * TIME_STEP
# Weights of a quaternion's and a position's changes: a turn counts by what it moves at 10 cm.
WEIGHTS = np.array([0.2, 0.2, 0.2, 0.2, 1.0, 1.0, 1.0], np.float32)
STILL = 1e-4  # [rad or m] by which a joint may be off its start that has not moved


class HappenedMonitor:
    """Called after every step. Looks at contacts until the first hard impact is found."""

    def __init__(self, world: World) -> None:
        self._world, self._pack = world, world.scene.pack_poses
        rows = {entity.per_scene_id: row for row, entity in enumerate(world.scene.entities)}
        things = [c for o in world.scene_objects.values() for c in o.links.values()]
        # Keyed by the component itself: held here, it is the same object in every contact.
        bodies = (*things, *world.robot.articulation.links)
        self._rows: dict[Body, int] = {
            body: rows.get(body.entity.per_scene_id, -1) for body in bodies
        }
        self._arms = np.concatenate([arm.index for arm in world.robot.arms])
        self._fingers = np.concatenate([arm.finger_index for arm in world.robot.arms])
        articulated = [o for o in world.objects.values() if o.articulation]
        self._objects = [o.articulation for o in articulated if o.articulation]
        # What moved while the world settled, which nobody watched, counts as well.
        self._start = [*self._joints()[:2], *(o.start for o in articulated)]
        self._poses = self._packed()
        self._change = np.zeros_like(self._poses)  # by the last step
        self.happened = Happened()  # so far

    def tick(self, frame: bool) -> None:
        """After a physics step; at a frame joints are looked at, too."""
        so_far = self.happened
        if frame:
            pairs = zip(self._joints(), self._start, strict=True)
            arms, fingers, *objects = (bool(np.abs(q - start).max() > STILL) for q, start in pairs)
            so_far.arms |= arms
            so_far.fingers |= fingers
            so_far.object_joints |= any(objects)
        if so_far.impact:
            return
        poses = self._packed()
        change = poses - self._poses
        jolt = (change - self._change).ravel()
        # The sum of squares is the cheaper question: none is larger than its root.
        if jolt @ jolt > LIMIT**2 and np.abs(jolt.reshape(-1, FLOATS) * WEIGHTS).max() > LIMIT:
            so_far.impact = self._impact()
        self._poses, self._change = poses, change

    def _packed(self) -> NDArray[np.float32]:
        """(n, 7) wxyz + xyz [m] of every body."""
        return np.frombuffer(self._pack(), np.float32).reshape(-1, FLOATS)

    def _joints(self) -> Sequence[Array]:
        qpos = self._world.robot.articulation.qpos
        found = qpos[self._arms], qpos[self._fingers], *(art.qpos for art in self._objects)
        return [np.asarray(q, float) for q in found]

    def _impact(self) -> bool:
        """Whether two bodies that press on each other met at more than HARD.

        The solver judged them by the velocities with which the step began.
        """
        now = self._poses.astype(float)
        before = now - self._change.astype(float)
        for contact in self._world.solver.get_contacts():
            rows = [self._rows.get(body, -1) for body in contact.bodies]
            for point in filter(presses, contact.points):
                place = np.asarray(point.position, float)
                first, second = (_way(before, now, row, place) for row in rows)
                if abs(float((first - second) @ point.normal)) > HARD * TIME_STEP:
                    return True
        return False


def _way(before: Array, now: Array, row: int, place: Array) -> Array:
    """By how much a point (3,) that now is at `place` moved with a body; -1: it stands still."""
    if row < 0:
        return np.zeros(3)
    q, p = before[row, :4], before[row, 4:]
    local = quat_to_matrix(now[row, :4]).T @ (place - now[row, 4:])
    return place - (p + quat_to_matrix(q) @ local)
