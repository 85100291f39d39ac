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
from rtphys.task.props import TABLE_TOP

TOP_HALF = (0.6, 0.35, 0.025)  # [m] half size of the slab, 5 cm thick
LEG_HALF = 0.025  # [m] square legs, inset 5 cm from the edges
MIPMAPS = 2  # of a drawn surface: the second has the pixels of the cameras; more cost a tenth
Colour = tuple[float, float, float]
Box = tuple[tuple[float, float, float], tuple[float, float, float]]  # centre, half size [m]
WALL_AT, WALL_HALF = (0.0, 1.0, 1.5), (3.0, 0.6, 1.5)  # [m] its front face is at y = 0.4
TABLE_COLOUR, WALL_COLOUR = (0.93, 0.92, 0.90), (1.0, 0.9, 0.9)  # without textures


@dataclass(frozen=True, eq=False)
class TablePlan:
    """Where the table stands: the task's own shift, then the episode's physics."""

    shift: tuple[float, float] = (0.0, 0.0)  # [m] of its centre, xy
    drop: float = 0.0  # [m] below the usual height
    # Instead of a colour: files, stretched over a box's faces, or drawn surfaces at their size.
    texture: Path | Picture | None = None
    wall_texture: Path | Picture | None = None


class Room:
    """The static surroundings; `table` is the entity whose pose is the label's truth."""

    def __init__(self, scene: sapien.Scene, plan: TablePlan, blueprint: Blueprint) -> None:
        self.plan = plan
        # Turn about the table's centre so that its normal leans towards +y, then lower it. A
        # right-handed turn about +x leans the normal towards -y, hence the minus.
        centre = np.array([*plan.shift, TABLE_TOP])
        turn = Pose((0, 0, 0), axis_angle((1, 0, 0), -blueprint.table_tilt))
        drop = np.array([0, 0, blueprint.table_height - plan.drop])
        self.X_WT = Pose(centre - turn.R @ centre + drop, turn.q)

        builder = scene.create_actor_builder()
        # A plane's normal is its x axis; turn it up.
        up = sapien.Pose([0, 0, 0], [0.7071068, 0, -0.7071068, 0])
        builder.add_plane_collision(up)
        if renders(scene):
            paint = sapien.render.RenderMaterial(base_color=[0.55, 0.55, 0.57, 1])
            builder.add_plane_visual(up, (20, 20, 20), paint)
        ground = builder.build_static("ground")

        half_x, half_y, half_z = TOP_HALF
        boxes: list[Box] = [((0, 0, -half_z), TOP_HALF)]
        leg_half = (TABLE_TOP - 2 * half_z - 0.12) / 2  # 12 cm off the ground: a lowered table fits
        for sx in (-1, 1):
            for sy in (-1, 1):
                at = (sx * (half_x - 0.075), sy * (half_y - 0.075), -2 * half_z - leg_half)
                boxes.append((at, (LEG_HALF, LEG_HALF, leg_half)))
        pose = to_sapien(self.X_WT @ Pose((*plan.shift, TABLE_TOP)))
        self.table = _build(scene, "table", pose, boxes, TABLE_COLOUR, plan.texture)
        block: list[Box] = [((0, 0, 0), WALL_HALF)]
        pose = sapien.Pose([*WALL_AT])
        wall = _build(scene, "wall", pose, block, WALL_COLOUR, plan.wall_texture)

        self._backdrop = (self.table, wall, ground)  # from front to back
        surfaces = []
        for entity in self._backdrop:
            body = entity.find_component_by_type(physx.PhysxRigidStaticComponent)
            assert isinstance(body, physx.PhysxRigidStaticComponent)
            surfaces.append(SimSurface(entity.name, body.collision_shapes))
        self.table_surface, *self.scenery = surfaces
        feel_feet(self.table_surface.shapes, table=True)

    def measured(self) -> tuple[float, float]:
        """Tilt [rad] and height above nominal [m] of the simulator's table."""
        X_WT = from_sapien(self.table.pose) @ Pose((*self.plan.shift, TABLE_TOP)).inverse()
        centre = X_WT @ np.array([*self.plan.shift, TABLE_TOP])
        normal = X_WT.R[:, 2]
        height = centre[2] - TABLE_TOP + self.plan.drop
        return float(np.arctan2(normal[1], normal[2])), float(height)

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


def _build(
    scene: sapien.Scene,
    name: Place,
    pose: sapien.Pose,
    boxes: list[Box],
    colour: Colour,
    texture: Path | Picture | None,
) -> sapien.Entity:
    """A static body of boxes; the first shows the texture, a drawn one in its real size."""
    builder, drawn = scene.create_actor_builder(), renders(scene)
    for i, (centre, half) in enumerate(boxes):
        builder.add_box_collision(sapien.Pose(centre), half)
        picture = texture if i == 0 else None
        if drawn and not isinstance(picture, np.ndarray):
            paint = sapien.render.RenderMaterial(base_color=[*colour, 1])
            paint.roughness = 0.8
            if picture is not None:
                paint.base_color = [1, 1, 1, 1]
                paint.base_color_texture = sapien.render.RenderTexture2D(str(picture))
            builder.add_box_visual(sapien.Pose(centre), half, paint)
    builder.initial_pose = pose
    entity = builder.build_static(name)
    if drawn and isinstance(texture, np.ndarray):
        opaque = np.full((*texture.shape[:2], 4), 255, np.uint8)
        opaque[..., :3] = texture
        paint = sapien.render.RenderMaterial(base_color=[1, 1, 1, 1])
        paint.roughness = 0.8
        paint.base_color_texture = sapien.render.RenderTexture2D(
            opaque, "R8G8B8A8Unorm", mipmap_levels=MIPMAPS, address_mode="mirror", srgb=True
        )
        mesh = _box_mesh(np.array(boxes[0][0]), np.array(boxes[0][1]), CANVAS[name])
        body = sapien.render.RenderBodyComponent()  # of its own: a built one takes no more shapes
        body.attach(sapien.render.RenderShapeTriangleMesh(*mesh, paint))
        entity.add_component(body)
    return entity


def _box_mesh(centre: Array, half: Array, canvas: Canvas) -> tuple[Array, Array, Array, Array]:
    """Vertices, triangles, normals and texture coordinates, the picture amid each face."""
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
                across, down = corner[along] / canvas.width, corner[up] / canvas.height
                places.append((0.5 + across, 0.5 - down))
    faces = [
        (4 * f + i, 4 * f + j, 4 * f + k) for f in range(6) for i, j, k in ((0, 1, 2), (0, 2, 3))
    ]
    parts = (corners, np.float32), (faces, np.uint32), (normals, np.float32), (places, np.float32)
    return tuple(np.array(values, kind) for values, kind in parts)  # pyright: ignore[reportReturnType]
