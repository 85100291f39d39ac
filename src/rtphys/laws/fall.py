"""How an object rebounds from the table, as fast as things in episodes fall."""

import numpy as np

from rtphys.laws.lab import launch, pose_of
from rtphys.physics.handles import GRAVITY
from rtphys.sim.body import SimBody
from rtphys.sim.engine import TIME_STEP, to_sapien
from rtphys.sim.world import World

SPEEDS = (0.3, 0.5, 1.0, 2.0)  # [m/s] at the impact
PHASES = 6  # places between two steps at which the impact falls
STRAIGHT = [True, True, False, True, True, True]  # it falls without turning
SETTLE = 50  # [steps] until an object stands


def rebounds(world: World, body: SimBody, speed: float, e: float) -> list[float]:
    """Two coefficients [1] of each of PHASES impacts: by speeds and by heights.

    The body must stand on the table or a little above it. It falls straight, without turning,
    wherever its centre of mass is.
    """
    rigid = body.component
    rigid.set_locked_motion_axes(STRAIGHT)  # pyright: ignore[reportAttributeAccessIssue]
    for _ in range(SETTLE):
        world.step()
    home, found = pose_of(body), list[float]()
    for phase in range(PHASES):
        gap = speed * TIME_STEP * (1 + phase / PHASES)
        rigid.entity.set_pose(to_sapien(home.moved((0.0, 0.0, gap))))
        launch(body, (0, 0, -np.sqrt(max(0.0, speed**2 - 2 * GRAVITY * gap))))
        z, v = list[float](), list[float]()
        for _ in range(int((gap / speed + e * speed / GRAVITY) / TIME_STEP) + 5):
            world.step()
            z.append(float(pose_of(body).p[2] - home.p[2]))
            v.append(float(rigid.linear_velocity[2]))
        back = int(np.argmax(np.array(v) > 0)) if max(v) > 0 else len(v) - 1
        height = max(0.0, *z[back:])
        found += [max(0.0, *v[back:]) / speed, float(np.sqrt(2 * GRAVITY * height)) / speed]
    return found
