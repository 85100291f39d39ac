"""The measured scene that scripts and success conditions see (`rtphys.task.scene.Scene`)."""

from collections.abc import Callable, Iterable
from copy import copy
from functools import cache
from typing import TypeVar

import numpy as np
from sapien import physx

from rtphys.core.errors import UnknownName
from rtphys.core.poses import Array, Pose
from rtphys.physics.values import Physics
from rtphys.sim.contacts import Contacts
from rtphys.sim.engine import TIME_STEP, AnyBody
from rtphys.sim.motion import rows_of
from rtphys.sim.world import World

T = TypeVar("T")


class PosesNow:
    """The packed poses of a running world, read at most once a step."""

    def __init__(self, world: World) -> None:
        self._world, self._pack = world, world.scene.pack_poses
        self._step, self._packed = -1, b""

    def packed(self) -> bytes:
        """`scene.pack_poses()` of this step."""
        step = self._world.steps
        if self._step != step:
            self._step, self._packed = step, self._pack()
        return self._packed

    def follow(self, bodies: Iterable[AnyBody], work_out: Callable[[], T]) -> Callable[[], T]:
        """A value that follows from the poses of these bodies, and from nothing else.

        Most objects lie still at most steps, to the last bit: then it is the same object as before.
        """
        places = [self._world.rows.bytes_of(body) for body in bodies]
        asked, bits, value = b"", list[bytes](), list[T]()

        def now() -> T:
            nonlocal asked, bits
            packed = self.packed()
            if packed is not asked:  # else asked before in this step
                found = [packed[place] for place in places]
                if found != bits:
                    value[:] = [work_out()]
                    bits = found
                asked = packed
            return value[0]

        return now


class SceneView:
    """Task-frame measurements of a running world; remembers starts, latches and peaks."""

    def __init__(self, world: World, physics: Physics) -> None:
        self.world, self.physics = world, physics
        self.contacts = Contacts(world)
        self._X_TW = world.X_WT.inverse()
        self._first_step = world.steps
        self._latched: set[str] = set()
        self._peaks: dict[str, float] = {}
        self._packed = PosesNow(world)
        # Looked up once for each prop: they are asked at every step.
        self._pose_of, self._point_of = cache(self._follow_pose), cache(self._follow_point)
        self._lowest_of, self._limits_of = cache(self._follow_lowest), cache(self._limits)
        self._rows_of = cache(lambda prop: rows_of(world.object(prop).bodies, world.rows))
        self._start = {name: self.pose(name) for name in world.objects}

    def believing(self, physics: Physics) -> "SceneView":
        """The same view, for one who takes the physics in force to be other than it is."""
        other = copy(self)
        other.physics = physics
        return other

    @property
    def time(self) -> float:
        return (self.world.steps - self._first_step) * TIME_STEP

    # ---- objects -------------------------------------------------------------------------------

    def pose(self, prop: str, link: str = "") -> Pose:
        return self._pose_of(prop, link)()

    def _follow_pose(self, prop: str, link: str) -> Callable[[], Pose]:
        scene_object = self.world.object(prop)
        if link and link not in scene_object.links:
            raise UnknownName(f"link of {prop}", link, scene_object.links)
        body = scene_object.links[link] if link else scene_object.root

        def now() -> Pose:
            X_WB = body.entity_pose
            return self._X_TW.compose(X_WB.p.tolist(), X_WB.q.tolist())

        return self._packed.follow([body], now)

    def start(self, prop: str) -> Pose:
        self.world.object(prop)
        return self._start[prop]

    def functional(self, prop: str, index: int = 0) -> Pose:
        return self._point_of(prop, "functional", index)()

    def contact(self, prop: str, index: int = 0) -> Pose:
        return self._point_of(prop, "contact", index)()

    def _follow_point(self, prop: str, kind: str, index: int) -> Callable[[], Pose]:
        thing = self.world.object(prop)
        points = thing.contact_points if kind == "contact" else thing.functional_points
        if not 0 <= index < len(points):
            raise UnknownName(f"{kind} point of {prop}", str(index), map(str, range(len(points))))
        point = points[index]
        return self._packed.follow([point.component], lambda: self._X_TW @ point.pose)

    def speed(self, prop: str) -> float:
        speeds = self.world.speeds(self._rows_of(prop))
        return max((speed for speed, _ in speeds), default=0.0)

    def lowest(self, prop: str) -> float:
        return self._lowest_of(prop)()

    def _follow_lowest(self, prop: str) -> Callable[[], float]:
        thing = self.world.object(prop)
        return self._packed.follow(
            thing.links.values(), lambda: float((self._X_TW @ thing.points())[:, 2].min())
        )

    def on_top(self, prop: str) -> Pose:
        points = self._X_TW @ self.world.object(prop).points()
        low, high = points.min(axis=0), points.max(axis=0)
        return Pose([*(low + high)[:2] / 2, high[2]])

    def joint(self, prop: str, index: int = 0) -> tuple[float, float, float]:
        art = self.world.object(prop).articulation
        if art is None:
            raise UnknownName("articulated prop", prop, [])
        return art.qpos.item(index), *self._limits_of(art, index)

    @staticmethod
    def _limits(art: physx.PhysxArticulation, index: int) -> tuple[float, float]:
        low, high = art.qlimits[index]
        return float(low), float(high)

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
