"""How often a drawn centre of mass lies outside a task's bodies: the reason for narrow domains."""

from collections.abc import Sequence
from dataclasses import replace

from rtphys.assets.pack import Pack
from rtphys.core import library
from rtphys.core.errors import Infeasible
from rtphys.core.poses import Pose
from rtphys.physics import Domain, load_domain
from rtphys.physics.hull import Solid, inside
from rtphys.sim.engine import new_scene
from rtphys.sim.factory import ObjectFactory
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


def outside(task: str, domain: Domain, bodies: Bodies, seeds: Sequence[int]) -> float:
    """Share of seeds whose first draw of the centre of mass lies outside some body.

    An episode draws again until the centre lies inside, so the share shows how much of a domain no
    real object of the task could have. Outside means outside the hull shrunk by a tenth.
    """
    loaded, tried, out = load_task(task), 0, 0
    for seed in seeds:
        try:
            solids = bodies.solids(loaded.props(seed))
        except Infeasible:
            continue
        drawn = domain.sample(seed, task=task)
        tried += 1
        fits = inside(solids, drawn.scalar("object_scale"))
        out += not fits(drawn.vector("center_of_mass"))
    return out / tried


def narrowed() -> dict[str, Domain]:
    """Task -> its own domain, for tasks whose domain has its own rule for the centre of mass."""
    domains = {name: load_domain(name) for name in library.names("domains") if name != "global"}
    return {n: d for n, d in domains.items() if d.sources.get("center_of_mass") == n}
