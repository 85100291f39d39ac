"""An arm joint that is sent 0.1 rad further without a speed lags by tau = k d / stiffness."""

import numpy as np

from rtphys.physics.values import Value
from rtphys.proofs.lab import Lab
from rtphys.proofs.proof import Company, Proof, Trial, number
from rtphys.proofs.servo_step import step_response

STEP = 0.1  # [rad]


def run(lab: Lab, value: Value, company: Company) -> list[Trial]:
    trials = []
    for side in ("left", "right"):
        for joint in range(6):
            world = lab.world([], {**company, "arm_joint_damping": value})
            arm = world.robot.arm(side)
            body = world.robot.embodiment
            tau = number(value) * body.joint_damping / body.joint_stiffness
            target = np.array(arm.target)
            # Towards the middle of the joint's range, so that no limit stops it.
            way = STEP if target[joint] <= 0 else -STEP
            target[joint] += way
            arm.command(target, np.zeros(6))
            index = int(arm.index[joint])
            read = _reader(world, index)
            trials.append(step_response(world, read, way, tau, f"tau of {side} joint {joint + 1}"))
    return trials


def _reader(world, index: int):
    return lambda: float(world.robot.articulation.qpos[index])


PROOF = Proof(
    "arm_joint_damping",
    "step response 1 - exp(-t / τ),  τ = k d / stiffness",
    (1.0, 0.5, 3.0),
    run,
    ({"gripper_joint_damping": 0.5}, {"object_mass": 4.0}),
)
