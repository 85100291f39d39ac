"""An episode is the same under every hash seed of Python, and where nothing can draw."""

import os
import subprocess
import sys

import pytest

pytestmark = pytest.mark.sim

# Each hand holds a shoe and both still swing: who is waited for first shows in the recording.
_SCRIPT = """
from rtphys.assets.pack import default_pack
from rtphys.episode.generate import attempt
from rtphys.spec.episode import EpisodeSpec
from rtphys.task.spec import load_task

recipe = EpisodeSpec("place_dual_shoes", "phys_random_all").at(2)
print(attempt(recipe, load_task(recipe.task), default_pack()).recording.hash)
"""


def _recording(**environment: str) -> str:
    env = {**os.environ, **environment}
    return subprocess.run(
        [sys.executable, "-c", _SCRIPT], env=env, check=True, capture_output=True, text=True
    ).stdout.strip()


def test_same_bits_under_every_hash_seed() -> None:
    # Under these two a set of the shoes' names comes in either order.
    assert _recording(PYTHONHASHSEED="0") == _recording(PYTHONHASHSEED="5")


def test_same_bits_where_nothing_can_draw() -> None:
    nowhere = dict.fromkeys(("VK_DRIVER_FILES", "VK_ICD_FILENAMES"), "/nowhere.json")
    assert _recording(**nowhere) == _recording()
