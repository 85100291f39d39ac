"""Ground, table and wall: RoboTwin's room, with a table that may be lowered and tilted."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import sapien
from sapien import physx

from rtphys.assets.material import Picture
from rtphys.assets.surfaces import CANVAS, Place
from rtphys.assets.surfaces.canvas import Canvas
from rtphys.core.poses import Array, Pose, axis_angle
from rtphys.physics.handles import Blueprint
from rtphys.sim.body import SimSurface
from rtphys.sim.engine import from_sapien, renders, to_sapien
from rtphys.sim.feet import feel_feet

TOP = 0.74  # [m] nominal height of the table's surface
TOP_HALF = (0.6, 0.35, 0.025)  # [m] half size of the slab, 5 cm thick
LEG_HALF = 0.025  # [m] square legs, inset 5 cm from the edges
MIPMAPS = 2  # of a drawn surface: the second has the pixels of the cameras; more cost a tenth
WALL_Y = 1.0  # [m] centre of the 1.2 m deep wall block: its front face is at y = 0.4


@dataclass(frozen=True, eq=False)
class TablePlan:
    """Where the table stands: the task's own shift, then the episode's physics."""

    shift: tuple[float, float] = (0.0, 0.0)  # [m] of its centre, xy
    drop: float = 0.0  # [m] below the usual height
    colour: tuple[float, float, float] = (0.93, 0.92, 0.90)
    wall_colour: tuple[float, float, float] = (1.0, 0.9, 0.9)
    # Instead of the colours: files, stretched over a box's faces, or drawn surfaces at their size.
    texture: Path | Picture | None = None
    wall_texture: Path | Picture | None = None


def task_frame(plan: TablePlan, blueprint: Blueprint) -> Pose:
    """X_WT: turn about the table's centre so that its normal leans towards +y, then lower it."""
    centre = np.array([*plan.shift, TOP])
    # A right-handed turn about +x leans the normal towards -y, hence the minus.
    q = axis_angle((1, 0, 0), -blueprint.table_tilt)
    turn = Pose((0, 0, 0), q)
    drop = np.array([0, 0, blueprint.table_height - plan.drop])
    return Pose(centre - turn.R @ centre + drop, q)


class Room:
    """The static surroundings; `table` is the entity whose pose is the label's truth."""

    def __init__(self, scene: sapien.Scene, plan: TablePlan, blueprint: Blueprint) -> None:
        self.plan = plan
        self.X_WT = task_frame(plan, blueprint)
        ground = self._build_ground(scene)
        self.table = self._build_table(scene)
        wall = self._build_wall(scene)
        self._backdrop = (self.table, wall, ground)  # from front to back
        self.table_surface, *self.scenery = (
            SimSurface(entity.name, _shapes(entity)) for entity in (self.table, wall, ground)
        )
        feel_feet(self.table_surface.shapes)

    def measured(self) -> tuple[float, float]:
        """Tilt [rad] and height above nominal [m] of the simulator's table."""
        X_WT = from_sapien(self.table.pose) @ Pose((*self.plan.shift, TOP)).inverse()
        centre = X_WT @ np.array([*self.plan.shift, TOP])
        normal = X_WT.R[:, 2]
        return float(np.arctan2(normal[1], normal[2])), float(centre[2] - TOP + self.plan.drop)

    def draw_last(self) -> None:
        """From now on pictures draw table, wall and ground after all that is in the scene.

        Bodies are drawn in the order in which they came, and what others hide already is not
        shaded: a fortieth of a picture.
        """
        for entity in self._backdrop:
            for body in entity.components:
                if isinstance(body, sapien.render.RenderBodyComponent):
                    body.disable()
                    body.enable()

    def _build_ground(self, scene: sapien.Scene) -> sapien.Entity:
        ground = scene.create_actor_builder()
        # A plane's normal is its x axis; turn it up.
        up = sapien.Pose([0, 0, 0], [0.7071068, 0, -0.7071068, 0])
        ground.add_plane_collision(up)
        if renders(scene):
            paint = sapien.render.RenderMaterial(base_color=[0.55, 0.55, 0.57, 1])
            ground.add_plane_visual(up, (20, 20, 20), paint)
        return ground.build_static("ground")

    def _build_table(self, scene: sapien.Scene) -> sapien.Entity:
        builder = scene.create_actor_builder()
        half_x, half_y, half_z = TOP_HALF
        parts = [(np.array([0, 0, -half_z]), np.array(TOP_HALF))]
        leg_half = (TOP - 2 * half_z - 0.12) / 2  # 12 cm off the ground: a lowered table fits
        for sx in (-1, 1):
            for sy in (-1, 1):
                at = (sx * (half_x - 0.075), sy * (half_y - 0.075), -2 * half_z - leg_half)
                parts.append((np.array(at), np.array([LEG_HALF, LEG_HALF, leg_half])))
        top, *legs = parts
        self._add_box(scene, builder, top, self._plain(scene, self.plan.colour, self.plan.texture))
        for leg in legs:
            self._add_box(scene, builder, leg, _paint(scene, self.plan.colour))
        builder.initial_pose = to_sapien(self.X_WT @ Pose((*self.plan.shift, TOP)))
        table = builder.build_static("table")
        _clad(scene, table, top, ("table", self.plan.texture))
        return table

    def _build_wall(self, scene: sapien.Scene) -> sapien.Entity:
        builder = scene.create_actor_builder()
        half = np.array([3, 0.6, 1.5])
        paint = self._plain(scene, self.plan.wall_colour, self.plan.wall_texture)
        self._add_box(scene, builder, (np.zeros(3), half), paint)
        builder.initial_pose = sapien.Pose([0, WALL_Y, 1.5])
        wall = builder.build_static("wall")
        _clad(scene, wall, (np.zeros(3), half), ("wall", self.plan.wall_texture))
        return wall

    @staticmethod
    def _plain(
        scene: sapien.Scene, colour: tuple[float, float, float], texture: Path | Picture | None
    ) -> "sapien.render.RenderMaterial | None":
        """The paint of a box; None where a drawn surface will clad it."""
        return None if isinstance(texture, np.ndarray) else _paint(scene, colour, texture)

    @staticmethod
    def _add_box(
        scene: sapien.Scene, builder, box, paint: "sapien.render.RenderMaterial | None"
    ) -> None:
        centre, half = box
        pose = sapien.Pose(centre.tolist())
        builder.add_box_collision(pose, half.tolist())
        if paint is not None:
            builder.add_box_visual(pose, half.tolist(), paint)


def _shapes(entity: sapien.Entity) -> list[physx.PhysxCollisionShape]:
    body = entity.find_component_by_type(physx.PhysxRigidStaticComponent)
    assert isinstance(body, physx.PhysxRigidStaticComponent)
    return body.collision_shapes


def _paint(
    scene: sapien.Scene, colour: tuple[float, float, float], picture: Path | None = None
) -> "sapien.render.RenderMaterial | None":
    """None where the scene cannot draw."""
    if not renders(scene):
        return None
    paint = sapien.render.RenderMaterial(base_color=[*colour, 1])
    paint.roughness = 0.8
    if picture is not None:
        paint.base_color = [1, 1, 1, 1]
        paint.base_color_texture = sapien.render.RenderTexture2D(str(picture))
    return paint


def _clad(
    scene: sapien.Scene,
    entity: sapien.Entity,
    box: tuple[Array, Array],
    surface: tuple[Place, Path | Picture | None],
) -> None:
    """Give a box a drawn surface in its real size, its picture in the middle of each face."""
    place, picture = surface
    if not renders(scene) or not isinstance(picture, np.ndarray):
        return
    opaque = np.full((*picture.shape[:2], 4), 255, np.uint8)
    opaque[..., :3] = picture
    paint = sapien.render.RenderMaterial(base_color=[1, 1, 1, 1])
    paint.roughness = 0.8
    paint.base_color_texture = sapien.render.RenderTexture2D(
        opaque, "R8G8B8A8Unorm", mipmap_levels=MIPMAPS, address_mode="mirror", srgb=True
    )
    shape = sapien.render.RenderShapeTriangleMesh(*_box_mesh(*box, CANVAS[place]), paint)
    body = sapien.render.RenderBodyComponent()  # of its own: a built one takes no more shapes
    body.attach(shape)
    entity.add_component(body)


def _box_mesh(centre: Array, half: Array, canvas: Canvas) -> tuple[Array, Array, Array, Array]:
    """Vertices, triangles, normals and texture coordinates of a box."""
    corners, normals, places = [], [], []
    for axis in range(3):
        for side in (1, -1):
            # Along the picture's rows, and up: their cross product is the face's normal.
            along, up = ((axis + 1) % 3, (axis + 2) % 3)[::side]
            for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
                corner = np.zeros(3)
                corner[[axis, along, up]] = side * half[axis], a * half[along], b * half[up]
                corners.append(centre + corner)
                normals.append(side * np.eye(3)[axis])
                places.append(
                    (0.5 + corner[along] / canvas.width, 0.5 - corner[up] / canvas.height)
                )
    faces = [
        (4 * f + i, 4 * f + j, 4 * f + k) for f in range(6) for i, j, k in ((0, 1, 2), (0, 2, 3))
    ]
    return (
        np.array(corners, np.float32),
        np.array(faces, np.uint32),
        np.array(normals, np.float32),
        np.array(places, np.float32),
    )  # pyright: ignore[reportReturnType]
