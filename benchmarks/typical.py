"""Episodes to measure with, as long as the fifty tasks' are on average: 150 frames.

Half of what checking an episode costs is the same for a short and a long one, so length matters.
"""

from pathlib import Path

from rtphys.studies.collect import CollectPlan, collect

TASKS = ("click_bell", "place_container_plate", "stack_blocks_two", "put_object_cabinet")
EPISODES = 5  # of each


def collect_typical(out: Path) -> None:
    """20 episodes under `phys_random_all`."""
    collect(CollectPlan(TASKS, EPISODES, out, protocol="phys_random_all"))
