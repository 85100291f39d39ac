"""Air that slows what moves: the shortest attribute, a value that SAPIEN itself has."""

from rtphys.physics import Attribute, Interval, World


class LinearDrag(Attribute[World, float]):
    """Deceleration per speed d [1/s]: a body that nothing else moves has v(t) = v0 exp(-d t).

    It acts on every dynamic task body, on its velocity and not on its spin.
    """

    key = "linear_drag"
    unit = "1/s"
    nominal = 0.0
    valid = Interval(0, 50)
    resolution = 1e-6  # SAPIEN holds it in single precision
    acts_on = "bodies"
    what = "drag on every dynamic task body, per speed"

    def apply(self, target: World, value: float) -> None:
        for body in target.bodies:
            body.component.set_linear_damping(value)

    def read(self, world: World) -> dict[str, float]:
        return {body.name: float(body.component.linear_damping) for body in world.bodies}
