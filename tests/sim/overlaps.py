"""How deep the bodies of a world lie in each other, static ones too, by exact distances."""

from itertools import combinations

import coal  # pyright: ignore[reportMissingImports]
import numpy as np
from sapien import physx

from rtphys.plan.robot_shapes import hull
from rtphys.sim.body import own_shapes, shape_points
from rtphys.sim.engine import from_sapien
from rtphys.sim.world import World

LEAST = 0.001  # [m] of overlap that counts


def overlaps(world: World) -> dict[tuple[str, str], float]:
    """Names of two things -> how deep one lies in the other [m], where it is more than LEAST."""
    things = {name: list(o.links.values()) for name, o in world.scene_objects.items()}
    table = world.room.table.find_component_by_type(physx.PhysxRigidStaticComponent)
    things["table"] = [table]
    things["robot"] = list(world.robot.articulation.links)
    parts = {
        name: [
            from_sapien(body.entity_pose) @ shape_points(shape)
            for body in bodies
            for shape in own_shapes(body)
        ]
        for name, bodies in things.items()
    }
    deep: dict[tuple[str, str], float] = {}
    for a, b in combinations(parts, 2):
        depth = max((_depth(p, q) for p in parts[a] for q in parts[b]), default=0.0)
        if depth > LEAST:
            deep[a, b] = depth
    for name in parts.keys() - {"table"}:
        depth = -min((float(points[:, 2].min()) for points in parts[name]), default=0.0)
        if depth > LEAST:
            deep[name, "ground"] = depth
    return deep


def _depth(a: np.ndarray, b: np.ndarray) -> float:
    if np.any(a.min(0) > b.max(0) - LEAST) or np.any(b.min(0) > a.max(0) - LEAST):
        return 0.0
    still = coal.Transform3s()
    request, result = coal.DistanceRequest(True, True), coal.DistanceResult()
    coal.distance(hull(a), still, hull(b), still, request, result)
    return max(0.0, -result.min_distance)
