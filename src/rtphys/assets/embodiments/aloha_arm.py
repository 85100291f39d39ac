"""Shapes of one arm, each in its link frame: what is drawn and what collides.

Every function returns (visible parts, convex collision parts). Collision bodies keep gaps to those
of links that are no direct neighbours: only parent and child are exempt from contact.
"""

from rtphys.assets.asset_model import Part
from rtphys.assets.geometry import box, cylinder, extrude, rounded_box
from rtphys.assets.material import matt, metal, plastic
from rtphys.assets.solid import Solid, hull, together

Shape = tuple[tuple[Part, ...], tuple[Solid, ...]]

SHELL = plastic((0.83, 0.84, 0.86), 0.45)  # painted covers
MOTOR = plastic((0.13, 0.13, 0.15), 0.4)  # joint housings
STEEL = metal((0.62, 0.63, 0.66))
PAD = matt((0.08, 0.08, 0.09))  # rubber of the fingertips
ACCENT = plastic((0.85, 0.32, 0.08), 0.4)

SIDES = 14  # of a joint housing


def drum(axis: str, radius: float, length: float, sides: int = SIDES) -> Solid:
    """A cylinder about x, y or z, centred."""
    turned = {"x": ("z", 90.0), "y": ("y", 0.0), "z": ("x", 90.0)}[axis]
    return cylinder(radius, length, sides).turned(*turned)


def base() -> Shape:
    """Foot of the arm, bolted to the frame."""
    foot = rounded_box(0.085, 0.085, 0.012, 0.003, 1).at(0, 0, 0.004)
    column = drum("z", 0.03, 0.05).at(0, 0, 0.034)
    parts = (Part(foot, STEEL, "aluminium"), Part(column, MOTOR))
    return parts, (drum("z", 0.03, 0.056, 10).at(0, 0, 0.028),)


def shoulder() -> Shape:
    """Turret with the shoulder motor."""
    turret = drum("z", 0.029, 0.018).at(0, 0, 0.010)
    neck = rounded_box(0.044, 0.034, 0.034, 0.004, 1).at(0.016, 0, 0.026)
    motor = drum("y", 0.026, 0.044).at(0.025, 0, 0.042)
    looks = Part(together(turret, motor), MOTOR), Part(neck, SHELL)
    return looks, (hull([*turret.vertices, *motor.vertices]),)


def upper_arm() -> Shape:
    """From the shoulder (origin) back to the elbow at x = -0.264."""
    ends = [(-0.264, 0.0045), (0.0, 0.0)]
    cap = [drum("y", 0.029, 0.011).at(0.0, dy) for dy in (-0.0285, 0.0285)]
    elbow = drum("y", 0.028, 0.044).at(*ends[0])
    cheek = [box(0.062, 0.009, 0.034).at(-0.03, dy, 0) for dy in (-0.0285, 0.0285)]
    beam = rounded_box(0.195, 0.050, 0.042, 0.009, 2).at(-0.140, 0.002, 0)
    parts = (
        Part(together(*cap, elbow), MOTOR),
        Part(together(beam, *cheek), SHELL),
    )
    solid = box(0.222, 0.050, 0.042).at(-0.153, 0.002, 0)
    shoulder_end = box(0.062, 0.066, 0.044).at(-0.011, 0, 0)
    return parts, (solid, elbow, shoulder_end)


def forearm() -> Shape:
    """From the elbow (origin) to the wrist at (0.246, 0, -0.06); this frame hangs upside down."""
    cap = [drum("y", 0.028, 0.011).at(0, dy) for dy in (-0.0285, 0.0285)]
    side = [(-0.022, 0.004), (0.022, 0.006), (0.060, -0.046), (0.052, -0.078), (0.012, -0.062)]
    cheek = [_plate(side, 0.009).at(0, dy, 0) for dy in (-0.0285, 0.0285)]
    beam = rounded_box(0.190, 0.052, 0.046, 0.010, 2).at(0.128, 0, -0.060)
    ring = rounded_box(0.010, 0.0535, 0.0475, 0.010, 2).at(0.200, 0, -0.060)
    wrist = drum("y", 0.025, 0.042).at(0.246, 0, -0.06)
    parts = (
        Part(together(*cap, wrist), MOTOR),
        Part(together(beam, *cheek), SHELL),
        Part(ring, ACCENT),
    )
    solid = box(0.200, 0.052, 0.046).at(0.128, 0, -0.060)
    elbow = hull(together(*cap, _plate(side, 0.066)).vertices)
    return parts, (solid, wrist, elbow)


def wrist_pitch() -> Shape:
    """Bracket from the pitch axis (origin) to the yaw motor above, at (0.068, 0, -0.0855)."""
    cap = [drum("y", 0.023, 0.009, 12).at(0, dy) for dy in (-0.0265, 0.0265)]
    cheek = [box(0.036, 0.007, 0.026).at(0.016, dy, 0) for dy in (-0.0265, 0.0265)]
    plate = box(0.007, 0.060, 0.098).at(0.0325, 0, -0.035)
    roof = rounded_box(0.050, 0.056, 0.030, 0.005, 1).at(0.052, 0, -0.069)
    motor = drum("z", 0.027, 0.036).at(0.068, 0, -0.0685)
    parts = (
        Part(together(*cap, motor), MOTOR),
        Part(together(plate, roof, *cheek), SHELL),
    )
    yoke = box(0.060, 0.060, 0.044).at(0.006, 0, 0)
    top = hull(together(roof, motor).vertices)
    return parts, (yoke, top, box(0.008, 0.058, 0.05).at(0.033, 0, -0.034))


def wrist_yaw() -> Shape:
    """Yaw drum about z with the roll motor's flange at (0.031, 0, 0.0855)."""
    body = drum("z", 0.027, 0.072).at(0, 0, 0.0815)
    flange = drum("x", 0.024, 0.038).at(0.0195, 0, 0.0855)
    return (Part(together(body, flange), MOTOR),), (body,)


def hand() -> Shape:
    """Roll motor, finger rail and the bracket of the wrist camera. x is the approach."""
    motor = drum("x", 0.0285, 0.050).at(0.0285)
    rail = rounded_box(0.020, 0.174, 0.024, 0.004, 1).at(0.0655)
    palm = rounded_box(0.016, 0.060, 0.044, 0.005, 1).at(0.0525)
    neck = box(0.010, 0.030, 0.048).at(0.046, 0, 0.040)
    parts = (
        Part(motor, MOTOR),
        Part(together(palm, neck), SHELL),
        Part(rail, STEEL, "aluminium"),
    )
    return parts, (drum("x", 0.0285, 0.052, 10).at(0.027), rail, neck)


def camera() -> Shape:
    """Wrist camera. All of it lies behind the lens plane, x <= 0, so it never sees itself."""
    body = rounded_box(0.022, 0.090, 0.025, 0.006, 2).at(-0.013, -0.032, 0)
    lens = [drum("x", 0.0065, 0.003, 8).at(-0.0015, dy) for dy in (0.0, -0.05)]
    parts = (Part(body, metal((0.72, 0.73, 0.75))), Part(together(*lens), PAD))
    return parts, (box(0.022, 0.090, 0.025).at(-0.013, -0.032, 0),)


def finger(left: bool) -> Shape:
    """One finger; its flat inner face meets the other's at q = 0.

    Left slides along +y. The tip ends 7.1 cm ahead of the joint, 3.56 cm beyond the TCP.
    """
    # 0.1 mm short of touching at q = 0: closed fingers must not press on each other.
    inner = -0.0244 if left else 0.0244
    flip = 1.0 if left else -1.0
    # Outline in (x, y) of the left finger: carriage, arm bending inwards, slim plate.
    arm = [
        (0.004, 0.008), (0.004, -0.010), (0.016, -0.0215), (0.070, -0.0215),
        (0.071, -0.0190), (0.034, -0.0130), (0.014, 0.006),
    ]  # fmt: skip
    blade = _upright(arm, 0.018).scaled(1, flip, 1)
    carriage = rounded_box(0.024, 0.028, 0.056, 0.003, 1).at(0.000, -0.0015 * flip)
    pad = box(0.053, 0.003, 0.020).at(0.0445, inner + 0.0015 * flip, 0)
    parts = (Part(carriage, STEEL, "aluminium"), Part(blade, MOTOR), Part(pad, PAD, "rubber"))
    # The gripping plate is a plain box: a flat face, so that contact is a patch and not an edge.
    plate = box(0.053, 0.006, 0.020).at(0.0445, inner + 0.003 * flip, 0)
    stem = _upright([(0.008, 0.008), (0.008, -0.008), (0.020, -0.0185), (0.036, -0.0185),
                     (0.036, -0.013), (0.014, 0.006)], 0.018).scaled(1, flip, 1)  # fmt: skip
    return parts, (plate, stem, box(0.024, 0.028, 0.056).at(0.0, -0.0015 * flip))


def _plate(outline: list[tuple[float, float]], thickness: float) -> Solid:
    """An outline in (x, z) with its thickness about y = 0."""
    return extrude(outline, thickness).at(y=-thickness / 2)


def _upright(outline: list[tuple[float, float]], height: float) -> Solid:
    """An outline in (x, y) with its height about z = 0."""
    return extrude(outline, height).at(y=-height / 2).turned("x", 90).scaled(1, -1, 1)
