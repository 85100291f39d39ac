"""A door pushed once slows as exp(-d t / I); one that is pushed on moves at tau / d."""

import numpy as np

from rtphys.core.poses import Pose
from rtphys.laws.lab import Lab, record
from rtphys.laws.law import LawTest, Trial, Values
from rtphys.physics.values import Value
from rtphys.sim.engine import TIME_STEP, from_sapien
from rtphys.task.props import Articulated

TOLERANCE = 0.05
OPENING = 0.4  # [1] initial position in the joint's range: room to coast in both directions
COAST = 0.02  # [rad or m] coasting distance of a heavily damped joint, if its speed may be so high
FASTEST = 20.0  # [rad/s or m/s] highest initial speed, well below the simulator's own limit
SPEED = 0.3  # [rad/s or m/s] initial speed of a lightly damped joint
STEPS = 50  # recorded
ROOM = 0.8  # [1] of the distance to the joint's limit that it may use
SETTLED, LONGEST = 6, 600  # time constants until the speed is the last one; steps for that
CLEAR_DECAY = 0.05  # [1] d dt / I above which a step is too coarse to measure the decay


class Hinge:
    """One joint of an articulated object that floats without gravity in a world of its own."""

    def __init__(self, lab: Lab, category: str, values: Values, index: int) -> None:
        prop = Articulated(
            name=category,
            pose=Pose((0, 0.1, 1.2)),
            category=category,
            model=lab.pack.indices(category)[0],
            fixed=True,
            resting=False,
            opening=OPENING,
        )
        self.world = lab.world([prop], values)
        for body in self.world.bodies:
            body.component.set_disable_gravity(True)
        thing = next(iter(self.world.objects.values()))
        assert thing.articulation is not None
        self.art, self.index, self.count = thing.articulation, index, len(thing.joints)
        joint, label = thing.joints[index], values["object_joint_damping"]
        self.name, self.unit = joint.name, "rad" if joint.kind == "revolute" else "m"
        self.damping = float(label) if isinstance(label, int | float) else joint.nominal_damping
        self.inertia = inertia_about(joint.joint)
        # A pot's lid travels millimetres, and a joint that hits its limit shows no damping.
        self.room = ROOM * float(self.art.qlimits[index][1] - self.art.qpos[index])

    def coast(self) -> Trial:
        """Give it a speed and compare how far it coasts, or its decay, with the law."""
        art, index, rate = self.art, self.index, self.damping / self.inertia
        slow = rate * TIME_STEP < CLEAR_DECAY
        heavy = min(COAST, self.room) * rate
        speed = min(SPEED, self.room / (STEPS * TIME_STEP)) if slow else min(heavy, FASTEST)
        qvel = np.zeros(art.dof, np.float32)
        qvel[index] = speed
        art.set_qvel(qvel)
        start = float(art.qpos[index])
        t, recorded = record(self.world, STEPS, lambda: (art.qpos[index] - start, art.qvel[index]))
        if not slow:
            name, way = f"coasting of {self.name}", float(recorded[-1, 0])
            return Trial(name, speed / rate, way, self.unit, 0, TOLERANCE)
        fast = recorded[:, 1] > 0.02 * speed
        fit = np.polyfit(t[fast], np.log(recorded[fast, 1]), 1) if fast.sum() > 2 else [np.nan]
        return Trial(f"decay of {self.name}", rate, -float(fit[0]), "1/s", 1.0, TOLERANCE)

    def terminal(self) -> Trial | None:
        """Push it with a constant torque; None where its last speed is too far off.

        The speed is that of its displacement. PhysX tells the velocity of the last sub-step, which
        is wrong under heavy damping: it adds the whole step's torque before the first sub-step.
        """
        art, index = self.art, self.index
        if self.damping * LONGEST * TIME_STEP < SETTLED * self.inertia:
            return None
        steps = int(SETTLED * self.inertia / self.damping / TIME_STEP) + STEPS
        speed = self.room / (steps * TIME_STEP)
        torques = np.zeros(art.dof, np.float32)
        torques[index] = speed * self.damping
        _, q = record(self.world, steps, lambda: art.qpos[index], lambda: art.set_qf(torques))
        reached = float(q[-1] - q[-1 - STEPS // 2]) / (STEPS // 2 * TIME_STEP)
        name, unit = f"terminal speed of {self.name}", f"{self.unit}/s"
        return Trial(name, speed, reached, unit, 0, TOLERANCE)


def inertia_about(joint) -> float:
    """Inertia of all links behind a joint: [kg m²] if it is revolute, [kg] if prismatic.

    Parallel axis theorem: the sum over links of u·I u + m r², with r from the axis to its CoM.
    `joint` is a SAPIEN articulation joint, whose axis is x of its global pose.
    """
    links = [joint.child_link]
    for link in links:  # which grows by all that is behind it
        links += link.children
    if joint.type == "prismatic":
        return float(sum(link.mass for link in links))
    X = from_sapien(joint.get_global_pose())
    axis, total = X.R[:, 0], 0.0
    for link in links:
        X_WC = from_sapien(link.entity_pose) @ from_sapien(link.cmass_local_pose)
        u, arm = X_WC.R.T @ axis, X_WC.p - X.p
        off = arm - (arm @ axis) * axis
        total += float(u**2 @ np.asarray(link.inertia, float) + link.mass * (off @ off))
    return total


def run(lab: Lab, value: Value, others: Values) -> list[Trial]:
    values, trials = {**others, "object_joint_damping": value}, list[Trial | None]()
    for category in filter(lab.pack.is_articulated, lab.pack.names):
        for index in range(Hinge(lab, category, values, 0).count):
            trials.append(Hinge(lab, category, values, index).coast())
            trials.append(Hinge(lab, category, values, index).terminal())
    return [*filter(None, trials)]


LAW = LawTest(
    "object_joint_damping",
    "speed ∝ exp(-d t / I),  coasting distance = I ω / d,  terminal speed = τ / d",
    (None, 0.0, 0.01, 0.25, 2.0, 25.0),
    run,
    ({"object_mass": 4.0}, {"object_mass": 0.5, "object_scale": 1.05}),
)
