"""Inertia that a joint moves: mass along a slide, moment of inertia about a hinge."""

import numpy as np
from numpy.typing import NDArray

from rtphys.sim.engine import from_sapien


def inertia_about(joint) -> float:
    """Inertia of all links behind a joint: [kg m²] if it is revolute, [kg] if prismatic.

    Parallel axis theorem: the sum over links of u·I u + m r², with r from the axis to its CoM.
    `joint` is a SAPIEN articulation joint, whose axis is x of its global pose.
    """
    links = _behind(joint.child_link)
    if joint.type == "prismatic":
        return float(sum(link.mass for link in links))
    X = from_sapien(joint.get_global_pose())
    axis, point = X.R[:, 0], X.p
    total = 0.0
    for link in links:
        X_WL, X_LC = from_sapien(link.entity_pose), from_sapien(link.cmass_local_pose)
        u: NDArray[np.float64] = (X_WL.R @ X_LC.R).T @ axis
        arm = X_WL.p + X_WL.R @ X_LC.p - point
        off = arm - (arm @ axis) * axis
        total += float(u**2 @ np.asarray(link.inertia, float) + link.mass * (off @ off))
    return total


def _behind(link) -> list:
    """A link and all links behind it."""
    return [link, *(deeper for child in link.children for deeper in _behind(child))]
