"""Centre of mass of a body, as an offset from the asset's own."""

import numpy as np

from rtphys.physics.attribute import Attribute, Reading
from rtphys.physics.handles import World
from rtphys.physics.values import Interval, Vector


class CenterOfMass(Attribute[World, Vector]):
    """Offset in the body frame; mass and inertia about the centre of mass stay the same.

    A domain draws again until the point lies inside every dynamic body (see `hull.py`).
    """

    key = "center_of_mass"
    unit = "m"
    nominal = (0.0, 0.0, 0.0)
    valid = by_prop = Interval(-0.1, 0.1)
    size = 3
    resolution = 1e-8  # single precision at offsets and hulls of decimetres
    acts_on = "bodies"
    what = "offset of the centre of mass in the body's frame"

    def apply(self, target: World, value: Vector) -> None:
        for body in target.bodies:
            # Relative to the asset's own centre, not to the origin: a hammer's is in its head.
            body.set_com(body.nominal_com + np.asarray(value))

    def read(self, world: World) -> dict[str, Reading]:
        return {
            body.name: tuple(float(x) for x in np.asarray(body.com) - body.nominal_com)
            for body in world.bodies
        }
