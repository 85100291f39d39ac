"""Who presses on whom: contact pairs by the names that tasks use."""

from dataclasses import dataclass

import numpy as np

from rtphys.poses import Array
from rtphys.sim.world import World


@dataclass(frozen=True, eq=False)
class Touch:
    """All contact between two named things at one instant."""

    points: Array  # (n, 3) [m] world frame
    impulse: float  # [N s] sum of magnitudes over one step


class Contacts:
    """Contacts of the current step, read from the solver at most once a step."""

    def __init__(self, world: World) -> None:
        self._world, self._step = world, -1
        self._touches: dict[frozenset[str], Touch] = {}
        self._owner: dict[int, str] = {world.room.table.per_scene_id: "table"}
        owners = world.robot.link_owner()
        for link in world.robot.articulation.links:
            self._owner[link.entity.per_scene_id] = owners[link.name]
        for thing in world.things.values():
            for component in thing.links.values():
                self._owner[component.entity.per_scene_id] = thing.name

    def between(self, a: str, b: str) -> Touch | None:
        """Contact with a positive impulse between two things now, or None."""
        return self._now().get(frozenset((a, b)))

    def _now(self) -> dict[frozenset[str], Touch]:
        if self._step != self._world.steps:
            self._step, self._touches = self._world.steps, self._read()
        return self._touches

    def _read(self) -> dict[frozenset[str], Touch]:
        found: dict[frozenset[str], tuple[list[Array], float]] = {}
        for contact in self._world.scene.get_contacts():
            a, b = (self._owner.get(body.entity.per_scene_id) for body in contact.bodies)
            if a is None or b is None or a == b:
                continue
            # A pair is listed as soon as it is within the contact offset of 1 cm; only an
            # impulse says that the two press on each other.
            pushing = [p for p in contact.points if np.any(p.impulse)]
            if not pushing:
                continue
            points, total = found.setdefault(frozenset((a, b)), ([], 0.0))
            points.extend(np.asarray(p.position, float) for p in pushing)
            strength = total + sum(float(np.linalg.norm(p.impulse)) for p in pushing)
            found[frozenset((a, b))] = (points, strength)
        return {pair: Touch(np.array(points), s) for pair, (points, s) in found.items()}
