"""An episode that was made again is compared with the stored one."""

from pathlib import Path

import pytest
import synthetic
from collected import FRAMES, collect

from rtphys.data import files
from rtphys.data.compare import CONTAINER, RegeneratedEpisode, compare_episode
from rtphys.data.dataset import Dataset
from rtphys.data.hdf5_episode import EpisodeFile
from rtphys.data.staging import HDF5, stage_episode


def test_an_episode_may_be_larger_than_other_files(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its HDF5 file has a bound of its own, as every reader knows."""
    collect(tmp_path / "data", 1)
    one, folder = Dataset(tmp_path / "data")[0], tmp_path / "again"
    staged = stage_episode(folder, synthetic.episode(one.seed, FRAMES))
    frames = EpisodeFile(folder / HDF5, one.layout).frames()
    words, label = one.instructions.model_dump(), {**staged.phys_meta, "episode": one.number}
    made = RegeneratedEpisode(frames, label, staged.scene_info, words, folder)
    size = one.paths.hdf5.stat().st_size
    monkeypatch.setattr(files.read, "__defaults__", (size - 1,))
    found = compare_episode(one.paths, one.layout, made)
    assert found.problems == [] and CONTAINER in found.exact
