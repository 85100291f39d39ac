"""What the arms must not hit: every collision part of the scene as a convex obstacle."""

import numpy as np

from rtphys.core.poses import Pose
from rtphys.plan.collision import Obstacle
from rtphys.sim.room import TOP, TOP_HALF
from rtphys.sim.world import World
from rtphys.task.props import Ball

TABLE = "table"
_WALL = Obstacle("wall", np.array([3.0, 0.6, 1.5]), Pose((0, 1.0, 1.5)))


def obstacles_of(world: World, without: set[str]) -> list[Obstacle]:
    """Table, wall, every task object but those named, and all clutter, where they are now.

    Balls are left out: they roll away, or ride along in what is carried.
    """
    x, y = world.plan.table.shift
    half = np.array(TOP_HALF)
    table = Obstacle(TABLE, half, world.X_WT @ Pose((x, y, TOP - half[2])))
    obstacles = [table, _WALL]
    for name, scene_object in world.scene_objects.items():
        if name in without or isinstance(scene_object.prop, Ball):
            continue
        for link, parts in scene_object.parts.items():
            pose = scene_object.link_pose(link)
            obstacles += [Obstacle(name, part, pose) for part in parts]
    return obstacles
