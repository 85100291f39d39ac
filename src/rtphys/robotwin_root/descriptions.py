"""`description/utils/generate_episode_instructions.py`, with our sentences."""

from collections.abc import Mapping, Sequence

from rtphys.assets.pack import default_pack
from rtphys.core.errors import BadValue
from rtphys.episode.assemble import describer
from rtphys.robotwin_root.base_task import SEED
from rtphys.task.instructions import instructions
from rtphys.task.spec import load_task


def generate_episode_descriptions(
    task_name: str, episodes: Sequence[Mapping[str, object]], max_descriptions: int = 100
) -> list[dict[str, object]]:
    """Sentences of each episode: `{"episode_index": i, "seen": [...], "unseen": [...]}`.

    Args:
        episodes: the `info` that `play_once` returned, one each.

    Raises:
        BadValue: an info of somebody else.
    """
    task, describe = load_task(task_name), describer(default_pack())
    found: list[dict[str, object]] = []
    for index, info in enumerate(episodes):
        seed = info.get(SEED)
        if not isinstance(seed, int):
            raise BadValue(SEED, seed, "pass what play_once of this root's tasks returns")
        said = instructions(task, seed, describe)
        limited = {split: lines[:max_descriptions] for split, lines in said.items()}
        found.append({"episode_index": index, **limited})
    return found
