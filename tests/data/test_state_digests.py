"""State digests: all but pictures, and what a published collection says of a dataset."""

import json
import shutil
from pathlib import Path

import h5py
import pytest

from rtphys.core.errors import BadFile, UnknownName
from rtphys.data.dataset import Dataset
from rtphys.data.json_text import pretty
from rtphys.data.rewrite import convert, subset
from rtphys.data.state_digests import (
    DIGITS,
    Digests,
    TaskDigests,
    compare,
    find_digests,
    state_digest,
)


def published(dataset: Dataset) -> Digests:
    episodes = {str(one.seed): state_digest(one)[:DIGITS] for one in dataset}
    task = TaskDigests(
        config="phys_random",
        attempts=4,
        rejections={"slipped": 1},
        frames=sum(map(len, dataset)),
        sentences=9,
        bytes=1,
        cpu_seconds=1.5,
        episodes=episodes,
    )
    return Digests(
        what="three",
        command="rtphys collect",
        dataset_version="3.0",
        driver="llvmpipe",
        tasks={"click_bell": task, "lift_pot": task},
    )


@pytest.fixture
def copied(three: Path, tmp_path: Path) -> Dataset:
    shutil.copytree(three, tmp_path / "copy")
    return Dataset(tmp_path / "copy")


def test_pictures_the_layout_and_the_machine_do_not_count(three: Path, copied: Dataset) -> None:
    expected = [state_digest(one) for one in Dataset(three)]
    assert len(set(expected)) == 3
    convert(three, copied.path / "legacy", "legacy")
    assert [state_digest(one) for one in Dataset(copied.path / "legacy")] == expected
    label = copied[0].paths.phys_meta
    label.write_text(label.read_text().replace('"numpy": "', '"numpy": "9.'))
    with h5py.File(copied[1].paths.hdf5, "r+") as file:
        pictures = file["vision/cam_head/colors"]
        pictures[0] = pictures[1]
    assert [state_digest(one) for one in Dataset(copied.path)] == expected


@pytest.mark.parametrize("where", ["rtphys/command/left_arm", "rtphys/object_poses/bell"])
def test_the_least_bit_of_a_state_counts(where: str, three: Path, copied: Dataset) -> None:
    expected = state_digest(Dataset(three)[0])
    with h5py.File(copied[0].paths.hdf5, "r+") as file:
        values = file[where][...]
        values[-1, -1] += 1e-12
        file[where][...] = values
    assert state_digest(copied[0]) != expected


def test_a_label_counts(three: Path, copied: Dataset) -> None:
    label = copied[2].paths.phys_meta
    content = json.loads(label.read_text())
    content["attributes"]["friction"]["value"] += 1e-9
    label.write_bytes(pretty(content))
    assert state_digest(copied[2]) != state_digest(Dataset(three)[2])


def changed(listed: Digests, **changes: object) -> Digests:
    """Other entries of click_bell, the only task here."""
    task = listed.tasks["click_bell"].model_copy(update=changes)
    return listed.model_copy(update={"tasks": {"click_bell": task}})


def test_as_many_are_compared_as_there_are(three: Path) -> None:
    dataset = Dataset(three)
    listed = published(dataset)
    found = compare(dataset, listed, "ours")
    assert not found.problems
    assert str(found) == "3 of 3 episodes of 1 task have the states, actions and labels of ours"
    assert compare(dataset.where(numbers=[0, 1]), listed, "ours").episodes == 2
    assert compare(dataset, changed(listed, config="clean"), "ours").tasks == 0
    assert compare(dataset, changed(listed, embodiment="piper"), "ours").tasks == 0
    assert compare(dataset, changed(listed, episodes={}), "ours").tasks == 0


def test_a_part_is_compared_seed_by_seed(three: Path, tmp_path: Path) -> None:
    """Its first episode is the second of the collection; a longer one has more than is listed."""
    listed = published(Dataset(three))
    subset(Dataset(three).where(seeds=[1, 3]), tmp_path / "part")
    found = compare(Dataset(tmp_path / "part"), listed, "ours")
    assert (found.problems, found.episodes) == ([], 2)
    first = dict([*listed.tasks["click_bell"].episodes.items()][:2])
    found = compare(Dataset(three), changed(listed, episodes=first), "ours")
    assert (found.problems, found.episodes) == ([], 2)


def test_what_differs_is_named(three: Path) -> None:
    dataset = Dataset(three)
    listed = published(dataset)
    first, second, third = listed.tasks["click_bell"].episodes.items()
    episodes = dict([first, (second[0], 16 * "0"), ("2", third[1]), ("7", third[1])])
    found = compare(dataset, changed(listed, episodes=episodes), "ours")
    assert [(one.path.name, one.text) for one in found.problems] == [
        ("episode_0000001.json", "its states or its label are not those of ours"),
        ("episode_0000002.json", "is of seed 3, of which ours has no episode"),
        ("ledger.jsonl", "seed 2 was rejected, of which ours has an episode"),
    ]
    assert str(found).startswith("1 of 4 episodes of 1 task have")


def test_lists_are_found_by_name_and_by_path(three: Path, tmp_path: Path) -> None:
    path = tmp_path / "mine.json"
    listed = published(Dataset(three))
    path.write_bytes(pretty(listed.model_dump(mode="json"), sort=False))
    assert find_digests(str(path)) == listed
    path.write_text("{}")
    with pytest.raises(BadFile, match="what: field required"):
        find_digests(str(path))
    with pytest.raises(UnknownName, match="published collection"):
        find_digests("training_v0")
