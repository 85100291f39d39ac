"""Action and observation spaces of a task, and the arrays that fill them."""

from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from rtphys.assets.action_layout import SIDES
from rtphys.core.errors import UnknownName
from rtphys.episode.generate import Instance
from rtphys.physics.attribute import attribute
from rtphys.physics.enforce import part_of
from rtphys.physics.reach import split
from rtphys.senses import SENSES
from rtphys.spec.recording import USUAL, RecordingSpec
from rtphys.task.props import Articulated, Prop

SHAPE = (240, 320, 3)  # of a picture, RGB
Bounds = NDArray[np.float32]


def commands(bounds: Bounds) -> spaces.Space[NDArray[np.float32]]:
    """Space of actions: absolute joint targets and gripper openings within the limits."""
    return spaces.Box(*bounds, dtype=np.float32)


def _numbers(*shape: int) -> spaces.Box:
    return spaces.Box(-np.inf, np.inf, shape, np.float32)


def state(bounds: Bounds, props: Sequence[Prop]) -> dict[str, spaces.Space]:
    """Parts of a state observation: commands, measurements, and poses of the task's objects."""
    size = bounds.shape[1]
    found: dict[str, spaces.Space] = {
        "agent_pos": commands(bounds),
        "measured": _numbers(size),
        "velocities": _numbers(size - len(SIDES)),
        "efforts": _numbers(size),
        "endposes": spaces.Dict({side: _numbers(7) for side in SIDES}),
        "objects": spaces.Dict({prop.name: _numbers(7) for prop in props}),
    }
    if articulated := [prop.name for prop in props if isinstance(prop, Articulated)]:
        found["joints"] = spaces.Dict({name: _numbers(1) for name in articulated})
    return found


def pixels(bounds: Bounds) -> dict[str, spaces.Space]:
    """Parts of a pixel observation, commands and pictures, under LeRobot's names."""
    views: dict[str, spaces.Space] = {name: spaces.Box(0, 255, SHAPE, np.uint8) for name in USUAL}
    return {"agent_pos": commands(bounds), "pixels": spaces.Dict(views)}


def sensed(recording: RecordingSpec) -> dict[str, spaces.Space]:
    """Parts for the senses. Raises `UnknownName`: one that cannot be observed."""
    made: dict[str, spaces.Space] = {}
    cameras = recording.cameras or USUAL
    for name in recording.senses:
        if (space := SENSES[name].space()) is None:
            known = [one.name for one in SENSES.values() if one.space() is not None]
            raise UnknownName("observed sense", name, known)
        box = spaces.Box(*space)  # pyright: ignore
        each = SENSES[name].scope == "pixel"
        made[name] = spaces.Dict(dict.fromkeys(cameras, box)) if each else box
    return made


def physics(keys: Iterable[str]) -> spaces.Dict:
    """Space of the physics: one entry per attribute, and per prop with its own, in its own unit."""
    return spaces.Dict({key: _numbers(attribute(split(key)[0]).size) for key in keys})


def single(values: Mapping[str, object]) -> dict[str, object]:
    """Copy of a nested mapping with all arrays in single precision, scalars as (1,)."""
    return {
        key: single(value)
        if isinstance(value, Mapping)
        else np.atleast_1d(np.asarray(value, np.float32))
        for key, value in values.items()
    }


def physics_of(instance: Instance, keys: Iterable[str]) -> dict[str, object]:
    """Values of attributes in an episode, (components,) in their own units.

    A prop without a value of its own has that of the others. If an attribute keeps the assets' own
    values, their mean as read from the simulator; 0 if nothing in the scene has the attribute.
    """
    values: dict[str, object] = {key: instance.physics.of(*split(key)) for key in keys}
    for key in [key for key, value in values.items() if value is None]:
        one, part = attribute(split(key)[0]), part_of(instance.world, key, instance.physics)
        # Only what it would set to its value: beside a joint's damping, dry friction is read.
        own = [name for name, value in one.expected(part, 1.0).items() if value == 1.0]
        read = one.read(part)
        values[key] = np.mean([read[name] for name in own]) if own else 0.0
    return single(values)
