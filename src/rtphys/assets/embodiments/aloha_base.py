"""Scenery of the machine: wheeled base, frame, camera tower, rear arms (as in aloha_arm)."""

from rtphys.assets.asset_model import Part
from rtphys.assets.embodiments.aloha_arm import ACCENT, MOTOR, PAD, SHELL, STEEL, Shape, drum
from rtphys.assets.geometry import box, rounded_box
from rtphys.assets.material import plastic
from rtphys.assets.solid import together

BODY = plastic((0.20, 0.21, 0.24), 0.5)

# The table's edge is 0.30 m ahead of the footprint (base at y = -0.65, table from y = -0.35):
# nothing here may reach x = 0.29.
FRONT = 0.285


def mobile_base() -> Shape:
    """Wheeled chassis and the extrusion frame that carries the arms. Origin 0.15 above ground."""
    chassis = rounded_box(0.63, 0.56, 0.20, 0.03, 1).at(-0.03, 0, 0)
    stripe = box(0.012, 0.40, 0.03).at(FRONT - 0.004, 0, 0.04)
    wheels = [drum("y", 0.08, 0.05, 16).at(-0.03, dy, -0.07) for dy in (-0.27, 0.27)]
    castors = [
        drum("y", 0.04, 0.03, 10).at(x, dy, -0.11) for x in (-0.27, 0.20) for dy in (-0.2, 0.2)
    ]
    posts = [
        box(0.04, 0.04, z).at(x, dy, 0.10 + z / 2)
        for x, z in ((0.235, 0.512), (-0.309, 0.632))
        for dy in (-0.305, 0.305)
    ]
    rails = [
        box(0.04, 0.65, 0.04).at(0.235, 0, 0.592),
        box(0.04, 0.65, 0.04).at(-0.309, 0, 0.712),
        box(0.04, 0.65, 0.04).at(0.235, 0, 0.12),
        box(0.04, 0.65, 0.04).at(-0.309, 0, 0.12),
        *(box(0.52, 0.04, 0.04).at(-0.04, dy, 0.592) for dy in (-0.305, 0.305)),
    ]
    cabinet = rounded_box(0.34, 0.46, 0.32, 0.02, 1).at(-0.06, 0, 0.27)
    parts = (
        Part(together(chassis, cabinet), BODY),
        Part(stripe, ACCENT),
        Part(together(*wheels, *castors), PAD),
        Part(together(*posts, *rails), STEEL, "aluminium"),
    )
    front = box(0.045, 0.66, 0.06).at(0.235, 0, 0.585)
    column = box(0.045, 0.66, 0.50).at(0.235, 0, 0.31)
    return parts, (chassis, front, column)


def tower() -> Shape:
    """Column that carries the head camera, kept behind the camera's lens."""
    column = box(0.045, 0.060, 0.66).at(-0.062, 0, 0.31)
    foot = rounded_box(0.10, 0.16, 0.03, 0.004, 1).at(-0.045, 0, -0.010)
    beam = box(0.045, 0.06, 0.04).at(-0.062, 0, -0.03)
    parts = (Part(together(column, beam), STEEL, "aluminium"), Part(foot, SHELL))
    return parts, (column,)


def tower_camera() -> Shape:
    """A depth camera on the tower; its frame looks along x."""
    body = rounded_box(0.025, 0.090, 0.025, 0.006, 1).at(-0.045, 0, 0)
    arm = box(0.04, 0.02, 0.012).at(-0.07, 0, 0)
    return (Part(together(body, arm), MOTOR),), ()


def rear_arm() -> Shape:
    """A leader arm at rest: only seen from afar, never moved."""
    motors = [
        drum("z", 0.03, 0.06, 10).at(0, 0, 0.03),
        drum("y", 0.027, 0.06, 10).at(0.02, 0, 0.10),
        drum("y", 0.027, 0.06, 10).at(-0.24, 0, 0.10),
        drum("y", 0.024, 0.05, 10).at(0.0, 0, 0.165),
    ]
    beams = [
        rounded_box(0.24, 0.045, 0.04, 0.008, 1).at(-0.11, 0, 0.10),
        rounded_box(0.21, 0.045, 0.04, 0.008, 1).at(-0.11, 0, 0.16),
        box(0.03, 0.04, 0.06).at(-0.225, 0, 0.13),
    ]
    handle = rounded_box(0.10, 0.03, 0.03, 0.006, 1).at(0.06, 0, 0.165)
    parts = (Part(together(*motors), MOTOR), Part(together(*beams), SHELL), Part(handle, ACCENT))
    return parts, ()
