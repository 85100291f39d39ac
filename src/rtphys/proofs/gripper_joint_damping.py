"""A finger whose target moves by centimetres follows with the lag tau = k d / stiffness."""

import numpy as np

from rtphys.physics.values import Value
from rtphys.proofs.lab import Lab
from rtphys.proofs.proof import Proof, Trial, Values, number
from rtphys.proofs.servo_step import step_response

OPENING = 0.4  # [1] gripper command: closing from fully open (1) to this


def run(lab: Lab, value: Value, others: Values) -> list[Trial]:
    world = lab.world([], {**others, "gripper_joint_damping": value})
    body, arms = world.robot.embodiment, world.robot.arms
    tau = number(value) * body.gripper_damping / body.gripper_stiffness
    start = np.array([arm.gap() for arm in arms])
    for arm in arms:
        arm.grip(OPENING)
    sign = body.left.finger_signs[0]
    steps = 2 * sign * body.finger_target(OPENING) - start
    names = [f"tau of the {side} fingers" for side in ("left", "right")]
    return step_response(world, lambda: np.array([arm.gap() for arm in arms]), steps, tau, names)


PROOF = Proof(
    "gripper_joint_damping",
    "step response 1 - exp(-t / τ),  τ = k d / stiffness",
    (1.0, 0.5, 3.0),
    run,
    ({"arm_joint_damping": 3.0}, {"friction": 1.25}),
)
