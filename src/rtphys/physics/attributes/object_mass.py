"""Mass of every dynamic task body, relative to the asset's own."""

import numpy as np

from rtphys.physics.attribute import Attribute, Reading
from rtphys.physics.handles import World
from rtphys.physics.values import Interval


class ObjectMass(Attribute[World, float]):
    """Factor [1] on mass and inertia, as if the same shape had another density."""

    key = "object_mass"
    unit = "×"
    nominal = 1.0
    valid = by_prop = Interval(0.01, 100)
    acts_on = "bodies"
    what = "mass and inertia of every dynamic task body"

    def apply(self, target: World, value: float) -> None:
        for body in target.bodies:
            body.set_mass(body.nominal_mass * value)
            # SAPIEN's set_mass leaves the inertia as it was: without this only the weight changes.
            body.set_inertia(body.nominal_inertia * value)

    def read(self, world: World) -> dict[str, Reading]:
        """Mass ratio as `<body>`, the three inertia ratios as `<body>.inertia`."""
        out: dict[str, Reading] = {}
        for body in world.bodies:
            out[body.name] = body.mass / body.nominal_mass
            ratios = np.asarray(body.inertia) / body.nominal_inertia
            out[f"{body.name}.inertia"] = tuple(float(r) for r in ratios)
        return out

    def expected(self, world: World, value: float) -> dict[str, Reading]:
        ratios = (value, value, value)
        return {p: ratios if p.endswith(".inertia") else value for p in self.read(world)}
