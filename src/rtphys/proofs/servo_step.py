"""The step response of servos: without a velocity target they lag by tau = d / k."""

from collections.abc import Callable

import numpy as np

from rtphys.core.poses import Array
from rtphys.proofs.lab import record
from rtphys.proofs.proof import Trace, Trial
from rtphys.sim.engine import RATE
from rtphys.sim.world import World

TOLERANCE = 0.05


def step_response(
    world: World, read: Callable[[], Array], ways: Array, tau: float, names: list[str]
) -> list[Trial]:
    """Time constants of servos (n,) that have just been told to go `ways` [rad or m] further.

    Two points of the curve give each, 20 % and 60 %, so that neither the start (the link's
    inertia) nor the end matters: for exp(-t / tau) they lie tau ln 2 apart.
    """
    start = np.array(read(), float)
    t, q = record(world, int(RATE * 2 * max(tau, 0.05)), read)
    law = 1 - np.exp(-t / tau)
    trials = []
    for i, name in enumerate(names):
        share = (q[:, i] - start[i]) / ways[i]
        found = (_crossing(t, share, 0.6) - _crossing(t, share, 0.2)) / np.log(2)
        trace = Trace(t, share, law, "time [s]", "share of the way [1]")
        trials.append(Trial(name, tau, float(found), "s", tolerance=TOLERANCE, trace=trace))
    return trials


def _crossing(t: Array, share: Array, level: float) -> float:
    """First time [s] at which `share` (n,) reaches `level`, interpolated; nan if never."""
    above = np.nonzero(share >= level)[0]
    if not len(above) or above[0] == 0:
        return float("nan")
    i = above[0]
    part = (level - share[i - 1]) / (share[i] - share[i - 1])
    return float(t[i - 1] + part * (t[i] - t[i - 1]))
