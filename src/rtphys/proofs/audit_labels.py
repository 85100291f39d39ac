"""Checks a dataset's labels: builds each episode's world again from its label and compares."""

from collections.abc import Mapping

import numpy as np

from rtphys.assets.pack import Pack
from rtphys.core.poses import Pose
from rtphys.data.dataset import Episode
from rtphys.data.schema import CameraPose, PhysMeta
from rtphys.physics.enforce import disagreements, enforce
from rtphys.physics.handles import Blueprint
from rtphys.physics.readback import readback
from rtphys.physics.values import Physics
from rtphys.sim.room import TablePlan
from rtphys.sim.world import World, WorldPlan
from rtphys.task.spec import load_task

RELATIVE = 1e-6  # rounding of a number in single precision
ABSOLUTE = 1e-9  # the same for numbers that are zero


def label_problems(episode: Episode, pack: Pack) -> list[str]:
    """One sentence for each stored read-back that the world rebuilt from the label does not give.

    Raises:
        UnknownName: the episode's task is in no library.
        MissingAsset: the pack lacks something of the task.
    """
    meta, physics = episode.meta, episode.physics
    world = rebuild(meta, physics, pack)
    problems = disagreements(world, physics)
    stored = meta.readback.model_dump()
    problems += differences("readback", stored, readback(world))
    head = meta.cameras.get(world.head_camera.name)
    if head is not None:
        problems += _moved(head, world.head_camera.pose)
    return problems


def rebuild(meta: PhysMeta, physics: Physics, pack: Pack) -> World:
    """The initial world of an episode, from its label alone."""
    task = load_task(meta.task)
    blueprint = Blueprint()
    enforce(blueprint, physics)
    props, table = tuple(task.props(meta.seed)), TablePlan(task.table_shift, task.table_drop)
    embodiment = str(meta.recipe.get("embodiment", "aloha-agilex"))
    world = World(WorldPlan(pack, props, blueprint, table, embodiment))
    enforce(world, physics)
    return world


def differences(where: str, stored: object, now: object) -> list[str]:
    """One sentence for each key at which two nested structures differ by more than rounding."""
    if isinstance(stored, Mapping) and isinstance(now, Mapping):
        problems: list[str] = []
        for key in sorted({*stored, *now}):
            if key in stored and key in now:
                problems += differences(f"{where}.{key}", stored[key], now[key])
            elif stored.get(key) != {} and now.get(key) != {}:
                side = "the label" if key in stored else "the rebuilt world"
                problems.append(f"{where}.{key}: only {side} has it")
        return problems
    if _close(stored, now):
        return []
    return [f"{where}: the label says {stored}, the rebuilt world {now}"]


def _close(a: object, b: object) -> bool:
    try:
        x, y = np.asarray(a, float), np.asarray(b, float)
    except (TypeError, ValueError):
        return a == b
    return x.shape == y.shape and bool(np.allclose(x, y, rtol=RELATIVE, atol=ABSOLUTE))


def _moved(stored: CameraPose, now: Pose) -> list[str]:
    """Compare head camera poses in metres and radians: q and -q are the same rotation."""
    then = Pose(stored.position, stored.quaternion_wxyz)
    off, turned = float(np.linalg.norm(then.p - now.p)), then.angle_to(now)
    if off < 1e-5 and turned < 1e-3:
        return []
    return [f"cameras.head_camera: {1000 * off:.3f} mm and {turned:.4f} rad off the rebuilt one"]
