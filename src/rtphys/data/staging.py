"""Files of an accepted attempt that has no number yet; made in a worker, committed elsewhere."""

import shutil
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from pydantic import BaseModel

from rtphys.data import files, schema
from rtphys.data.encode import EncodedImages, encode_images
from rtphys.data.episode import JSON, Episode
from rtphys.data.faults import BadEpisode
from rtphys.data.files import FileFacts
from rtphys.data.hdf5_file import open_read
from rtphys.data.hdf5_legacy import legacy_bytes
from rtphys.data.hdf5_native import native_bytes
from rtphys.data.hdf5_record import read_record
from rtphys.data.json_text import plain, pretty

HDF5, VIDEO, INSTRUCTION = "data.hdf5", "video.mp4", "instruction.json"
PHYS_META = "phys_meta.json"  # written at commit, when the number is known


@dataclass(frozen=True)
class StagedEpisode:
    """Small and picklable; the bulk lies in `folder`."""

    seed: int
    folder: Path
    frames: int
    files: Mapping[str, FileFacts]  # by the names above
    phys_meta: Mapping[str, JSON]
    scene_info: Mapping[str, JSON]


def stage_episode(folder: Path, episode: Episode, layout: str = "native") -> StagedEpisode:
    """Encodes an episode into `folder`, syncs, re-reads and checks every file.

    Args:
        folder: `TaskWriter.staging(seed)`; whatever lies there is removed first.
        episode: its `images` are consumed.
        layout: "native" or "legacy".

    Raises:
        BadEpisode: the arrays contradict each other, a picture is missing.
        SchemaError: phys_meta, scene_info or instructions break their schema.
        CannotWrite: the file system refused; `folder` is gone again.
    """
    meta, scene, words = _checked(episode)
    if found := episode.frames.problems():
        raise BadEpisode(found)
    if folder.exists():
        shutil.rmtree(folder)
    files.make_folder(folder)
    try:
        images = encode_images(episode.images)
        _check_images(episode, images)
        written = _write(folder, episode, images, layout)
        _reopen(folder / HDF5, len(episode.frames))
    except BaseException:
        shutil.rmtree(folder, ignore_errors=True)
        raise
    facts = {**written, INSTRUCTION: _write_words(folder, words, layout)}
    seed = meta["seed"]
    assert isinstance(seed, int)
    return StagedEpisode(seed, folder, len(episode.frames), facts, meta, scene)


def _checked(episode: Episode) -> tuple[dict[str, JSON], dict[str, JSON], dict[str, JSON]]:
    meta = {"recipe": episode.recipe, **episode.phys_meta, "episode": 0}
    return (
        _dumped(schema.check("phys_meta", plain(meta, "phys_meta"))),
        _dumped(schema.check("scene_info", plain(episode.scene_info, "scene_info"))),
        _dumped(schema.check("instruction", plain(episode.instructions, "instructions"))),
    )


def _dumped(model: BaseModel) -> dict[str, JSON]:
    return model.model_dump(mode="json")


def _check_images(episode: Episode, images: EncodedImages) -> None:
    wanted = {name: len(episode.frames) for name in episode.frames.cameras}
    given = {name: len(streams) for name, streams in images.jpegs.items()}
    if wanted != given:
        raise BadEpisode([f"pictures {given} do not match the frames {wanted}"])
    if not images.video:
        raise BadEpisode(["there is no head_camera, which the video needs"])


def _write(
    folder: Path, episode: Episode, images: EncodedImages, layout: str
) -> dict[str, FileFacts]:
    if layout == "legacy":
        data = legacy_bytes(episode.frames, images)
    else:
        task = str(episode.phys_meta["task"]).replace("_", " ")
        data = native_bytes(episode.frames, images, episode.instructions, task)
    return {
        HDF5: files.write_synced(folder / HDF5, data),
        VIDEO: files.write_synced(folder / VIDEO, images.video),
    }


def _write_words(folder: Path, words: Mapping[str, JSON], layout: str) -> FileFacts:
    text = pretty(words, ascii_only=layout == "legacy")
    return files.write_synced(folder / INSTRUCTION, text)


def _reopen(path: Path, frames: int) -> None:
    with open_read(path) as file:
        found = len(read_record(file))
    if found != frames:
        raise BadEpisode([f"{path} holds {found} frames after writing {frames}"])
