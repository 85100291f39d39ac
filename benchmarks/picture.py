"""CPU time of one 320x240 picture, by task: all four cameras, builtin assets, the slim shader.

Wall time on a shared machine says little; CPU time of this process is what is printed.
"""

import sys
import time

import numpy as np

from rtphys.assets.pack import default_pack
from rtphys.instance import prepare
from rtphys.recipe import Recipe
from rtphys.sim import renderer
from rtphys.sim.studio import Studio
from rtphys.task.spec import load_task, task_names

CAMERAS = ("head", "left", "right", "front")
REPEATS = 25


def cost(task: str) -> float:
    """CPU-milliseconds a picture, the state's transfer to the renderer included."""
    world = prepare(Recipe(task, 0), load_task(task), default_pack(), visuals=True).world
    packed = world.scene.pack_poses()
    studio = Studio(world, CAMERAS)
    studio.show(packed)
    studio.pictures()  # compiles what is compiled once
    start = time.process_time()
    for _ in range(REPEATS):
        studio.show(packed)
        studio.pictures()
    return (time.process_time() - start) / (REPEATS * len(CAMERAS)) * 1e3


def main(shader: str = "slim") -> None:
    renderer.configure(shader)
    start = time.process_time()
    renderer.hold_anchor()
    print(f"first frame {time.process_time() - start:6.2f} CPU-s")
    costs = {task: cost(task) for task in task_names()}
    for task, milliseconds in costs.items():
        print(f"{task:24} {milliseconds:6.2f} CPU-ms")
    print(f"{'mean':24} {np.mean(list(costs.values())):6.2f} CPU-ms a picture ({shader})")


if __name__ == "__main__":
    main(*sys.argv[1:2])
