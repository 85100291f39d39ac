"""Stages a committed attempt again, to be committed in another folder with another number."""

import shutil
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from rtphys.core.bounds import LARGEST_EPISODE
from rtphys.core.errors import BadFile
from rtphys.data import files, staging
from rtphys.data.episode import JSON
from rtphys.data.files import FileFacts
from rtphys.data.json_text import parse_mapping
from rtphys.data.layout import EpisodePaths, TaskDataset
from rtphys.data.staging import StagedEpisode
from rtphys.data.task_writer import Rejection

Entry = Mapping[str, JSON]


def restage(source: TaskDataset, entry: Entry, folder: Path) -> StagedEpisode | Rejection:
    """The outcome of a committed attempt, as its worker returned it.

    Args:
        source: where the attempt was committed.
        entry: of its journal.
        folder: `TaskWriter.staging(seed)` of the writer that will have it.

    Raises:
        BadFile: a file is missing, or not what the journal says.
        CannotWrite: the disk refuses.
    """
    if entry["verdict"] == "accepted":
        return _episode(source, entry, source.episode(_number(entry["episode"])), folder)
    rejection, kept = Rejection.of(entry), entry.get("kept")
    if not isinstance(kept, Mapping):
        return rejection
    paths = source.failures.episode(_number(kept["number"]))
    listed = {**kept, "seed": entry["seed"]}
    return replace(rejection, kept=_episode(source, listed, paths, folder))


def _number(value: JSON) -> int:
    assert isinstance(value, int)
    return value


def _episode(source: TaskDataset, entry: Entry, paths: EpisodePaths, folder: Path) -> StagedEpisode:
    seed = _number(entry["seed"])
    frames, scene = entry["frames"], entry["scene_info"]
    assert isinstance(frames, int)
    assert isinstance(scene, Mapping)
    sources = {
        staging.HDF5: paths.hdf5,
        staging.VIDEO: paths.video,
        staging.INSTRUCTION: paths.instruction,
    }
    meta = parse_mapping(_sound(source, entry, paths.phys_meta), paths.phys_meta)
    _check_label(meta, paths.phys_meta)
    del meta["episode"]  # its number changes
    shutil.rmtree(folder, ignore_errors=True)
    files.make_folder(folder)
    facts = {
        name: files.write_synced(folder / name, _sound(source, entry, path))
        for name, path in sources.items()
    }
    return StagedEpisode(seed, folder, frames, facts, meta, scene)


def _check_label(meta: Entry, path: Path) -> None:
    """Refuses a label that has not what the journal will tell of it."""
    attributes = meta.get("attributes")
    labels = attributes.values() if isinstance(attributes, Mapping) else [None]
    whole = "episode" in meta and isinstance(meta.get("verdict"), Mapping)
    if not whole or not all(isinstance(one, Mapping) and "value" in one for one in labels):
        raise BadFile(path, "episode, verdict or attributes are missing")


def _sound(source: TaskDataset, entry: Entry, path: Path) -> bytes:
    """A file's content, if it is what the journal says."""
    listed = entry["files"]
    assert isinstance(listed, Mapping)
    data = files.read(path, LARGEST_EPISODE)
    if FileFacts.of(data).model_dump() != listed.get(path.relative_to(source.folder).as_posix()):
        raise BadFile(path, "is not what its journal says")
    return data
