"""Count the moments at which the head camera sees what a task is about, and what others add.

    in_view.py OUT.json [EPISODES [TASK ...]]

For each task: at how many of evenly spaced moments of accepted episodes the head camera shows at
least 20 pixels of every object that the task's sentences name; at how many it or the front camera
does; and it or a wrist camera. An object that an arm hides counts as unseen.
"""

import sys
from collections import Counter
from collections.abc import Iterator
from itertools import count, islice
from pathlib import Path

from rtphys.assets.pack import Pack, default_pack
from rtphys.data.json_text import pretty
from rtphys.episode.generate import attempt, prepare
from rtphys.sim import renderer
from rtphys.sim.recorder import Recording
from rtphys.sim.scene_renderer import SceneRenderer
from rtphys.spec.episode import EpisodeSpec, Recipe
from rtphys.spec.recording import CAMERAS, RecordingSpec
from rtphys.task.spec import Task, load_task, task_names

PROTOCOL = "phys_random"
MOMENTS = 8  # of each episode
MIN_PIXELS = 20
FILMING = RecordingSpec(tuple(CAMERAS), ("segmentation",))
VIEWS = {"head": ("head",), "or front": ("head", "front"), "or wrists": ("head", "left", "right")}


def accepted(task: Task, pack: Pack) -> Iterator[tuple[Recipe, Recording]]:
    """The task's accepted seeds, in order."""
    for seed in count():
        recipe = EpisodeSpec(task.name, PROTOCOL).at(seed)
        result = attempt(recipe, task, pack)
        if result.accepted and result.recording:
            yield recipe, result.recording


def in_view(task: Task, pack: Pack, episodes: int) -> dict[str, int]:
    """View -> number of moments at which it shows every object."""
    objects = [prop.name for prop in task.props(0) if prop.name in task.info.values()]
    seen = Counter[str]()
    for recipe, recording in islice(accepted(task, pack), episodes):
        scene = SceneRenderer(prepare(recipe, task, pack, visuals=True).world, FILMING)
        names = scene.names["actor"]  # of the links of a thing with joints: thing/link
        ids = [[i for i, actor in enumerate(names) if actor.split("/")[0] == o] for o in objects]
        for i in range(MOMENTS):
            row = recording.rows[round(i * (len(recording.rows) - 1) / (MOMENTS - 1))]
            scene.show(row.packed)
            actors = {name: shot.actors for name, shot in scene.frames().items()}
            for view, cameras in VIEWS.items():
                pictures = [actors[CAMERAS[name]] for name in cameras]
                seen[view] += all(
                    any(sum((p == i).sum() for i in own) >= MIN_PIXELS for p in pictures)
                    for own in ids
                )
    return {view: seen[view] for view in VIEWS}


def main(out: str, episodes: str = "2", *names: str) -> None:
    """Count all tasks, or those named."""
    renderer.ready("default", senses=True)
    pack, number = default_pack(), int(episodes)
    counts: dict[str, dict[str, int]] = {}
    for name in names or task_names():
        counts[name] = in_view(load_task(name), pack, number)
        print(name, counts[name], flush=True)
    Path(out).write_text(pretty({"of": number * MOMENTS, "tasks": counts}).decode())


if __name__ == "__main__":
    main(sys.argv[1], *sys.argv[2:])
