"""How sluggish the arms' servos are."""

from rtphys.physics.attribute import Attribute, Reading
from rtphys.physics.handles import World
from rtphys.physics.interval import Interval


class ArmJointDamping(Attribute[World, float]):
    """Factor on the damping gain of every arm joint's servo."""

    key = "arm_joint_damping"
    unit = "×"
    nominal = 1.0
    valid = Interval(0.05, 20)
    what = "damping gain of the arm servos"

    def apply(self, target: World, value: float) -> None:
        for servo in target.arm_servos:
            servo.set_damping(servo.nominal_damping * value)

    def read(self, world: World) -> dict[str, Reading]:
        return {s.name: s.damping / s.nominal_damping for s in world.arm_servos}
