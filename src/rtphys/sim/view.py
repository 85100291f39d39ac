"""The measured scene that scripts and success conditions see (`rtphys.task.scene.Scene`)."""

from typing import NamedTuple

import numpy as np

from rtphys.core.errors import UnknownName
from rtphys.core.poses import Array, Pose
from rtphys.physics.values import Physics
from rtphys.sim.contacts import Contacts
from rtphys.sim.engine import TIME_STEP
from rtphys.sim.objects import Point
from rtphys.sim.world import World


class _Seen(NamedTuple):
    """A body as it was last looked at."""

    step: int
    bits: bytes  # of its pose in the world
    X_TB: Pose


class SceneView:
    """Task-frame measurements of a running world; remembers starts, latches and peaks."""

    def __init__(self, world: World, physics: Physics) -> None:
        self.world, self.physics = world, physics
        self.contacts = Contacts(world)
        self._X_TW = world.X_WT.inverse()
        self._first_step = world.steps
        self._latched: set[str] = set()
        self._peaks: dict[str, float] = {}
        self._poses: dict[tuple[str, str], _Seen] = {}
        self._start = {name: self.pose(name) for name in world.objects}

    @property
    def time(self) -> float:
        return (self.world.steps - self._first_step) * TIME_STEP

    # ---- objects -------------------------------------------------------------------------------

    def pose(self, prop: str, link: str = "") -> Pose:
        key = (prop, link)
        known = self._poses.get(key)
        if known and known.step == self.world.steps:
            return known.X_TB
        scene_object = self.world.object(prop)
        if link and link not in scene_object.links:
            raise UnknownName(f"link of {prop}", link, scene_object.links)
        X_WB = (scene_object.links[link] if link else scene_object.root).entity_pose
        p, q = X_WB.p, X_WB.q
        bits = p.tobytes() + q.tobytes()
        # Most objects lie still at most steps, to the last bit: their pose is not made anew.
        if known and known.bits == bits:
            X_TB = known.X_TB
        else:
            X_TB = self._X_TW.compose(p.tolist(), q.tolist())
        self._poses[key] = _Seen(self.world.steps, bits, X_TB)
        return X_TB

    def start(self, prop: str) -> Pose:
        self.world.object(prop)
        return self._start[prop]

    def functional(self, prop: str, index: int = 0) -> Pose:
        return self._X_TW @ self._point(prop, "functional", index).pose

    def contact(self, prop: str, index: int = 0) -> Pose:
        return self._X_TW @ self._point(prop, "contact", index).pose

    def _point(self, prop: str, kind: str, index: int) -> Point:
        points: list[Point] = getattr(self.world.object(prop), f"{kind}_points")
        if not 0 <= index < len(points):
            known = map(str, range(len(points)))
            raise UnknownName(f"{kind} point of {prop}", str(index), known)
        return points[index]

    def speed(self, prop: str) -> float:
        bodies = self.world.object(prop).bodies
        return max(
            (float(np.linalg.norm(b.component.linear_velocity)) for b in bodies), default=0.0
        )

    def lowest(self, prop: str) -> float:
        return float((self._X_TW @ self.world.object(prop).points())[:, 2].min())

    def joint(self, prop: str, index: int = 0) -> tuple[float, float, float]:
        art = self.world.object(prop).articulation
        if art is None:
            raise UnknownName("articulated prop", prop, [])
        low, high = art.qlimits[index]
        return float(art.qpos[index]), float(low), float(high)

    # ---- robot and contact -----------------------------------------------------------------------

    def opening(self, side: str) -> float:
        return self.world.robot.arm(side).opening()

    def tcp(self, side: str) -> Pose:
        return self._X_TW @ self.world.robot.arm(side).tcp()

    def touching(self, a: str, b: str) -> bool:
        return self.contacts.pressing(a, b)

    def contact_points(self, a: str, b: str) -> Array:
        touch = self.contacts.between(a, b)
        return self._X_TW @ touch.points if touch else np.empty((0, 3))

    def impulse(self, a: str, b: str) -> float:
        """Sum of contact impulse magnitudes between the two in this step [N s]."""
        touch = self.contacts.between(a, b)
        return touch.impulse if touch else 0.0

    # ---- memory ----------------------------------------------------------------------------------

    def once(self, name: str, now: bool) -> bool:
        if now:
            self._latched.add(name)
        return name in self._latched

    def peak(self, name: str, now: float) -> float:
        self._peaks[name] = max(now, self._peaks.get(name, -np.inf))
        return self._peaks[name]
