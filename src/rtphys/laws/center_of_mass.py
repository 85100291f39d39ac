"""An off-centre push turns a body, and a bar tips when its balance point passes the edge."""

import numpy as np

from rtphys.core.poses import Array, Pose
from rtphys.laws.lab import Lab, block_inertia, pose_of, pushed_block
from rtphys.laws.law import LawTest, Trial, Values, number
from rtphys.physics.values import Value
from rtphys.sim.body import SimBody
from rtphys.sim.room import TOP_HALF
from rtphys.task.props import TABLE_TOP, Box

FORCE, STEPS = 0.03, 25  # [N] at nominal mass, 0.1 s: the block turns too little to matter
RANGE = 0.015  # [m] the domain's end
BARS, PITCH = 21, 0.025  # bars side by side along the table's edge, [m] apart
BAR = (0.05, 0.008, 0.01)  # [m] half size


def push_at_origin(lab: Lab, values: Values, axis: int) -> Array:
    """Angular acceleration (3,) [rad/s²] of the test block pushed at its origin."""

    def push(body: SimBody) -> None:
        force = [0.0, 0.0, 0.0]
        force[axis] = FORCE * body.mass / body.nominal_mass
        body.component.add_force_at_point(force, pose_of(body).p.tolist())

    return pushed_block(lab, values, STEPS, push)[3:]


def balance_point(lab: Lab, values: Values) -> float:
    """x [m] in a bar's frame of its balance point: the bar stays while that is over the table."""
    low, high = -0.02, 0.02
    # Laid down, not dropped: an impact would turn a bar that only just lies.
    z = TABLE_TOP + BAR[2] * number(values.get("object_scale", 1.0))
    for _ in range(2):  # 2 mm steps, then 0.2 mm steps
        tried = np.linspace(low, high, BARS)
        places = [(TOP_HALF[0] + d, (i - BARS // 2) * PITCH, z) for i, d in enumerate(tried)]
        bars = [
            Box(name=f"bar{i}", pose=Pose(p), half_size=BAR, resting=False)
            for i, p in enumerate(places)
        ]
        world = lab.world(bars, values, steps=200)
        height = np.array([world.to_task(pose_of(b)).p[2] for b in world.bodies])
        stayed = height > TABLE_TOP  # a fallen bar may lie flat again, on the ground
        inner = float(tried[stayed].max()) if stayed.any() else low
        outer = float(tried[~stayed].min()) if not stayed.all() else high
        low, high = inner, outer
    return -(low + high) / 2


def run(lab: Lab, value: Value, others: Values) -> list[Trial]:
    offset = np.asarray(value, float)
    values = {**others, "center_of_mass": value}
    # Force and inertia grow alike with object_mass.
    inertia = block_inertia(number(others.get("object_scale", 1.0)))
    by_x, by_y = (push_at_origin(lab, values, axis) for axis in (0, 1))
    # tau = -offset x F. A push along x turns about y by -z and about z by +y.
    measured = [-by_y[2] * inertia[2], by_x[2] * inertia[2], -by_x[1] * inertia[1]]
    along = (float(offset[0]), 0.0, 0.0)
    point = balance_point(lab, {**values, "center_of_mass": along})
    trials = [
        Trial(f"{axis} from an off-centre push", label, found / FORCE, "m", RANGE)
        for axis, label, found in zip("xyz", offset, measured, strict=True)
    ]
    return [*trials, Trial("balance point on the table's edge", along[0], point, "m", RANGE)]


LAW = LawTest(
    "center_of_mass",
    "α = -I⁻¹ (c × F);  a bar stays while c is over the table",
    ((0.0, 0.0, 0.0), (-0.015,) * 3, (0.015,) * 3),
    run,
    ({"object_mass": 4.0}, {"object_mass": 0.125, "friction": 1.0}),
)
