"""The step response of a servo: without a velocity target it lags by tau = d / k."""

from collections.abc import Callable

import numpy as np

from rtphys.poses import Array
from rtphys.proofs.lab import record
from rtphys.proofs.proof import Trace, Trial
from rtphys.sim.world import World

TOLERANCE = 0.05


def step_response(
    world: World, read: Callable[[], float], full: float, tau: float, what: str
) -> Trial:
    """Time constant of a servo that has just been told to go `full` [rad or m] further.

    Two points of the curve give it, 20 % and 60 %, so that neither the start (the link's inertia)
    nor the end (its weight) matters: for exp(-t / tau) they lie tau ln 2 apart.
    """
    start = read()
    t, q = record(world, int(250 * 4 * max(tau, 0.05)), read)
    share = (q - start) / full
    found = (_crossing(t, share, 0.6) - _crossing(t, share, 0.2)) / np.log(2)
    law = full * (1 - np.exp(-t / tau))
    trace = Trace(t, q - start, law, "time [s]", "way from start [rad or m]")
    return Trial(what, tau, float(found), "s", tolerance=TOLERANCE, trace=trace)


def _crossing(t: Array, share: Array, level: float) -> float:
    """First time [s] at which `share` (n,) reaches `level`, interpolated; nan if never."""
    above = np.nonzero(share >= level)[0]
    if not len(above) or above[0] == 0:
        return float("nan")
    i = above[0]
    part = (level - share[i - 1]) / (share[i] - share[i - 1])
    return float(t[i - 1] + part * (t[i] - t[i - 1]))
