"""An arm joint whose target moves a little follows with the lag tau = k d / stiffness."""

from collections.abc import Callable, Mapping
from functools import partial

import numpy as np

from rtphys.core.poses import Array
from rtphys.laws.lab import Lab, record, time_constants
from rtphys.laws.law import LawTest, Trial, Values, number
from rtphys.physics.values import Value
from rtphys.sim.engine import RATE
from rtphys.sim.world import World

STEP = 0.1  # [rad]; less where that would take more than
EFFORT = 0.5  # of the largest torque of its motor
TOLERANCE = 0.05
LONG = 3.0  # time constants for which the motion is watched


def step_response(
    world: World, read: Callable[[], Array], steps: Array, laws: Mapping[str, float]
) -> list[Trial]:
    """Time constants of servos whose targets have just moved by `steps` (n,) [rad or m].

    Args:
        read: positions (n,) of the servos.
        laws: name of each servo -> its time constant tau [s] by the law.
    """
    start = np.array(read(), float)
    _, q = record(world, int(RATE * LONG * max(*laws.values(), 0.05)), read)
    measured = time_constants(np.vstack([start, q]), start + steps)
    return [
        Trial(name, tau, float(found), "s", tolerance=TOLERANCE)
        for (name, tau), found in zip(laws.items(), measured, strict=True)
    ]


def run(lab: Lab, value: Value, others: Values) -> list[Trial]:
    trials = list[Trial]()
    for joint in range(max(lab.pack.embodiment(lab.embodiment).action_layout.per_arm)):
        world = lab.world([], {**others, "arm_joint_damping": value})
        arms = [arm for arm in world.robot.arms if joint < len(arm.limb.joints)]
        laws, steps = dict[str, float](), list[float]()
        for arm in arms:  # both at once: they are far apart
            drive, target = arm.limb.drive, arm.target
            name = f"tau of {arm.side} joint {joint + 1}"
            laws[name] = number(value) * drive.damping / drive.stiffness
            # Towards the middle of the joint's range, so that no limit stops it.
            step = min(STEP, EFFORT * float(arm.limb.effort[joint]) / drive.stiffness)
            steps.append(step if target[joint] <= arm.limb.limits[joint].mean() else -step)
            target[joint] += steps[-1]
            arm.drive(target.tolist(), [0.0] * len(target))
        index, robot = [int(arm.index[joint]) for arm in arms], world.robot.articulation
        read = partial(lambda art, at: art.qpos[at], robot, index)
        trials += step_response(world, read, np.array(steps), laws)
    return trials


LAW = LawTest(
    "arm_joint_damping",
    "step response 1 - exp(-t / τ),  τ = k d / stiffness",
    (1.0, 0.5, 3.0),
    run,
    ({"gripper_joint_damping": 0.5}, {"object_mass": 4.0}),
)
