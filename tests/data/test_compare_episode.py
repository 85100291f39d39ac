"""An episode that was made again is compared with the stored one."""

from pathlib import Path

import h5py
import pytest
import synthetic
from collected import FRAMES, collect

from rtphys.data import files
from rtphys.data.compare import CONTAINER, RegeneratedEpisode, compare_episode
from rtphys.data.dataset import Dataset, Episode
from rtphys.data.hdf5_episode import EpisodeFile
from rtphys.data.staging import HDF5, stage_episode

Again = tuple[Episode, RegeneratedEpisode]


@pytest.fixture
def again(tmp_path: Path) -> Again:
    """A stored episode, and the same made again."""
    collect(tmp_path / "data", 1)
    one, folder = Dataset(tmp_path / "data")[0], tmp_path / "again"
    staged = stage_episode(folder, synthetic.episode(one.seed, FRAMES))
    frames = EpisodeFile(folder / HDF5, one.layout).frames()
    words, label = one.instructions.model_dump(), {**staged.phys_meta, "episode": one.number}
    return one, RegeneratedEpisode(frames, label, staged.scene_info, words, folder)


def test_an_episode_may_be_larger_than_other_files(
    again: Again, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its HDF5 file has a bound of its own, as every reader knows."""
    one, made = again
    size = one.paths.hdf5.stat().st_size
    monkeypatch.setattr(files.read, "__defaults__", (size - 1,))
    found = compare_episode(one.paths, one.layout, made)
    assert found.problems == [] and CONTAINER in found.exact


@pytest.mark.parametrize("changed", ["nothing", "instructions"])
def test_a_file_of_another_library_holds_the_same(again: Again, changed: str) -> None:
    """Its bytes are others, its arrays and sentences are not."""
    one, made = again
    with h5py.File(one.paths.hdf5, "r+") as file:
        file.create_dataset("room", data=range(99))
        del file["room"]
        if changed == "instructions":
            del file[changed]
            file[changed] = '["Ring it."]'
    found = compare_episode(one.paths, one.layout, made)
    if changed == "nothing":
        assert not found.problems and [kind for kind, _, _ in found.alike] == [CONTAINER]
    else:
        assert "other sentences" in str(found.problems) and not found.alike
