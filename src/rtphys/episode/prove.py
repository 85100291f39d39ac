"""Proof by simulation: stored episodes are made again from their recipes and compared."""

import numpy as np

from rtphys.assets.pack import default_pack, pack_with
from rtphys.core.errors import BadValue
from rtphys.data.dataset import Dataset
from rtphys.data.verify import Problem
from rtphys.episode.generate import attempt
from rtphys.setting.setting import Recipe
from rtphys.task.spec import load_task


def replayed(dataset: Dataset, count: int) -> list[Problem]:
    """Simulates `count` of the expert's episodes again, spread evenly, each with its own assets.

    Returns:
        One problem for each episode whose states are not the stored ones. Where the asset pack of
        the collection is not on this machine, the pack in use stands in, and the problem says so.
    """
    digests = {entry.assets.get("digest", "") for entry in dataset.task_datasets}
    packs = {digest: pack_with(digest) or default_pack() for digest in digests}
    # What a policy did cannot be made again without it.
    own = [n for n in range(len(dataset)) if dataset.task_dataset(n).policy is None]
    chosen = np.unique(np.linspace(0, len(own) - 1, min(count, len(own))).astype(int))
    problems: list[Problem] = []
    for index in (own[n] for n in chosen):
        episode, digest = dataset[index], dataset.task_dataset(index).assets.get("digest", "")
        try:
            recipe = Recipe.from_json(episode.meta.recipe)
        except (KeyError, ValueError, BadValue) as error:
            text = f"its recipe is not whole ({error})"
            problems.append(Problem(episode.paths.phys_meta, text))
            continue
        result = attempt(recipe, load_task(recipe.task), packs[digest])
        recording = result.recording if result.accepted else None
        outcome = recording.hash if recording else result.reason
        if outcome != episode.meta.state_hash:
            assets = "" if digest == packs[digest].digest else ", with other assets than today's"
            stored = f"state_hash {episode.meta.state_hash}{assets}"
            text = f"simulated again it gives {outcome}, not {stored}"
            problems.append(Problem(episode.paths.phys_meta, text))
    return problems
