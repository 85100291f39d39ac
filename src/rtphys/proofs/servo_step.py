"""Step response of servos: without a velocity target they lag by tau = damping / stiffness."""

from collections.abc import Callable

import numpy as np

from rtphys.core.poses import Array
from rtphys.proofs.lab import record
from rtphys.proofs.proof import Trace, Trial
from rtphys.sim.engine import RATE
from rtphys.sim.world import World

TOLERANCE = 0.05


def step_response(
    world: World, read: Callable[[], Array], steps: Array, tau: float, names: list[str]
) -> list[Trial]:
    """Time constants of servos (n,) whose targets have just moved by `steps` (n,) [rad or m].

    The time from 20 % to 60 % of the step gives each, which is tau ln 2 for exp(-t / tau). So the
    start of the curve (the link's inertia) and its end do not matter.
    """
    start = np.array(read(), float)
    t, q = record(world, int(RATE * 2 * max(tau, 0.05)), read)
    law = 1 - np.exp(-t / tau)
    trials = []
    for i, name in enumerate(names):
        share = (q[:, i] - start[i]) / steps[i]
        measured = (_crossing(t, share, 0.6) - _crossing(t, share, 0.2)) / np.log(2)
        trace = Trace(t, share, law, "time [s]", "share of the step [1]")
        trials.append(Trial(name, tau, float(measured), "s", tolerance=TOLERANCE, trace=trace))
    return trials


def _crossing(t: Array, share: Array, level: float) -> float:
    """Interpolated time [s] at which `share` (n,) first reaches `level`; nan if it never does."""
    above = np.nonzero(share >= level)[0]
    if not len(above) or above[0] == 0:
        return float("nan")
    i = above[0]
    part = (level - share[i - 1]) / (share[i] - share[i - 1])
    return float(t[i - 1] + part * (t[i] - t[i - 1]))
