"""The simulator's own values of everything that attributes write, stored beside each label."""

import numpy as np

from rtphys.core.poses import Array
from rtphys.physics.handles import Surface, World

Plain = float | list[float]
Group = dict[str, dict[str, Plain]]


def readback(world: World) -> dict[str, Group | dict[str, Plain]]:
    """The `readback` part of a label file, as plain JSON; names are those of the scene.

    Units are SI (kg, kg m², m, N; joint damping N m s/rad or N s/m), but the tilt is in degrees.
    """
    tilt, height = world.measured_table()
    return {
        "bodies": {b.name: _body(b.mass, b.inertia, b.com) for b in world.bodies},
        "surfaces": {s.name: _surface(s) for s in (*world.surfaces, *world.scenery)},
        "joints": {j.name: {"damping": j.damping, "friction": j.friction} for j in world.joints},
        "servos": {
            s.name: {"damping": s.damping} for s in (*world.arm_servos, *world.gripper_servos)
        },
        "table": {"tilt_deg": float(np.degrees(tilt)), "height": height},
        "scale": dict(world.measured_scale()),
        "external_force": {n: [force, 0.0, 0.0] for n, force in world.measured_force().items()},
    }


def _body(mass: float, inertia: Array, com: Array) -> dict[str, Plain]:
    return {
        "mass": float(mass),
        "inertia": [float(x) for x in inertia],
        "com": [float(x) for x in com],
    }


def _surface(surface: Surface) -> dict[str, Plain]:
    """One number per property where all shapes agree, else one per shape."""
    columns = zip(*surface.materials(), strict=True)
    names = ("static_friction", "dynamic_friction", "restitution")
    return {
        name: values[0] if len(set(values)) == 1 else list(values)
        for name, values in zip(names, columns, strict=True)
    }
