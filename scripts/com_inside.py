"""Which drawn centres of mass lie inside a task's bodies: the reason for narrow domains."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from rtphys.assets.pack import Pack
from rtphys.core import library
from rtphys.core.errors import Infeasible
from rtphys.core.poses import Array, Pose
from rtphys.physics import Domain, load_domain
from rtphys.physics.hull import Solid, inside
from rtphys.physics.reach import Reach
from rtphys.physics.values import Vector
from rtphys.sim.engine import new_scene
from rtphys.sim.objects import ObjectFactory
from rtphys.task.props import Prop
from rtphys.task.spec import load_task

UPRIGHT = Pose((0, 0, 0), (1, 0, 0, 0))


class Bodies:
    """Convex hulls of the dynamic bodies of props at nominal size; each model is built once."""

    def __init__(self, pack: Pack) -> None:
        self._factory = ObjectFactory(new_scene(visuals=False), pack, UPRIGHT, scale=1.0)
        self._known: dict[Prop, list[Solid]] = {}

    def solids(self, props: Sequence[Prop]) -> list[Solid]:
        """Solids of all dynamic bodies of these props; fixed props have none.

        Raises:
            MissingAsset, UnknownName, BadFile: from the pack.
        """
        solids: list[Solid] = []
        for prop in props:
            kind = replace(prop, name="body", pose=UPRIGHT)
            if kind not in self._known:
                bodies = self._factory.build(kind).bodies
                self._known[kind] = [Solid(body.hull, body.nominal_com) for body in bodies]
            solids += self._known[kind]
        return solids


@dataclass(frozen=True, eq=False)
class Survival:
    """What rejection leaves of the drawn centres of mass.

    An episode draws again until the centre lies inside every body, that is inside its convex hull
    shrunk by a tenth, at the smallest size of the domain. So its label is a draw that survives.
    """

    share: float  # of the seeds whose first draw survives
    drawn: Array  # (3,) standard deviation of all first draws along the body's axes [m]
    left: Array  # (3,) the same of those that survive [m]


def survival(task: str, domain: Domain, bodies: Bodies, seeds: Sequence[int]) -> Survival:
    """Count the first draws of some seeds that lie inside all bodies of a task."""
    loaded, drawn, kept = load_task(task), list[Vector](), list[bool]()
    for seed in seeds:
        try:
            solids = bodies.solids(loaded.props(seed))
        except Infeasible:
            continue
        physics = domain.sample(seed, ["center_of_mass"], task=task)
        drawn.append(physics.vector("center_of_mass"))
        named = {str(number): solid for number, solid in enumerate(solids)}
        kept.append(inside(named, domain.smallest_scale)(drawn[-1], Reach()))
    points, survive = np.array(drawn), np.array(kept)
    left = points[survive].std(axis=0) if survive.any() else np.zeros(3)
    return Survival(float(survive.mean()), points.std(axis=0), left)


def narrowed() -> dict[str, Domain]:
    """Task -> its own domain, for tasks whose domain has its own rule for the centre of mass."""
    domains = {name: load_domain(name) for name in library.names("domains") if name != "global"}
    return {n: d for n, d in domains.items() if d.sources.get("center_of_mass") == n}
