"""Weigh what the fifty tasks move, and write docs/results/masses.json.

`scripts/masses.py` takes a minute. `scripts/tables.py` derives the table in docs/masses.md, which
also has the masses of RoboTwin.
"""

import numpy as np

import results
from rtphys.assets.pack import Pack, default_pack
from rtphys.core.errors import Infeasible
from rtphys.core.poses import Pose
from rtphys.laws.audit.specimen import hang
from rtphys.sim.engine import TIME_STEP, new_scene
from rtphys.sim.objects import ObjectFactory
from rtphys.task.props import Articulated, Mesh, Prop
from rtphys.task.spec import load_task, task_names

LAYOUTS = 200  # of each task, from which its objects are taken
ACCELERATION = 25.0  # [m/s²] that the test force should give

# [kg] RoboTwin gives 0.01 to everything that may move, each link included, but in these tasks.
THEIR_DEFAULT = 0.01
THEIRS: dict[str, dict[str, float]] = {
    "beat_block_hammer": {"020_hammer": 0.001},
    "dump_bin_bigbin": {"ball": 0.0001},
    "move_pillbottle_pad": {"080_pillbottle": 0.05},
    "place_bread_skillet": {"075_bread": 0.001},
    "place_burger_fries": {"005_french-fries": 0.05, "006_hamburg": 0.05},
    "place_can_basket": {"110_basket": 0.5},
    "place_cans_plasticbox": {"062_plasticbox": 0.05, "071_can": 0.05},
    "place_mouse_pad": {"047_mouse": 0.05},
    "place_object_basket": {"110_basket": 0.5},
    "stamp_seal": {"100_seal": 0.05},
}
ALL_FIFTY_GRAMS = ("place_a2b_left", "place_a2b_right", "place_object_scale")  # every object


def theirs(task: str, kind: str) -> float:
    """What an object of a task weighs in RoboTwin [kg], at its commit cf47ab5."""
    if task in ALL_FIFTY_GRAMS:
        return 0.05
    return THEIRS.get(task, {}).get(kind, THEIR_DEFAULT)


def kind_of(prop: Prop) -> str:
    """The asset's name; "box" or "ball" of what has none."""
    return prop.category if isinstance(prop, Mesh | Articulated) else type(prop).__name__.lower()


def weigh(prop: Prop, pack: Pack) -> list[float]:
    """Mass [kg] of each part of an object that may move, at nominal size and physics.

    A rigid body floats, and a force of one step gives its mass. The links of an articulation hold
    each other, so theirs is what the simulator says.
    """
    scene = new_scene(visuals=False)
    thing = ObjectFactory(scene, pack, Pose((0, 0, 0)), scale=1.0).build(prop)
    if thing.articulation is not None:
        return [body.mass for body in thing.bodies]
    if not thing.bodies or not thing.root.collision_shapes:
        return []
    hang(thing, np.zeros(3))
    (body,) = thing.bodies
    force = ACCELERATION * body.mass
    body.component.add_force_torque([force, 0.0, 0.0], [0.0, 0.0, 0.0])
    scene.step()
    return [force * TIME_STEP / float(body.component.linear_velocity[0])]


def objects(task: str) -> dict[str, Prop]:
    """Distinct objects of a task that may move, by kind and model, or kind and size."""
    found: dict[str, Prop] = {}
    for seed in range(LAYOUTS):
        try:
            props = load_task(task).props(seed)
        except Infeasible:
            continue
        for prop in props:
            if isinstance(prop, Articulated) or not prop.fixed:
                model = getattr(prop, "model", None)
                size = getattr(prop, "half_size", None) or getattr(prop, "radius", None)
                found.setdefault(f"{kind_of(prop)} {size if model is None else model}", prop)
    return found


def main() -> None:
    """Weigh every object of every task: object -> task -> [number of parts, least, most [kg]]."""
    pack, report = default_pack(), dict[str, dict[str, list[float]]]()
    for task in task_names():
        found: dict[str, list[float]] = {}
        for name, prop in objects(task).items():
            found.setdefault(name.partition(" ")[0], []).extend(weigh(prop, pack))
        for kind, parts in found.items():
            if parts:
                extremes = (float(f"{kg:.3g}") for kg in (min(parts), max(parts)))
                report.setdefault(kind, {})[task] = [len(parts), *extremes]
        print(task, flush=True)
    results.save("masses", report)


if __name__ == "__main__":
    main()
