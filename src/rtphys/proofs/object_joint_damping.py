"""A door pushed once and left alone: it slows as exp(-d t / I) and coasts I omega / d."""

import numpy as np

from rtphys.core.poses import Array, Pose
from rtphys.physics.values import Value
from rtphys.proofs.hinge import inertia_about
from rtphys.proofs.lab import Lab, record
from rtphys.proofs.proof import Company, Proof, Trace, Trial
from rtphys.sim.body import SimJoint
from rtphys.sim.world import World
from rtphys.task.props import Articulated

TOLERANCE = 0.05
OPENING = 0.4  # preset of the joint, a share of its range: room to coast both ways
COAST = 0.02  # [rad or m] that the law gives a heavily damped joint, unless that needs more than
FASTEST = 20.0  # [rad/s or m/s], well below the simulator's own limit on joint speeds
SPEED = 0.3  # [rad/s or m/s] of a lightly damped one
STEPS = 50  # that are watched
ROOM = 0.8  # of the way to the stop
CLEAR_DECAY = 0.05  # d dt / I: above it, a step is too coarse to watch the decay


def run(lab: Lab, value: Value, company: Company) -> list[Trial]:
    values = {**company, "object_joint_damping": value}
    trials: list[Trial] = []
    for category in lab.pack.names:
        if lab.pack.is_articulated(category):
            world = _stand(lab, category, values)
            joints = range(len(world.joints))
            trials += [_coast(_stand(lab, category, values), i, value) for i in joints]
    return trials


def _stand(lab: Lab, category: str, values: Company) -> World:
    """One articulated object in the air, without gravity."""
    model = lab.pack.indices(category)[0]
    pose = Pose((0, 0.1, 1.2))
    prop = Articulated(
        name=category, pose=pose, category=category, model=model, fixed=True, resting=False,
        opening=OPENING,
    )  # fmt: skip
    world = lab.world([prop], values)
    for body in world.bodies:
        body.component.set_disable_gravity(True)
    return world


def _coast(world: World, index: int, value: Value) -> Trial:
    """Push one joint, watch it alone."""
    thing = next(iter(world.objects.values()))
    joint: SimJoint = thing.joints[index]
    damping = float(value) if isinstance(value, int | float) else joint.nominal_damping
    inertia = inertia_about(joint.joint)
    slow = damping * world.scene.timestep / inertia < CLEAR_DECAY
    art = thing.articulation
    assert art is not None
    # A pot's lid travels millimetres: what hits its stop says nothing about damping.
    room = ROOM * float(art.qlimits[index][1] - art.qpos[index])
    seconds = STEPS * world.scene.timestep
    heavy = min(COAST, room) * damping / inertia
    speed = min(SPEED, room / seconds) if slow else min(heavy, FASTEST)
    qvel = np.zeros(art.dof)
    qvel[index] = speed
    art.set_qvel(qvel.astype(np.float32))
    start = float(art.qpos[index])
    t, seen = record(world, STEPS, lambda: (art.qpos[index] - start, art.qvel[index]))
    if slow:
        return _decay(joint, t, seen, (speed, damping / inertia))
    law = speed * inertia / damping * (1 - np.exp(-damping / inertia * t))
    trace = Trace(t, seen[:, 0], law, "time [s]", f"way of {joint.name}")
    unit = "rad" if joint.kind == "revolute" else "m"
    way, full = float(seen[-1, 0]), speed * inertia / damping
    return Trial(f"coasting of {joint.name}", full, way, unit, 0, TOLERANCE, trace=trace)


def _decay(joint: SimJoint, t: Array, seen: Array, law: tuple[float, float]) -> Trial:
    """Rate of decay [1/s] of the speed, by least squares of its logarithm."""
    speed, rate = law
    kept = seen[:, 1] > 0.02 * speed
    found = -float(np.polyfit(t[kept], np.log(seen[kept, 1]), 1)[0]) if kept.sum() > 2 else np.nan
    line = speed * np.exp(-rate * t)
    trace = Trace(t, seen[:, 1], line, "time [s]", f"speed of {joint.name}")
    return Trial(f"decay of {joint.name}", rate, found, "1/s", 1.0, TOLERANCE, trace=trace)


PROOF = Proof(
    "object_joint_damping",
    "speed ∝ exp(-d t / I),  coasting way = I ω / d",
    (None, 0.0, 0.01, 0.25, 25.0),
    run,
    ({"object_mass": 4.0}, {"object_mass": 0.5, "object_scale": 1.05}),
)
