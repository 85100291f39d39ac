"""TOPP-RA on a grid, rest to rest: the two passes of toppra's algorithm over toppra's own solver.

toppra's `TOPPRA` does the same and gives the same bits. But it describes every limit in words and
looks for other solvers each time, and that costs more than solving.
"""

from math import isnan

import numpy as np
from toppra.constraint import (
    DiscretizationType,
    JointAccelerationConstraint,
    JointVelocityConstraint,
    LinearConstraint,
)
from toppra.interpolator import AbstractGeometricPath
from toppra.solverwrapper.cy_seidel_solverwrapper import (
    seidelWrapper,  # pyright: ignore[reportMissingImports]  (compiled)
)

from rtphys.core.poses import Array
from rtphys.plan.trajectory import JointLimits

# Of toppra's numerical safeguards.
_TINY = 1e-8
_SMALL = 1e-5
_TRIES = 10  # to slow down by a thousandth where rounding leaves no way on


class _Velocity(JointVelocityConstraint):
    def __init__(self, limits: Array) -> None:
        LinearConstraint.__init__(self)
        self.vlim, self.dof = np.stack([-limits, limits], 1), len(limits)


class _Acceleration(JointAccelerationConstraint):
    def __init__(self, limits: Array) -> None:
        LinearConstraint.__init__(self)
        self.alim, self.dof = np.stack([-limits, limits], 1), len(limits)
        self.set_discretization_type(DiscretizationType.Interpolation)
        self.identical = True


def fastest(path: AbstractGeometricPath, grid: Array, limits: JointLimits) -> Array | None:
    """The highest speed along a path at each point of a grid, at rest at both ends.

    Args:
        path: of d joints, over lengths s.
        grid: (n + 1,) rising lengths from the path's first to its last [rad].
        limits: of the d joints.

    Returns:
        (n + 1,) ds/dt [rad/s], or None when there is none.
    """
    constraints = [_Velocity(limits.velocity), _Acceleration(limits.acceleration)]
    solver = seidelWrapper(constraints, path, grid, solve_lp1d=True)
    controllable = _controllable(solver, len(grid) - 1)
    if controllable is None or controllable[0][0] > _SMALL or controllable[0][1] + _SMALL < 0:
        return None
    return _forward(solver, np.diff(grid).tolist(), controllable)


def _controllable(solver: seidelWrapper, n: int) -> list[tuple[float, float]] | None:
    """Least and largest squared speeds at each grid point from which the end can be reached."""
    up, down = np.array([1e-9, -1.0]), np.array([-1e-9, 1.0])
    low = high = 0.0
    bounds = [(low, high)]
    for i in range(n - 1, -1, -1):
        after = low, high
        high = float(solver.solve_stagewise_optim(i, None, up, np.nan, np.nan, *after)[1])
        low = float(solver.solve_stagewise_optim(i, None, down, np.nan, np.nan, *after)[1])
        if isnan(low) or isnan(high):
            return None
        low = max(low, 0.0)
        bounds.append((low, high))
    return bounds[::-1]


def _forward(
    solver: seidelWrapper, steps: list[float], controllable: list[tuple[float, float]]
) -> Array | None:
    """As fast as possible from point to point, within what is controllable."""
    squares, tries = [0.0], 0
    aim = np.array([0.0, -1.0])
    while len(squares) <= len(steps):
        i, x = len(squares) - 1, squares[-1]
        low, high = controllable[i + 1]
        aim[0] = -2 * steps[i]
        u = float(solver.solve_stagewise_optim(i, None, aim, x, x, low, high)[0])
        if isnan(u):
            if tries == _TRIES:
                return None
            squares[-1] = max(x - _TINY, 0.999 * x)
            tries += 1
            continue
        tries = 0
        x += 2 * steps[i] * u
        x = max(x - _TINY, 0.9999 * x)
        squares.append(min(high, max(low, x)))
    return np.sqrt(squares)
