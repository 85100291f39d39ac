"""Turns joints with a constant torque: what inertia does not take, damping times the way does."""

from collections.abc import Mapping

import numpy as np

from rtphys.proofs.measure.finding import Finding, Measurement
from rtphys.proofs.measure.mechanism import Mechanism
from rtphys.proofs.measure.specimen import Specimen
from rtphys.sim.engine import TIME_STEP

STEPS = 25
WAY = 0.1  # [1] of half the joint's range that the torque should turn it by
LONGEST = 0.05  # [rad or m] and this at most


def damp(specimen: Specimen, mechanism: Mechanism, nominal: Mapping[str, float]) -> list[Finding]:
    """The damping of each joint [N m s/rad or N s/m]; `nominal` is what the files state."""
    findings: list[Finding] = []
    for index, joint in enumerate(mechanism.joints):
        value = specimen.values.get("object_joint_damping")
        label = nominal[joint.name] if value is None else specimen.number("object_joint_damping")
        place = f"{mechanism.thing.name}/{joint.name}"
        measured = _damping(mechanism, index, label)
        findings.append(Measurement("object_joint_damping", place, label, measured))
    return findings


def _damping(mechanism: Mechanism, index: int, label: float) -> float:
    """From the balance of momentum: torque * time = M v + damping * way.

    Under heavy damping PhysX's speed at a step's end is not the one at which the joint moved in
    it, but it is the one that this balance needs, and the way is measured.
    """
    art, dof = mechanism.art, mechanism.loose + index
    M, seconds = mechanism.mass_matrix(), STEPS * TIME_STEP
    inertia = 1 / np.linalg.inv(M)[dof, dof]
    low, high = np.clip(np.asarray(art.qlimits, float)[index], -1.0, 1.0)
    way = min(WAY * (high - low) / 2, LONGEST)
    torque = way * (label / seconds + 2 * inertia / seconds**2)
    mechanism.rest()
    start = float(art.qpos[index])
    for _ in range(STEPS):
        mechanism.push(dof, torque)
        mechanism.world.step()
    moved = float(art.qpos[index]) - start
    if moved == 0:
        return float("inf")
    return float((torque * seconds - M[dof] @ mechanism.velocities()) / moved)
