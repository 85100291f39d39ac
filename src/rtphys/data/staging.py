"""Files of an attempt that has no number yet; made in a worker, committed elsewhere."""

import shutil
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import cast

from rtphys.core.timing import PhaseTimer
from rtphys.core.untrusted import JSON
from rtphys.data import files, schema
from rtphys.data.episode import Episode, Frames, Sensed
from rtphys.data.faults import BadEpisode
from rtphys.data.files import FileFacts
from rtphys.data.hdf5_episode import EpisodeFile, episode_bytes
from rtphys.data.json_text import pretty
from rtphys.data.layout import EpisodePaths
from rtphys.data.video import EncodedImages, encode_images

HDF5, VIDEO, INSTRUCTION = "data.hdf5", "video.mp4", "instruction.json"
PHYS_META = "phys_meta.json"  # written at commit, when the number is known


def targets(paths: EpisodePaths) -> dict[str, Path]:
    """Where the staged files belong once their number is known."""
    return dict(zip((HDF5, VIDEO, PHYS_META, INSTRUCTION), paths.all(), strict=True))


@dataclass(frozen=True)
class StagedEpisode:
    """Small and picklable; the bulk lies in `folder`."""

    seed: int
    folder: Path
    frames: int
    files: Mapping[str, FileFacts]  # by the names above
    phys_meta: Mapping[str, JSON]
    scene_info: Mapping[str, JSON]


@dataclass(frozen=True, eq=False)
class EncodedEpisode:
    """An episode whose pictures are streams already: fresh from the encoder, or from a file."""

    frames: Frames
    images: EncodedImages
    phys_meta: Mapping[str, JSON]
    scene_info: Mapping[str, JSON]
    instructions: Mapping[str, JSON]
    sensed: Sensed | None = None


def stage_episode(
    folder: Path, episode: Episode, layout: str = "native", timer: PhaseTimer | None = None
) -> StagedEpisode:
    """Encodes an episode into `folder`, syncs, re-reads and checks every file.

    Args:
        folder: `TaskWriter.staging(seed)`; whatever lies there is removed first.
        episode: its `images` are consumed.
        timer: takes the time of the phases render, encode and write.

    Raises:
        BadEpisode: the arrays contradict each other, a picture is missing.
        SchemaError: phys_meta, scene_info or instructions break their schema.
        CannotWrite: the file system refused; `folder` is gone again.
    """
    meta = {"recipe": episode.recipe, **episode.phys_meta, "episode": 0}
    kind = schema.FailureMeta if "failure" in meta else schema.PhysMeta
    parts = (
        schema.checked(kind, meta),
        schema.checked(schema.SceneEntry, episode.scene_info),
        schema.checked(schema.Instructions, episode.instructions),
    )
    if found := episode.frames.problems():  # before hours of rendering, not after
        raise BadEpisode(found)
    timer = timer or PhaseTimer()
    with timer.phase("render"):  # pictures are drawn as they are consumed
        images = encode_images(episode.images, layout)
    timer.shift(images.cpu_s, "render", "encode")
    with timer.phase("write"):
        encoded = EncodedEpisode(episode.frames, images, *parts, episode.sensed)
        return stage_encoded(folder, encoded, layout)


def stage_encoded(folder: Path, episode: EncodedEpisode, layout: str) -> StagedEpisode:
    """As `stage_episode`, for pictures that are encoded already."""
    frames, images, meta = episode.frames, episode.images, episode.phys_meta
    wanted = {name: len(frames) for name in frames.cameras}
    given = {name: len(streams) for name, streams in images.jpegs.items()}
    if wanted != given:
        raise BadEpisode([f"pictures {given} do not match the frames {wanted}"])
    if not images.video:
        raise BadEpisode(["there is no head_camera, which the video needs"])
    if folder.exists():
        shutil.rmtree(folder)
    files.make_folder(folder)
    try:
        task = str(meta["task"]).replace("_", " ")  # official where there is no sentence
        sentences = cast(list[str], episode.instructions["seen"]) or [task]
        data = episode_bytes(layout, frames, images, sentences, episode.sensed)
        words = pretty(episode.instructions, ascii_only=layout == "legacy")
        contents = {HDF5: data, VIDEO: images.video, INSTRUCTION: words}
        facts = {name: files.write_synced(folder / name, one) for name, one in contents.items()}
        count = len(EpisodeFile(folder / HDF5, layout).frames())
        if count != len(frames):
            raise BadEpisode([f"{folder / HDF5} holds {count} frames, not the {len(frames)} given"])
    except BaseException:
        shutil.rmtree(folder, ignore_errors=True)
        raise
    seed = cast(int, meta["seed"])
    return StagedEpisode(seed, folder, len(frames), facts, meta, episode.scene_info)
