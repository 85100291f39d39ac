"""Which body, and which mesh of it, a pixel shows: the scene's ids as small numbers with names."""

from collections.abc import Iterable

import numpy as np
import sapien
from numpy.typing import NDArray

from rtphys.sim.world import World

BACKGROUND = "background"
MOST = 139  # ids, 0 included, that the official palette has colours for
BETWEEN = " | "  # of the names of meshes that share an id


class Identities:
    """Numbers what a scene draws, in the order in which it was built; 0 is the background.

    Where there are more than the palette has colours, numbers are given out again from 1.

    Attributes:
        names: "actor" and "mesh" -> name of each id.
    """

    def __init__(self, world: World) -> None:
        known = _names(world)
        actors, meshes = dict[int, str](), dict[int, str]()
        for entity in world.scene.entities:
            shapes = [
                shape
                for body in entity.components
                if isinstance(body, sapien.render.RenderBodyComponent)
                for shape in body.render_shapes
            ]
            if not shapes:
                continue
            name = known.get(entity.per_scene_id, entity.name)
            actors[entity.per_scene_id] = name
            for n, shape in enumerate(shapes):
                meshes[shape.per_scene_id] = name if len(shapes) == 1 else f"{name}/{n}"
        self._actors, actor_names = _numbered(actors)
        self._meshes, mesh_names = _numbered(meshes)
        self.names = {"actor": actor_names, "mesh": mesh_names}

    def actors(self, entities: NDArray[np.uint16]) -> NDArray[np.uint8]:
        """(H, W) ids of bodies, from SAPIEN's ids of entities."""
        return np.take(self._actors, entities, mode="clip")

    def meshes(self, shapes: NDArray[np.uint16]) -> NDArray[np.uint8]:
        """(H, W) ids of meshes, from SAPIEN's ids of shapes."""
        return np.take(self._meshes, shapes, mode="clip")


def body_names(world: World, count: int) -> tuple[str, ...]:
    """Names of the first bodies of a scene, in the order of `scene.pack_poses`."""
    known = _names(world)
    entities: Iterable[sapien.Entity] = world.scene.entities[:count]
    return tuple(known.get(entity.per_scene_id, entity.name) for entity in entities)


def _names(world: World) -> dict[int, str]:
    """Entity's id -> name of the object, and of the link if it has several."""
    return {
        component.entity.per_scene_id: f"{name}/{link}" if len(thing.links) > 1 else name
        for name, thing in world.scene_objects.items()
        for link, component in thing.links.items()
    }


def _numbered(names: dict[int, str]) -> tuple[NDArray[np.uint8], tuple[str, ...]]:
    """Scene's id -> number (beyond the last: 0), and the name of each number."""
    table = np.zeros(max(names, default=0) + 2, np.uint8)
    shared: dict[int, list[str]] = {0: [BACKGROUND]}
    for n, scene_id in enumerate(sorted(names)):
        table[scene_id] = number = 1 + n % (MOST - 1)
        shared.setdefault(number, []).append(names[scene_id])
    return table, tuple(BETWEEN.join(shared[number]) for number in sorted(shared))
