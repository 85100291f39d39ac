"""How deep the bodies of a world lie in each other, static ones too."""

from collections.abc import Mapping, Sequence
from itertools import combinations

from rtphys.plan.overlap import depth
from rtphys.sim.body import own_shapes, shape_points
from rtphys.sim.engine import AnyBody, from_sapien
from rtphys.sim.world import World

LEAST = 0.001  # [m] of overlap that counts


def overlaps(world: World) -> dict[tuple[str, str], float]:
    """Names of two things -> how deep one lies in the other [m], where it is more than LEAST."""
    bodies: Mapping[str, Sequence[AnyBody]] = {
        **{name: list(o.links.values()) for name, o in world.scene_objects.items()},
        "table": [world.room.table.components[0]],  # pyright: ignore[reportAssignmentType]
        "robot": world.robot.articulation.links,
    }
    parts = {
        name: [
            from_sapien(body.entity_pose) @ shape_points(shape)
            for body in members
            for shape in own_shapes(body)
        ]
        for name, members in bodies.items()
    }
    deep: dict[tuple[str, str], float] = {}
    for a, b in combinations(parts, 2):
        found = max((depth(p, q, LEAST) for p in parts[a] for q in parts[b]), default=0.0)
        if found > 0:
            deep[a, b] = found
    for name in parts.keys() - {"table"}:
        found = -min((float(points[:, 2].min()) for points in parts[name]), default=0.0)
        if found > LEAST:
            deep[name, "ground"] = found
    return deep
