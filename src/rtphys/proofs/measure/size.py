"""Compares the boxes around shapes in the simulator with those around the meshes of the files."""

import numpy as np

from rtphys.core.poses import Array
from rtphys.proofs.measure.description import describe
from rtphys.proofs.measure.finding import Finding, Measurement, Unmeasured
from rtphys.proofs.measure.matter import parts_of
from rtphys.proofs.measure.specimen import Specimen
from rtphys.sim.engine import from_sapien
from rtphys.sim.objects import SceneObject
from rtphys.task.props import Articulated, Ball


def size_up(specimen: Specimen) -> list[Finding]:
    """The scale of every task object with shapes, at the link where it is furthest off."""
    k = specimen.number("object_scale")
    findings: list[Finding] = []
    for thing in specimen.world.objects.values():
        if not any(c.collision_shapes for c in thing.links.values()):
            continue  # a mark that nothing can touch
        ratios: list[float] = []
        for link, nominal in _nominal(specimen, thing).items():
            if nominal is not None:
                box = np.array(thing.links[link].compute_global_aabb_tight(), float)
                # Of its three sides: PhysX simplifies hulls, and a corner that it cuts off can
                # shorten one side (by 5 % at the worst, a loaf's) without being a scale.
                ratios.append(float(np.median((box[1] - box[0]) / nominal)))
        if ratios:
            worst = max(ratios, key=lambda ratio: abs(ratio - k))
            findings.append(Measurement("object_scale", thing.name, k, worst))
        else:
            why = "its shapes are round, and none of them is read here"
            findings.append(Unmeasured("object_scale", thing.name, why))
    return findings


def _nominal(specimen: Specimen, thing: SceneObject) -> dict[str, Array | None]:
    """Link -> size (3,) [m] of the box around its shapes at scale 1, axes of the world."""
    prop = thing.prop
    if isinstance(prop, Ball):
        return {"": np.full(3, 2 * prop.radius)}
    if not isinstance(prop, Articulated):
        parts = np.vstack(parts_of(prop, specimen.pack))
        return {"": np.ptp(parts @ thing.pose.R.T, axis=0)}
    asset = specimen.pack.articulation(prop.category, prop.model)
    found: dict[str, Array | None] = {}
    for name, link in describe(asset).links.items():
        component = thing.links.get(name)
        if component is not None and component.collision_shapes:
            R = from_sapien(component.entity_pose).R
            parts = link.parts
            found[name] = np.ptp(np.vstack(parts) @ R.T, axis=0) if parts else None
    return found
