"""Episodes to measure with, whose mean length is that of all fifty tasks: 150 frames.

Half of the cost of checking an episode does not depend on its length, so the length matters.
"""

from pathlib import Path

from rtphys.spec.collection import CollectionSpec
from rtphys.spec.episode import EpisodeSpec
from rtphys.studies.collect import collect
from rtphys.studies.requests import Run, specs_for

TASKS = ("click_bell", "place_container_plate", "stack_blocks_two", "put_object_cabinet")
EPISODES = 5  # of each


def typical(path: str | None, folder: str) -> Path:
    """The dataset at `path`; without one, 20 episodes under `phys_random_all`, collected there."""
    if path is not None:
        return Path(path)
    template = CollectionSpec(EpisodeSpec(protocol="phys_random_all"), episodes=EPISODES)
    collect(specs_for(template, TASKS), Run(out := Path(folder) / "data"))
    return out
