"""Round feet: the points on which an object stands, so that its friction is Coulomb's.

PhysX spreads the friction of a flat contact evenly over two of its points, however the load is
spread: with its centre of mass aside a body slips early and turns. A sphere touches at one point,
which bears friction by its own load, so a body that stands on spheres slips as it should.
"""

from collections.abc import Iterable
from itertools import product

import numpy as np
import scipy  # whose parts are loaded when they are first used
from sapien import physx

from rtphys.core.poses import Array, Pose
from rtphys.sim.body import FOOT_RADIUS, body_points, is_foot, own_shapes
from rtphys.sim.engine import AnyBody, from_sapien, to_sapien

PROUD = 5e-6  # [m] that a foot stands out of the face: it bears all, and nobody sees it
INSET = FOOT_RADIUS + 2e-4  # [m] from the face's edges: nothing touches a foot from aside
# Of the way from the face's middle: what stands on less than its own size has feet there, too.
RINGS = (1.0, 0.8, 0.5)
FLAT = 1e-4  # [m] a vertex so near to the lowest one belongs to the face on which the body stands
MIN_WIDTH = 0.01  # [m] of that face: what stands on less rocks or rolls

# Bits of SAPIEN's collision groups: feet meet what feels them, and nothing else.
_ON_TABLE = [2, 2, 0, 0]
_ON_OBJECTS = [4, 4, 0, 0]
_TABLE = [3, 3, 0, 0]
_OBJECT = [5, 5, 0, 0]
# [m] from an object's surface at which a foot is foreseen: a step at 2.5 m/s. What falls is else
# millimetres deep in one step, and a foot in a thin floor is shot out on its other side.
FORESEEN = 0.01


def feel_feet(shapes: Iterable[physx.PhysxCollisionShape], table: bool = False) -> None:
    """Let shapes bear feet beside all else; the table, too thick to fall through, has its own."""
    for shape in shapes:
        shape.set_collision_groups(_TABLE if table else _OBJECT)


def add_feet(body: AnyBody, up: Array) -> None:
    """Put feet under the face on which a body stands; none where that face is narrow.

    Args:
        body: at its pose, with all its own shapes.
        up: unit normal (3,) of what it stands on, world frame.
    """
    down = -from_sapien(body.entity_pose).R.T @ up
    across = np.linalg.svd(down[None])[2][1:]  # (2, 3) two axes of the face
    points = body_points(body)
    depth = points @ down
    lowest = depth.max()
    outer = footing(points[depth > lowest - FLAT] @ across.T)
    middle = outer.mean(axis=0) if len(outer) else np.zeros(2)
    on_objects = [middle + share * (spot - middle) for share, spot in product(RINGS, outer)]
    for at, groups in [
        *((at, _ON_TABLE) for at in outer),
        *((at, _ON_OBJECTS) for at in on_objects),
    ]:
        shape = physx.PhysxCollisionShapeSphere(FOOT_RADIUS, physx.get_default_material())
        centre = at @ across + (lowest + PROUD - FOOT_RADIUS) * down
        shape.set_local_pose(to_sapien(Pose(centre, (1, 0, 0, 0))))
        shape.set_density(0.0)
        shape.set_collision_groups(groups)
        if groups is _ON_OBJECTS:
            shape.set_contact_offset(FORESEEN)
        body.attach(shape)


def has_feet(body: AnyBody) -> bool:
    """Whether `add_feet` found a face to put feet under."""
    return len(own_shapes(body)) < len(body.collision_shapes)


BORNE = 0.05  # of what bears an object, by shapes other than its feet: it does not stand on feet


def off_feet(body: AnyBody, contacts: Iterable[physx.PhysxContact]) -> bool:
    """Whether something bears a body, and not by its feet.

    Args:
        contacts: of the last step; those of whatever holds it left out.
    """
    on_feet = beside = 0.0
    for contact in contacts:
        if body not in contact.bodies:
            continue
        i = contact.bodies.index(body)  # impulses act on the first of the two
        up = (1 - 2 * i) * sum(float(point.impulse[2]) for point in contact.points)
        if up > 0 and is_foot(contact.shapes[i]):
            on_feet += up
        elif up > 0:
            beside += up
    return beside > BORNE * (on_feet + beside)


def footing(face: Array) -> Array:
    """Places (k, 2) of the feet under a face with these points (n, 2) [m]; none if narrow."""
    try:
        corners = face[scipy.spatial.ConvexHull(face).vertices]  # counter-clockwise
    except (scipy.spatial.QhullError, ValueError):  # a point or a line
        return np.empty((0, 2))
    corners = _largest_four(corners)
    along = np.roll(corners, -1, axis=0) - corners
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    inward = np.c_[-along[:, 1], along[:, 0]]
    reach = (corners @ inward.T - (corners * inward).sum(1)).max(0)  # from each edge
    if reach.min() < MIN_WIDTH:
        return np.empty((0, 2))
    # A foot lies INSET from both edges that meet in its corner.
    before = np.roll(inward, 1, axis=0)
    middle = before + inward
    return corners + INSET * middle / (1 + (before * inward).sum(1, keepdims=True))


def _largest_four(corners: Array) -> Array:
    """Those four corners of a convex polygon (n, 2) that span the largest area; all, if n < 5."""
    n = len(corners)
    if n < 5:
        return corners
    best, chosen = 0.0, (0, 1, 2, 3)
    for i in range(n - 2):
        for j in range(i + 2, n):
            (x, y), off = corners[j] - corners[i], corners - corners[i]
            height = x * off[:, 1] - y * off[:, 0]  # times the diagonal's length, left positive
            left, right = int(np.argmax(height)), int(np.argmin(height))
            if height[left] - height[right] > best * (1 + 1e-9):
                best, chosen = float(height[left] - height[right]), (i, right, j, left)
    return corners[sorted(chosen)] if len(set(chosen)) == 4 else corners[:4]
