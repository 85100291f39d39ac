"""How heavy every dynamic task body is, relative to the asset's own mass."""

import numpy as np

from rtphys.physics.attribute import Attribute, Reading
from rtphys.physics.handles import World
from rtphys.physics.interval import Interval


class ObjectMass(Attribute[World, float]):
    """Mass and inertia times one factor: a denser material in the same shape."""

    key = "object_mass"
    unit = "×"
    nominal = 1.0
    valid = Interval(0.01, 100)
    what = "mass and inertia of every dynamic task body"

    def apply(self, target: World, value: float) -> None:
        for body in target.bodies:
            body.set_mass(body.nominal_mass * value)
            # SAPIEN's set_mass leaves the inertia stale: without this line only weight changes.
            body.set_inertia(body.nominal_inertia * value)

    def read(self, world: World) -> dict[str, Reading]:
        """Mass ratio at `<body>`, the three inertia ratios at `<body>.inertia`."""
        out: dict[str, Reading] = {}
        for body in world.bodies:
            out[body.name] = body.mass / body.nominal_mass
            ratios = np.asarray(body.inertia) / body.nominal_inertia
            out[f"{body.name}.inertia"] = tuple(float(r) for r in ratios)
        return out

    def expected(self, world: World, value: float) -> dict[str, Reading]:
        thrice = (value, value, value)
        return {p: thrice if p.endswith(".inertia") else value for p in self.read(world)}
