"""How fast a loaded hand may move: slower when friction is low for the weight it holds."""

import numpy as np

from rtphys.physics.handles import GRAVITY
from rtphys.sim.world import World

GRIP_STIFFNESS = 1000.0  # [N/m] of a finger's servo (official config)
OVERCLOSE = 0.01  # [m] a closed command lies 1 cm inside, so an empty hand still presses 10 N


def grip_force(gap: float) -> float:
    """Normal force of one finger on a thing that keeps the pads `gap` [m] apart [N]."""
    return GRIP_STIFFNESS * (gap / 2 + OVERCLOSE)


def friction_margin(world: World, prop: str, gaps: list[float]) -> float:
    """Largest friction the hands can exert over the thing's weight, 1: it just holds."""
    bodies = world.object(prop).bodies
    weight = sum(b.mass for b in bodies) * GRAVITY
    mu = min((m[0] for s in world.robot.pads for m in s.materials()), default=0.5)
    return sum(2 * mu * grip_force(gap) for gap in gaps) / max(weight, 1e-6)


def pace_of(margin: float) -> float:
    """Share of the usual speed for a friction margin: full from 5 on, a third at the limit."""
    return float(np.interp(margin, [1.2, 5.0], [0.35, 1.0]))
