"""A finger that is sent 2 cm further lags by tau = k d / stiffness."""

from rtphys.physics.values import Value
from rtphys.proofs.lab import Lab
from rtphys.proofs.proof import Company, Proof, Trial, number
from rtphys.proofs.servo_step import step_response

OPENING = 0.4  # closing from fully open to here


def run(lab: Lab, value: Value, company: Company) -> list[Trial]:
    trials = []
    for side in ("left", "right"):
        world = lab.world([], {**company, "gripper_joint_damping": value})
        arm, body = world.robot.arm(side), world.robot.embodiment
        tau = number(value) * body.gripper_damping / body.gripper_stiffness
        start = arm.gap()
        arm.grip(OPENING)
        way = 2 * body.finger_target(OPENING) - start
        trials.append(step_response(world, arm.gap, way, tau, f"tau of the {side} fingers"))
    return trials


PROOF = Proof(
    "gripper_joint_damping",
    "step response 1 - exp(-t / τ),  τ = k d / stiffness",
    (1.0, 0.5, 3.0),
    run,
    ({"arm_joint_damping": 3.0}, {"friction": 1.25}),
)
