"""What looks alike and differs: what a robot takes it to be, and how it finds out."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from rtphys.task import DOWN, Arm, Box, Placing, Pose, Robot, Scene

G = 9.81  # [m/s^2]
HELD_UP, HOLD = 0.04, 0.5  # [m], [s] at which a load is weighed
BACK = Placing(mode="free", pre=0.04, gap=0.003, along="point")
APPROACH, OFF = 0.08, 0.06  # [m] before a grasp; up from what was set down


def alike(boxes: Iterable[Box]) -> Iterator[Box]:
    """Blue blocks, of which no name says more."""
    return (replace(box, phrase="blue block") for box in boxes)


def values(scene: Scene, key: str, props: Iterable[str]) -> dict[str, float]:
    """Prop -> the value of an attribute that it has, or is taken to have."""
    physics = scene.physics
    return {prop: physics.scalar(physics.key_of(key, prop)) for prop in props}


def ranked(scene: Scene, key: str, props: Sequence[str]) -> list[str]:
    """The props by an attribute's value, the smallest first."""
    by_prop = values(scene, key, props)
    return sorted(props, key=lambda prop: by_prop[prop])


def hold_up(robot: Robot, prop: str, contacts: Sequence[int] = ()) -> tuple[Arm, np.ndarray]:
    """Lift a prop and hold it still; the arm, and the force and moment (6,) that it feels then."""
    arm = robot.nearest(prop)
    robot.do(arm.grasp(prop, contacts, pre=APPROACH))
    robot.do(arm.lift(HELD_UP))
    robot.do(arm.wait(HOLD))
    return arm, arm.felt()[-1]


def weigh(robot: Robot, prop: str, usual: float) -> float:
    """`object_mass` of a prop that usually has that many kg: it is lifted, and set down again."""
    place = robot.scene.functional(prop, 0)
    arm, felt = hold_up(robot, prop)
    robot.do(arm.place(prop, Pose(place.p, DOWN), point=0, how=BACK))
    robot.do(arm.lift(OFF))
    robot.do(arm.home())
    return -float(felt[2]) / G / usual
