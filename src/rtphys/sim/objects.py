"""Task objects and clutter in the simulator: built from props, grasped and used at their points."""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import sapien
from sapien import physx

from rtphys.assets.model import Model
from rtphys.assets.pack import Pack
from rtphys.core.errors import BadFile
from rtphys.core.poses import Array, Pose, axis_angle, quat_multiply
from rtphys.sim.body import (
    MassProperties,
    SimBody,
    SimJoint,
    SimSurface,
    body_points,
    of_shapes,
    own_shapes,
    shape_points,
    shape_size,
)
from rtphys.sim.engine import AnyBody, from_sapien, renders, to_sapien
from rtphys.sim.feet import add_feet, feel_feet
from rtphys.sim.urdf import build_articulation, nominal_shape_size
from rtphys.task.props import TABLE_TOP, Articulated, Ball, Box, Mesh, Prop

MIN_OFFSET = 0.001  # [m] of a centre of mass from the axis, for it to decide how an object lies


@dataclass(frozen=True, eq=False)
class Point:
    """A contact or functional point: the body that carries it and its frame there."""

    component: AnyBody
    X_BP: Pose

    @property
    def pose(self) -> Pose:
        """World pose now."""
        return from_sapien(self.component.entity_pose) @ self.X_BP


@dataclass(eq=False)
class SceneObject:
    """A task object or a piece of clutter. `root` is the body whose frame is the object's frame."""

    prop: Prop
    root: AnyBody
    links: dict[str, AnyBody]
    contact_points: list[Point] = field(default_factory=list)
    functional_points: list[Point] = field(default_factory=list)
    bodies: list[SimBody] = field(default_factory=list)  # dynamic, non-root if articulated
    joints: list[SimJoint] = field(default_factory=list)
    surfaces: list[SimSurface] = field(default_factory=list)
    articulation: physx.PhysxArticulation | None = None
    start: Array = field(default_factory=lambda: np.zeros(0))  # joint positions as it was built
    nominal_size: float = 1.0  # what `shape_size` says of one shape at scale 1
    scaled: bool = True

    @property
    def name(self) -> str:
        return self.prop.name

    @property
    def pose(self) -> Pose:
        """World pose of the object's frame."""
        return from_sapien(self.root.entity_pose)

    @cached_property
    def parts(self) -> dict[str, list[Array]]:
        """Link name -> vertices (n, 3) of each convex part but the feet, link frame [m]."""
        return {
            name: [shape_points(shape) for shape in own_shapes(body)]
            for name, body in self.links.items()
        }

    def link_pose(self, link: str) -> Pose:
        """World pose of a link ("" for a rigid object)."""
        return from_sapien(self.links[link].entity_pose)

    def measured_scale(self) -> float:
        """Size of the simulator's shapes over the nominal size."""
        last = [c for c in self.links.values() if c.collision_shapes][-1]
        return shape_size(last.collision_shapes[0]) / self.nominal_size

    def roll_down(self) -> None:
        """Turn a round object that lies until its centre of mass is underneath (`rolls_about`)."""
        axis, pose = self.prop.rolling_axis, self.pose
        if axis is None or isinstance(self.root, physx.PhysxRigidStaticComponent):
            return
        u = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
        u /= np.linalg.norm(u)
        frame = np.array([u, np.cross(axis, u)])
        flat = body_points(self.root) @ frame.T
        on_axis = (flat.min(axis=0) + flat.max(axis=0)) / 2 @ frame
        across = np.eye(3) - np.outer(axis, axis)
        middle = across @ on_axis
        centre = across @ np.asarray(self.root.cmass_local_pose.p, float) - middle
        down = across @ pose.R.T @ np.array([0.0, 0.0, -1.0])
        if np.linalg.norm(centre) < MIN_OFFSET:
            return
        angle = float(np.arctan2(np.cross(centre, down) @ axis, centre @ down))
        turn = Pose((0, 0, 0), axis_angle(axis, angle))
        about = Pose(middle - turn.R @ middle, turn.q)
        self.root.entity.set_pose(to_sapien(pose @ about))

    def points(self) -> Array:
        """Collision vertices of all links, world frame (n, 3) [m]."""
        parts = [from_sapien(c.entity_pose) @ vertices for c, vertices in self._vertices]
        return np.vstack(parts)

    @cached_property
    def _vertices(self) -> list[tuple[AnyBody, Array]]:
        """Each link's collision vertices (n, 3), its own frame [m]: shapes are final once built."""
        return [(c, body_points(c)) for c in self.links.values()]


def box_points(prop: Box, scale: float) -> tuple[list[Pose], list[Pose]]:
    """Contact and functional points of a box, in its frame (RoboTwin's fact sheet, section 1.4)."""
    hz = prop.half_size[2] * scale
    down = (0.0, 1.0, 0.0, 0.0)
    functional = [Pose((0, 0, -hz), down), Pose((0, 0, hz), down)]
    # Contact frame for a top-down approach: +y (outward) is the box's z, x is camera-up.
    upward = Pose.from_matrix(np.array([[0, 0, 1], [1, 0, 0], [0, 1, 0]], float)).q
    if not prop.upright_grasps:
        turns = [axis_angle((0, 0, 1), k * np.pi / 2) for k in range(4)]
        return [Pose((0, 0, 0), quat_multiply(t, upward)) for t in turns], functional
    # Horizontal: +y outward along box x, x (camera-up) along box z.
    sideways = Pose.from_matrix(np.array([[0, 1, 0], [0, 0, 1], [1, 0, 0]], float)).q
    contacts = [
        Pose((0, 0, level * hz), quat_multiply(axis_angle((0, 0, 1), k * np.pi / 2), sideways))
        for level in (0.7, -0.7)
        for k in range(4)
    ]
    return contacts, functional


# ---- building ------------------------------------------------------------------------------------

UNSTATED_DENSITY = 400.0  # [kg/m^3] for models whose pack states no mass (the official one)
# [m] from what `catches`: a step at 3.7 m/s. With the scenes' own CONTACT_OFFSET what falls into it
# would be up to 17 mm deep in its floor for a step. It widens faces, so nothing is balanced there.
FORESEEN = 0.015
SPAWN_GAP = 0.001  # [m] above the table, of what may move


class ObjectFactory:
    """Builds props into a scene, `scale` times their nominal size, in a task frame."""

    def __init__(self, scene: sapien.Scene, pack: Pack, X_WT: Pose, scale: float) -> None:
        self.scene, self.pack, self.X_WT, self.scale = scene, pack, X_WT, scale

    def build(self, prop: Prop) -> SceneObject:
        """Build one prop at its pose.

        Raises:
            MissingAsset, UnknownName, BadFile: from the pack.
        """
        built = self._articulated(prop) if isinstance(prop, Articulated) else self._rigid(prop)
        if prop.on_table:  # nothing stands in a bin on the ground
            for link in built.links.values():
                feel_feet(link.collision_shapes)
        solid = {name: c for name, c in built.links.items() if c.collision_shapes}
        up = self.X_WT.R[:, 2]
        may_roll = isinstance(prop, Ball) or prop.rolling_axis is not None
        if solid and prop.resting and not prop.fixed and not may_roll:

            def lowest(body: AnyBody) -> float:
                return float(((from_sapien(body.entity_pose) @ body_points(body)) @ up).min())

            add_feet(min(solid.values(), key=lowest), up)
        built.surfaces = [
            SimSurface(
                f"{prop.name}/{name}" if len(built.links) > 1 else prop.name, c.collision_shapes
            )
            for name, c in solid.items()
        ]
        if prop.catches:
            for surface in built.surfaces:
                for shape in surface.shapes:
                    shape.set_contact_offset(FORESEEN)
        if solid and prop.resting and prop.on_table:
            # Along the table normal: fixed ones stand on it, others 1 mm above.
            height = (self.X_WT.inverse() @ built.points())[:, 2].min()
            gap = 0.0 if prop.fixed else SPAWN_GAP
            moved = to_sapien(built.pose.moved(up * (TABLE_TOP + gap - height)))
            if built.articulation is not None:
                built.articulation.set_root_pose(moved)
            else:
                built.root.entity.set_pose(moved)
        return built

    def _pose(self, prop: Prop) -> Pose:
        """World pose, before it is set down."""
        pose = self.X_WT @ prop.pose if prop.on_table else prop.pose
        if not any(prop.anchor):
            return pose
        return pose @ Pose(np.array(prop.anchor) * (1.0 - self.scale))

    def _rigid(self, prop: Prop) -> SceneObject:
        model = self.pack.model(prop.category, prop.model) if isinstance(prop, Mesh) else None
        scale = 1.0 if isinstance(prop, Box) and prop.visual_only else self.scale
        builder, visuals = self.scene.create_actor_builder(), renders(self.scene)
        contacts: list[Pose] = []
        functional: list[Pose] = []
        nominal_size = 1.0  # `shape_size` of the first shape, from the prop or the asset alone
        if isinstance(prop, Box):
            x, y, z = (h * scale for h in prop.half_size)
            if not prop.visual_only:
                builder.add_box_collision(half_size=(x, y, z), density=prop.density)
            if visuals:
                builder.add_box_visual(half_size=(x, y, z), material=_paint(prop.colour))
            nominal_size = float(np.linalg.norm(prop.half_size))
            contacts, functional = box_points(prop, scale)
        elif isinstance(prop, Ball):
            builder.add_sphere_collision(radius=prop.radius * scale, density=prop.density)
            if visuals:
                builder.add_sphere_visual(radius=prop.radius * scale, material=_paint(prop.colour))
            nominal_size = prop.radius
        elif model is not None:
            size = (model.scale * scale).tolist()
            density = model.density or UNSTATED_DENSITY
            builder.add_multiple_convex_collisions_from_file(
                str(model.collision), scale=size, density=density
            )
            if visuals:
                builder.add_visual_from_file(str(model.visual), scale=size)
            nominal_size = float(np.linalg.norm(model.scale))
            contacts = [_scaled(m, scale) for m in model.contact_points]
            functional = [_scaled(m, scale) for m in model.functional_points]
        builder.initial_pose = to_sapien(self._pose(prop))
        entity = builder.build_static(prop.name) if prop.fixed else builder.build(prop.name)
        kind = physx.PhysxRigidStaticComponent if prop.fixed else physx.PhysxRigidDynamicComponent
        component = entity.find_component_by_type(kind)
        assert isinstance(component, kind)
        if model is not None and not component.collision_shapes:
            # SAPIEN's builder swallows meshes it cannot cook and goes on without them.
            raise BadFile(model.collision, "PhysX could not cook any of its convex parts")
        built = SceneObject(
            prop,
            component,
            {"": component},
            [Point(component, X) for X in contacts],
            [Point(component, X) for X in functional],
            nominal_size=nominal_size,
            scaled=bool(component.collision_shapes),
        )
        if isinstance(component, physx.PhysxRigidDynamicComponent):
            if component.collision_shapes:  # a mere mark weighs what SAPIEN gives it
                _mass_properties(component, prop, model, scale).give(component)
            # SAPIEN's default of 0.05 would slow every spin by 5 %/s.
            component.set_angular_damping(prop.spin_decay if isinstance(prop, Ball) else 0.0)
            built.bodies = [SimBody(prop.name, component)]
        return built

    def _articulated(self, prop: Articulated) -> SceneObject:
        asset = self.pack.articulation(prop.category, prop.model)
        offset = Pose.from_matrix(asset.root_offset)
        # The metadata's offset lifts the root so that the object stands on its origin's height.
        pose = self._pose(prop.at(prop.pose.moved(offset.p * self.scale)))
        scale = asset.scale * self.scale
        art = build_articulation(self.scene, asset.urdf, pose, scale, fixed=prop.fixed)
        art.set_name(prop.name)
        joints = [
            SimJoint(f"{prop.name}/{j.name}", j, asset.joint_damping) for j in art.active_joints
        ]
        qpos = np.array(art.qpos, float)
        if len(asset.init_qpos) == len(qpos):
            qpos[:] = asset.init_qpos
        if len(qpos) and prop.opening:
            low, high = art.qlimits[0]
            qpos[0] = low + prop.opening * (high - low)
        art.set_qpos(qpos.astype(np.float32))
        moving = [link for link in art.links if not (link.is_root and prop.fixed)]
        for link in moving:
            # SAPIEN's default link damping of 0.05 would add 5 %/s to every labelled decay.
            link.set_linear_damping(0.0)
            link.set_angular_damping(0.0)
            # A spring carries it (a laptop's lid stays where it is put).
            link.set_disable_gravity(link.name in asset.balanced_links)
            if link.auto_compute_mass and link.collision_shapes:  # the URDF states none
                of_shapes(link.collision_shapes).give(link)
        solid = [link for link in moving if link.collision_shapes]  # a root may be a mere frame
        links = {link.name: link for link in art.links}
        contacts, functional = (
            [Point(links[p.link], _scaled(p.matrix, self.scale)) for p in points]
            for points in (asset.contact_points, asset.functional_points)
        )
        return SceneObject(
            prop,
            art.root,
            dict(links),
            contacts,
            functional,
            [SimBody(f"{prop.name}/{link.name}", link) for link in solid],
            joints,
            articulation=art,
            start=qpos,
            nominal_size=nominal_shape_size(asset.urdf, asset.scale),
        )


def _paint(colour: tuple[float, float, float]) -> sapien.render.RenderMaterial:
    paint = sapien.render.RenderMaterial(base_color=[*colour, 1])
    paint.roughness = 0.6
    return paint


def _scaled(matrix: Array, scale: float) -> Pose:
    X = Pose.from_matrix(matrix)
    return Pose(X.p * scale, X.q)


def _mass_properties(
    component: physx.PhysxRigidDynamicComponent, prop: Prop, model: Model | None, scale: float
) -> MassProperties:
    """Of a built rigid body: what its pack states, else what its shapes weigh.

    A pack states what follows from the visible solids and their materials: convex parts of one
    density are off by up to a factor of two for things whose parts differ (a hammer's head and
    handle).
    """
    if model is None or model.mass_kg is None:
        own = of_shapes(component.collision_shapes)
    elif model.inertia is None or model.center_of_mass is None:
        own = of_shapes(component.collision_shapes).weighing(model.mass_kg * scale**3)
    else:
        stated = MassProperties(model.mass_kg, model.center_of_mass, model.inertia)
        own = stated.scaled(scale)
    return own if prop.mass_kg is None else own.weighing(prop.mass_kg * scale**3)
