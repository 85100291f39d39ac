"""Everything in a stored episode as solids that move, for viewers: the shapes that physics has."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import scipy  # whose parts are loaded when they are first used
from numpy.typing import NDArray

from rtphys.assets.pack import Pack
from rtphys.core.poses import Array, Pose
from rtphys.data.dataset import Episode
from rtphys.episode.audit import rebuild
from rtphys.sim.body import shape_points
from rtphys.sim.engine import from_sapien


@dataclass(frozen=True, eq=False)
class Solid3D:
    """One rigid body: convex parts that touch or overlap."""

    name: str  # such as robot/fl_link6, objects/cup or room/table
    vertices: NDArray[np.float32]  # (v, 3) [m] in the body's frame
    triangles: NDArray[np.uint32]  # (t, 3) rows of vertices, outward
    poses: Array  # (T, 7) xyz [m] + wxyz, world; T = 1: it stands still


def solids(episode: Episode, pack: Pack) -> list[Solid3D]:
    """The table, the robot and all objects of an episode.

    A lid, a drawer or another moving part of an object stays as it was at first, because files
    hold the pose of an object's root alone. `pack`: the assets with which it was collected.

    Raises `RtphysError`, `ValueError`: its world cannot be built again.
    """
    frames = episode.frames
    world, _ = rebuild(episode.meta, episode.physics, pack)
    table = from_sapien(world.room.table.pose).flat[None]
    found = [_solid("room/table", world.room.table_surface.shapes, table)]
    for name, thing in world.scene_objects.items():
        root, track = from_sapien(thing.root.entity_pose), frames.object_poses.get(name)
        for link, body in thing.links.items():
            poses = from_sapien(body.entity_pose).flat[None]
            if track is not None:
                X_RL = root.inverse() @ from_sapien(body.entity_pose)
                rows = np.asarray(track, float)
                poses = np.array([(Pose(row[:3], row[3:]) @ X_RL).flat for row in rows])
            label = f"{name}/{link}" if len(thing.links) > 1 else name
            found.append(_solid(f"objects/{label}", body.collision_shapes, poses))
    art = world.robot.articulation
    tracks = list[list[Array]]()  # by frame and link
    for q in np.asarray(frames.qpos, np.float32):
        art.set_qpos(q)
        tracks.append([from_sapien(link.entity_pose).flat for link in art.links])
    for link, poses in zip(art.links, np.array(tracks).swapaxes(0, 1), strict=True):
        found.append(_solid(f"robot/{link.name}", link.collision_shapes, poses))
    return [solid for solid in found if len(solid.triangles)]


def _solid(name: str, shapes: Iterable[object], poses: Array) -> Solid3D:
    vertices: list[Array] = [np.empty((0, 3))]
    triangles: list[Array] = [np.empty((0, 3), int)]
    count = 0
    for shape in shapes:
        try:
            hull = scipy.spatial.ConvexHull(shape_points(shape))  # type: ignore[arg-type] - SAPIEN's
        except (scipy.spatial.QhullError, ValueError):
            continue  # flat, or of a kind that has no corners
        a, b, c = (hull.points[hull.simplices[:, k]] for k in range(3))
        inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), hull.equations[:, :3]) < 0
        # Counter-clockwise as seen from outside.
        outward = np.where(inward[:, None], hull.simplices[:, ::-1], hull.simplices)
        vertices.append(hull.points)
        triangles.append(outward + count)
        count += len(hull.points)
    corners = np.concatenate(vertices).astype(np.float32)
    return Solid3D(name, corners, np.concatenate(triangles).astype(np.uint32), poses)
