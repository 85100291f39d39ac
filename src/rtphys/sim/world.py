"""One episode's world: room, robot, task objects, head camera, and the clock that steps them."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import sapien
from numpy.typing import NDArray
from sapien import physx

from rtphys.assets.embodiment import Embodiment
from rtphys.assets.pack import Pack
from rtphys.core.errors import Infeasible, UnknownName
from rtphys.core.poses import Pose
from rtphys.physics.handles import GRAVITY, Blueprint, Hook
from rtphys.sim.body import SimJoint, SimServo, SimSurface
from rtphys.sim.engine import RATE, PackedRows, new_scene
from rtphys.sim.motion import STRIDE, Past, Row, rows_of, speeds
from rtphys.sim.objects import ObjectFactory, SceneObject
from rtphys.sim.robot import SimRobot
from rtphys.sim.room import Room, TablePlan
from rtphys.task.props import TABLE_TOP, Ball, Prop


class HeadCamera:
    """The camera over the robot's head; physics may move it (`rtphys.physics.handles.Camera`)."""

    name = "head_camera"

    def __init__(self, embodiment: Embodiment) -> None:
        spec = next(c for c in embodiment.cameras if c.name == self.name)
        forward = spec.forward / np.linalg.norm(spec.forward)
        left = spec.left / np.linalg.norm(spec.left)
        axes = np.column_stack([forward, left, np.cross(forward, left)])
        X_WC = np.eye(4)
        X_WC[:3, :3], X_WC[:3, 3] = axes, spec.position
        self.pose = self.nominal_pose = Pose.from_matrix(X_WC)

    def set_pose(self, pose: Pose) -> None:
        self.pose = pose

    @property
    def range_to_table(self) -> float:
        """[m] along the optical axis from the nominal pose to the nominal table top."""
        down = -self.nominal_pose.R[2, 0]
        return float((self.nominal_pose.p[2] - TABLE_TOP) / down)


REST_SPEED = 0.01  # [m/s] and
REST_SPIN = 0.1  # [rad/s]: slower than this for REST_STEPS steps is at rest
REST_STEPS = 50
BALL_REST_SPEED = 0.015  # [m/s] likewise for a ball
SETTLE_LIMIT = 5 * RATE  # [steps]
NO_TORQUE = np.zeros(3, np.float32)  # [N m]


@dataclass(frozen=True)
class WorldPlan:
    """All that a world is built from. The same plan builds the same world, bit for bit."""

    pack: Pack
    props: tuple[Prop, ...]
    blueprint: Blueprint = field(default_factory=Blueprint)
    table: TablePlan = field(default_factory=TablePlan)
    embodiment: str = "aloha-agilex"
    clutter: tuple[Prop, ...] = ()  # physical, but not the task's: only friction and tilt reach it
    visuals: bool = False  # needs a Vulkan device; physics is the same without


class World:
    """The simulator of one episode (`rtphys.physics.handles.World`, and more)."""

    def __init__(self, plan: WorldPlan) -> None:
        self.plan, self.blueprint = plan, plan.blueprint
        self.scene: sapien.Scene = new_scene(plan.visuals)
        solver = self.scene.physx_system  # looked up once: it is asked at every step
        assert isinstance(solver, physx.PhysxCpuSystem)
        self.solver = solver
        self.room = Room(self.scene, plan.table, plan.blueprint)
        self.X_WT = self.room.X_WT
        self.robot = SimRobot(self.scene, plan.pack.embodiment(plan.embodiment))
        factory = ObjectFactory(self.scene, plan.pack, self.X_WT, plan.blueprint.object_scale)
        self.objects: dict[str, SceneObject] = {p.name: factory.build(p) for p in plan.props}
        # After the task's own, so that these are built alike with clutter and without.
        plain = ObjectFactory(self.scene, plan.pack, self.X_WT, 1.0)
        self.clutter: dict[str, SceneObject] = {p.name: plain.build(p) for p in plan.clutter}
        self.bodies = [b for o in self.objects.values() for b in o.bodies]
        self.rows = PackedRows(self.scene)
        things = self.scene_objects.values()
        self._floats = self.rows.floats_of(link for o in things for link in o.links.values())
        self.head_camera = HeadCamera(self.robot.embodiment)
        self.external_force = 0.0
        # Single precision, as SAPIEN wants it: lists cost twice as much, at every step.
        self._force = np.zeros(3, np.float32)  # [N]
        self.steps = 0  # since the world was built
        self._past = Past()
        self.policy_stage = False  # the external force acts only when true
        self.step_hooks: dict[str, tuple[Hook | None, Hook | None]] = {}  # before, after

    @property
    def scene_objects(self) -> dict[str, SceneObject]:
        """Task objects, then clutter."""
        return {**self.objects, **self.clutter}

    @property
    def surfaces(self) -> Sequence[SimSurface]:
        objects = [s for o in self.scene_objects.values() for s in o.surfaces]
        return [*objects, *self.table_and_pads]

    @property
    def table_and_pads(self) -> Sequence[SimSurface]:
        return [self.room.table_surface, *self.robot.pads]

    @property
    def scenery(self) -> Sequence[SimSurface]:
        return [*self.room.scenery, self.robot.body]

    @property
    def joints(self) -> Sequence[SimJoint]:
        return [j for o in self.objects.values() for j in o.joints]

    @property
    def arm_servos(self) -> Sequence[SimServo]:
        return [s for arm in self.robot.arms for s in arm.servos]

    @property
    def gripper_servos(self) -> Sequence[SimServo]:
        return [s for arm in self.robot.arms for s in arm.finger_servos]

    def measured_scale(self) -> dict[str, float]:
        return {o.name: o.measured_scale() for o in self.objects.values() if o.scaled}

    def measured_table(self) -> tuple[float, float]:
        return self.room.measured()

    def measured_force(self) -> dict[str, float]:
        return {b.name: self.external_force * b.mass * GRAVITY for b in self.bodies}

    def on_step(self, key: str, before: Hook | None = None, after: Hook | None = None) -> None:
        self.step_hooks[key] = (before, after)

    def step(self) -> None:
        """One physics step of 4 ms under the current commands."""
        if self.policy_stage and self.external_force:  # at the centres of mass, for one step
            force = self._force
            for body in self.bodies:
                force[0] = self.external_force * body.mass * GRAVITY
                body.component.add_force_torque(force, NO_TORQUE)  # pyright: ignore[reportArgumentType]
        for before, _ in self.step_hooks.values():
            if before is not None:
                before()
        self.solver.step()
        for _, after in self.step_hooks.values():
            if after is not None:
                after()
        self.steps += 1
        if self.steps % STRIDE == 0:
            self._past.keep(self.steps, self.scene.pack_poses())

    def speeds(self, rows: Sequence[Row]) -> list[tuple[float, float]]:
        """How fast bodies (`rows_of`) have moved [m/s] and turned [rad/s] in the last 20 ms.

        Between two looks it is more, up to 36 ms. All are at rest before the first step.
        """
        before = self._past.before(self.steps)
        if before is None:
            return [(0.0, 0.0)] * len(rows)
        now = self.steps, self.scene.pack_poses()
        return [speeds(row, before, now) for row in rows]

    def settle(self) -> None:
        """Step until every task body, and all clutter, is at rest.

        Raises:
            Infeasible: "unsettled", when one still moves after 5 s.
        """
        loose = [(b, _rest(o.prop)) for o in self.scene_objects.values() for b in o.bodies]
        if not loose:
            return
        rows, quiet, moving = rows_of([body for body, _ in loose], self.rows), 0, list[str]()
        self._past.keep(self.steps, self.scene.pack_poses())
        for _ in range(SETTLE_LIMIT // STRIDE):
            for _ in range(STRIDE):
                self.step()
            moving = [
                body.name
                for (body, rest), (speed, spin) in zip(loose, self.speeds(rows), strict=True)
                if speed >= rest[0] or spin >= rest[1]
            ]
            quiet = 0 if moving else quiet + STRIDE
            if quiet >= REST_STEPS:
                return
        raise Infeasible("unsettled", f"{', '.join(moving)} still moved after 5 s")

    def object(self, name: str) -> SceneObject:
        """A task object by its prop's name.

        Raises:
            UnknownName: with the nearest match.
        """
        try:
            return self.objects[name]
        except KeyError:
            raise UnknownName("prop", name, self.objects) from None

    def to_task(self, pose: Pose) -> Pose:
        """A world pose in the task frame."""
        return self.X_WT.inverse() @ pose

    def state(self) -> NDArray[np.float32]:
        """Joint positions, velocities, and poses of objects and clutter, for hashing."""
        art = self.robot.articulation
        poses = np.frombuffer(self.scene.pack_poses(), np.float32)
        return np.concatenate([art.qpos, art.qvel, poses[self._floats]])


def _rest(prop: Prop) -> tuple[float, float]:
    """Speeds [m/s], [rad/s] below which it counts as resting."""
    if not isinstance(prop, Ball):
        return REST_SPEED, REST_SPIN
    # A small ball that touches a wall turns on the spot without end, by PhysX's account: it has
    # 6 to 8 mm/s and 1.4 rad/s, and gets nowhere in ten seconds.
    return BALL_REST_SPEED, BALL_REST_SPEED / prop.radius
