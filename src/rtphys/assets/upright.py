"""The fixed joint that every official articulated object begins with."""

import numpy as np

from rtphys.assets.asset_model import Joint
from rtphys.assets.urdf import placed


def upright_joint(root: str, link: str) -> Joint:
    """Stands a y-up link up in the z-up root.

    In the link x is the user's right, +z faces the user; in the root the user is at -x. So a
    root turned by 90 degrees about z faces the robot.
    """
    return Joint("upright", "fixed", root, link, placed((0, 0, 0), (np.pi / 2, 0, -np.pi / 2)))
