"""Damping gain of the gripper servos: how fast fingers follow their targets."""

from rtphys.physics.attribute import Attribute, Reading
from rtphys.physics.handles import Happened, World
from rtphys.physics.values import Interval


class GripperJointDamping(Attribute[World, float]):
    """Factor [1] on the nominal damping gain of the servo of every gripper joint."""

    key = "gripper_joint_damping"
    unit = "×"
    nominal = 1.0
    valid = Interval(0.05, 20)
    tolerance = 0.06
    what = "damping gain of the gripper servos"

    def acted(self, happened: Happened) -> bool:
        return happened.fingers

    def apply(self, target: World, value: float) -> None:
        for servo in target.gripper_servos:
            servo.set_damping(servo.nominal_damping * value)

    def read(self, world: World) -> dict[str, Reading]:
        return {s.name: s.damping / s.nominal_damping for s in world.gripper_servos}
