"""A dual-arm URDF with round primitives, written from the measured joint table of the aloha."""

import numpy as np

BASES = {"fl": ((0.2305, 0.297, 0.782), 0.02), "fr": ((0.2315, -0.3063, 0.781), 0.01)}

# origin xyz, origin rpy, axis of joints 1 to 6; the same for both arms.
JOINTS = [
    ((0, 0, 0.058), (0, 0, 0), (0, 0, 1)),
    ((0.025013, 0.00060169, 0.042), (0, 0, 0), (0, 1, 0)),
    ((-0.26396, 0.0044548, 0), (-np.pi, 0, -0.015928), (0, 1, 0)),
    ((0.246, -0.00025, -0.06), (0, 0, 0), (0, 1, 0)),
    ((0.06775, 0.0015, -0.0855), (0, 0, -0.015928), (0, 0, 1)),
    ((0.03095, 0, 0.0855), (-np.pi, 0, 0), (1, 0, 0)),
]
LIMITS = np.array([(-2.6, 2.6), (0, 3.5), (0, 3.2), (-1.6, 1.6), (-1.6, 1.6), (-3.1, 3.1)])
BENT = np.array([0.0, 1.2, 1.0, -0.8, 0.0, 0.0])  # elbow up, tool pitched down

# One collision primitive a link: shape, centre xyz, rpy.
SHAPES = {
    1: ('<sphere radius="0.03"/>', (0, 0, 0.0), (0, 0, 0)),
    2: ('<cylinder radius="0.025" length="0.2"/>', (-0.132, 0, 0), (0, np.pi / 2, 0)),
    3: ('<cylinder radius="0.022" length="0.16"/>', (0.11, 0, -0.05), (0, np.pi / 2, 0)),
    4: ('<box size="0.05 0.05 0.04"/>', (0.05, 0, -0.05), (0, 0, 0)),
    5: ('<sphere radius="0.02"/>', (0.0, 0, 0.085), (0, 0, 0)),
    6: ('<box size="0.06 0.16 0.05"/>', (0.045, 0, 0), (0, 0, 0)),
    7: ('<box size="0.086 0.02 0.06"/>', (0.028, -0.0145, 0), (0, 0, 0)),
    8: ('<box size="0.086 0.02 0.06"/>', (0.028, 0.0145, 0), (0, 0, 0)),
}


def _numbers(values) -> str:
    return " ".join(repr(float(v)) for v in values)


def _link(name: str, shape=None) -> str:
    if shape is None:
        return f'<link name="{name}"/>'
    geometry, xyz, rpy = shape
    origin = f'<origin xyz="{_numbers(xyz)}" rpy="{_numbers(rpy)}"/>'
    return (
        f'<link name="{name}"><collision>{origin}<geometry>{geometry}</geometry></collision></link>'
    )


def _joint(name: str, kind: str, ends, origin, axis=(1, 0, 0)) -> str:
    limit = {"revolute": "-10 10", "prismatic": "0 0.04765", "fixed": "0 0"}[kind].split()
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{ends[0]}"/><child link="{ends[1]}"/>'
        f'<origin xyz="{_numbers(origin[0])}" rpy="{_numbers(origin[1])}"/>'
        f'<axis xyz="{_numbers(axis)}"/>'
        f'<limit lower="{limit[0]}" upper="{limit[1]}" effort="100" velocity="1000"/></joint>'
    )


def aloha_urdf() -> str:
    """Both arms, a tower behind them, one free wheel that planning must lock."""
    tower = ('<box size="0.1 0.2 0.9"/>', (0, 0, 0.55), (0, 0, 0))
    parts = [_link("footprint"), _link("tower", tower), _link("wheel")]
    parts.append(_joint("tower_joint", "fixed", ("footprint", "tower"), ((0, 0, 0), (0, 0, 0))))
    parts.append(_joint("wheel", "revolute", ("footprint", "wheel"), ((0, 0.2, 0), (0, 0, 0))))
    for arm, (xyz, yaw) in BASES.items():
        base = ('<cylinder radius="0.04" length="0.05"/>', (0, 0, 0.025), (0, 0, 0))
        parts.append(_link(f"{arm}_base_link", base))
        ends = ("footprint", f"{arm}_base_link")
        parts.append(_joint(f"{arm}_base_joint", "fixed", ends, (xyz, (0, 0, yaw))))
        for i, (origin, rpy, axis) in enumerate(JOINTS, 1):
            parent = f"{arm}_link{i - 1}" if i > 1 else f"{arm}_base_link"
            parts.append(_link(f"{arm}_link{i}", SHAPES[i]))
            ends = (parent, f"{arm}_link{i}")
            parts.append(_joint(f"{arm}_joint{i}", "revolute", ends, (origin, rpy), axis))
        for i, side in ((7, 1), (8, -1)):
            parts.append(_link(f"{arm}_link{i}", SHAPES[i]))
            origin = ((0.08457, side * 0.0245, -0.0001), (0, 0, 0))
            ends = (f"{arm}_link6", f"{arm}_link{i}")
            parts.append(_joint(f"{arm}_joint{i}", "prismatic", ends, origin, (0, side, 0)))
    return '<robot name="dual">' + "".join(parts) + "</robot>"
