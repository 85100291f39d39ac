"""Writes an episode's physics into the simulator, checks that it has it, and reads it back."""

import inspect
import os
from collections.abc import Collection, Generator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, cast

import numpy as np

from rtphys.core.errors import BadFile, RtphysError
from rtphys.core.library import line_of
from rtphys.physics.attribute import AnyAttribute, Part, attribute, in_order
from rtphys.physics.handles import Blueprint, Happened, Surface, World
from rtphys.physics.reach import Reach, Reached, keys_of, reach, split
from rtphys.physics.values import Physics


def enforce(target: Blueprint | World, physics: Physics) -> None:
    """Apply all values that belong to this stage: a Blueprint before the build, a World after it.

    Nominal values are applied too, so that nothing depends on the simulator's defaults. None keeps
    the asset's own value.
    """
    stage = "before_build" if isinstance(target, Blueprint) else "after_build"
    for key, one in _for_episode(physics):
        value = physics[key]
        if one.when == stage and value is not None:
            with _naming(one, "apply"):
                one.apply(part_of(target, key, physics), value)


def could_act(physics: Physics, parts: Mapping[str, Collection[Part]]) -> frozenset[str]:
    """Keys of the attributes that may change anything in an episode.

    Args:
        parts: prop -> what its world has of it.
    """
    return frozenset(
        key
        for key, one in _for_episode(physics)
        if one.could_act(reach(key, physics).parts(parts), physics[key])
    )


def acted(key: str, physics: Physics, happened: Happened) -> bool | None:
    """Whether another value would have changed an episode; None: it is not measured.

    What happened is known of all props together, so of one only that it did not.
    """
    found = attribute(key).acted(happened)
    return None if found and len(keys_of(split(key)[0], physics)) > 1 else found


class FalseLabel(RtphysError):
    """The simulator does not say what the label would say: a bug, never an episode."""

    exit_code = os.EX_SOFTWARE


def check_in_force(world: World, physics: Physics, where: str) -> None:
    """Raises `FalseLabel`: the simulator has not the values that were drawn."""
    if wrong := disagreements(world, physics):
        raise FalseLabel(f"{where}: {'; '.join(wrong)}")


def disagreements(world: World, physics: Physics) -> list[str]:
    """One sentence for each value of `physics` that the simulator does not have."""
    wrong: list[str] = []
    for key, one in _for_episode(physics):
        value = physics[key]
        if value is not None:
            with _naming(one, "read"):
                wrong += one.disagreements(part_of(world, key, physics), value)
    return wrong


def _for_episode(physics: Physics) -> list[tuple[str, AnyAttribute]]:
    """Keys in the order in which their attributes are applied."""
    keys = [(key, one) for one in in_order() for key in keys_of(one.key, physics)]
    return [(key, one.for_episode(physics)) for key, one in keys]


def part_of(target: Blueprint | World, key: str, physics: Physics) -> Any:
    """The part of a world that a key is for."""
    part = reach(key, physics)
    return target if part == Reach() else Reached(cast(World, target), part)


@contextmanager
def _naming(attribute: AnyAttribute, method: str) -> Generator[None]:
    """Turns what an attribute raises into an error that names its file and line."""
    try:
        yield
    except RtphysError:
        raise
    except Exception as error:
        path = Path(inspect.getfile(type(attribute)))
        what = f"{attribute.key}.{method} raises {type(error).__name__}: {error}"
        raise BadFile(path, what + line_of(error, path)) from error


Plain = float | list[float]
Group = dict[str, dict[str, Plain]]


def readback(world: World) -> dict[str, Group | dict[str, Plain]]:
    """The `readback` part of a label file, as plain JSON; names are those of the scene.

    Units are SI (kg, kg m², m, N, 1/s; joint damping N m s/rad or N s/m), but the tilt is in
    degrees.
    """
    tilt, height = world.measured_table()
    servos = (*world.arm_servos, *world.gripper_servos)
    return {
        "bodies": {
            b.name: {
                "mass": float(b.mass),
                "inertia": [float(x) for x in b.inertia],
                "com": [float(x) for x in b.com],
                "spin_decay": b.spin_decay,
            }
            for b in world.bodies
        },
        "surfaces": {s.name: _surface(s) for s in (*world.surfaces, *world.scenery)},
        "joints": {j.name: {"damping": j.damping, "friction": j.friction} for j in world.joints},
        "servos": {s.name: {"damping": s.damping} for s in servos},
        "table": {"tilt_deg": float(np.degrees(tilt)), "height": height},
        "scale": dict(world.measured_scale()),
        "external_force": {n: [force, 0.0, 0.0] for n, force in world.measured_force().items()},
    }


def _surface(surface: Surface) -> dict[str, Plain]:
    """One number per property where all shapes agree, else one per shape."""
    columns = zip(*surface.materials(), strict=True)
    names = ("static_friction", "dynamic_friction", "restitution")
    return {
        name: values[0] if len(set(values)) == 1 else list(values)
        for name, values in zip(names, columns, strict=True)
    }
