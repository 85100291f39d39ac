"""Slow electronics: an attribute of the robot, with work before and after every step."""

from collections import deque

from rtphys.physics import Attribute, Interval, World

STEP = 4.0  # [ms] of the simulation


class Delay:
    """Gives every servo the target of some steps ago, and its newest one back after the step.

    So whatever records commands sees those that were sent, not those that have arrived.
    """

    def __init__(self, world: World, steps: int) -> None:
        self.joints = [servo.joint for servo in (*world.arm_servos, *world.gripper_servos)]
        self.steps = steps
        self.sent = deque([self.targets()] * steps, maxlen=steps + 1)

    def targets(self) -> list[tuple[float, float]]:
        return [(float(j.drive_target[0]), float(j.drive_velocity_target[0])) for j in self.joints]

    def set(self, targets: list[tuple[float, float]]) -> None:
        for joint, (position, velocity) in zip(self.joints, targets, strict=True):
            joint.set_drive_target(position)
            joint.set_drive_velocity_target(velocity)

    def before(self) -> None:
        self.sent.append(self.targets())
        self.set(self.sent[0])

    def after(self) -> None:
        self.set(self.sent[-1])


class ActuatorLatency(Attribute[World, float]):
    """Time [ms] from a command to the servos of arms and grippers, rounded to steps of 4 ms."""

    key = "actuator_latency"
    unit = "ms"
    nominal = 0.0
    valid = Interval(0, 400)
    resolution = STEP / 2
    what = "delay from a command to the servos"

    def apply(self, target: World, value: float) -> None:
        if steps := round(value / STEP):
            delay = Delay(target, steps)
            target.on_step(self.key, delay.before, delay.after)
        else:
            target.on_step(self.key)

    def read(self, world: World) -> dict[str, float]:
        before, _ = world.step_hooks.get(self.key, (None, None))
        delay = getattr(before, "__self__", None)
        return {"servos": STEP * delay.steps if isinstance(delay, Delay) else 0.0}
