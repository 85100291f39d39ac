"""From one official layout to the other, without decoding a picture or losing a number."""

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

from rtphys.core.errors import BadFile, UnknownName
from rtphys.data import files, schema
from rtphys.data.conditions import Conditions
from rtphys.data.encode import EncodedImages
from rtphys.data.episode import JSON, Frames
from rtphys.data.faults import DatasetMismatch
from rtphys.data.hdf5_file import open_read
from rtphys.data.hdf5_legacy import read_legacy
from rtphys.data.hdf5_native import read_native
from rtphys.data.journal import read_journal
from rtphys.data.json_text import parse_mapping
from rtphys.data.layout import LAYOUTS, MANIFEST, EpisodePaths, Leaf
from rtphys.data.schema import AttemptEntry, LeafEntry, Manifest
from rtphys.data.staging import EncodedEpisode, stage_encoded
from rtphys.data.writer import DatasetWriter, Rejection, TaskWriter

Progress = Callable[[int, int], None]  # episodes done, episodes in all


def read_manifest(out: Path) -> Manifest:
    """Raises `BadFile` when there is none or it breaks its schema."""
    path = out / MANIFEST
    try:
        manifest = schema.check("manifest", parse_mapping(files.read(path), path))
    except schema.SchemaError as error:
        raise BadFile(path, "; ".join(error.problems)) from error
    assert isinstance(manifest, Manifest)
    return manifest


def leaf_at(out: Path, entry: LeafEntry) -> Leaf:
    """Where the manifest's entry lies."""
    return Leaf(out, entry.config, entry.task, entry.embodiment, entry.layout)


def read_episode(path: Path, layout: str) -> tuple[Frames, EncodedImages]:
    """Frames and picture streams (no video) of an HDF5 file. Raises `BadFile`."""
    with open_read(path) as file:
        return read_legacy(file) if layout == "legacy" else read_native(file)[:2]


def convert(source: Path, out: Path, layout: str, progress: Progress | None = None) -> list[str]:
    """Writes every leaf of a dataset again in another layout; attempts and labels included.

    Stopped half-way, the same call goes on where it was. Converting back gives the same files.

    Returns:
        The leaves written.

    Raises:
        UnknownName: no such layout.
        BadFile: the source is damaged; names the file.
        DatasetMismatch: `out` is the source itself, or holds something else.
    """
    if layout not in LAYOUTS:
        raise UnknownName("layout", layout, LAYOUTS)
    if out.resolve() == source.resolve():
        raise DatasetMismatch(out, ["it is the dataset to convert"])
    manifest = read_manifest(source)
    total = sum(entry.episodes for entry in manifest.leaves.values())
    written, done = [], 0
    with DatasetWriter(out) as dataset:
        for entry in manifest.leaves.values():
            conditions = conditions_of(entry, manifest.domains, layout)
            task = dataset.task(conditions, entry.episodes)
            for _ in _copy(leaf_at(source, entry), entry, task):
                done += 1
                dataset.checkpoint_if_due()
                if progress:
                    progress(done, total)
            written.append(task.leaf.name)
    return written


def conditions_of(
    entry: LeafEntry, domains: Mapping[str, Mapping[str, JSON]], layout: str
) -> Conditions:
    """The conditions that a task dataset was collected under, for another layout."""
    own = {} if entry.config == entry.protocol else {"config": entry.config}
    header = (
        entry.model_dump(mode="json", exclude={"config"})
        | own
        | {
            "protocol": entry.protocol or entry.config,
            "domain": {**domains[entry.domain.digest], **entry.domain.model_dump(mode="json")},
            "layout": layout,
        }
    )
    return Conditions.from_json(header)


def _copy(leaf: Leaf, entry: LeafEntry, task: TaskWriter) -> Iterator[None]:
    """Yields once per episode committed."""
    rejections = _rejections(leaf, entry)
    scenes = parse_mapping(files.read(leaf.scene_info), leaf.scene_info)
    number = 0
    for attempt in entry.attempts:
        if attempt.seed < task.next_seed:  # done by an earlier call
            number += attempt.verdict == "accepted"
            continue
        if attempt.verdict == "rejected":
            task.record(rejections[attempt.seed])
            continue
        episode = _encoded(leaf.episode(number), leaf.layout, scenes.get(f"episode_{number}"))
        folder = task.staging(attempt.seed)
        task.record(stage_encoded(folder, episode, task.conditions.layout))
        number += 1
        yield


def _rejections(leaf: Leaf, entry: LeafEntry) -> dict[int, Rejection]:
    """By seed; with detail and physics where the journal still is."""
    found = {a.seed: _bare(a) for a in entry.attempts if a.verdict == "rejected"}
    if not leaf.journal.exists():
        return found
    for line in read_journal(leaf.journal).lines[1:]:
        seed, physics = line.entry["seed"], line.entry.get("physics")
        if line.entry["verdict"] == "rejected" and isinstance(seed, int):
            found[seed] = Rejection(
                seed,
                str(line.entry["reason"]),
                str(line.entry["detail"]),
                physics if isinstance(physics, Mapping) else {},
            )
    return found


def _bare(attempt: AttemptEntry) -> Rejection:
    return Rejection(attempt.seed, attempt.reason or "")


def _encoded(paths: EpisodePaths, layout: str, scene: JSON) -> EncodedEpisode:
    frames, images = read_episode(paths.hdf5, layout)
    images.video = files.read(paths.video)
    meta = parse_mapping(files.read(paths.phys_meta), paths.phys_meta)
    words = parse_mapping(files.read(paths.instruction), paths.instruction)
    if not isinstance(scene, Mapping):
        raise BadFile(paths.hdf5, "scene_info.json has no entry for this episode")
    return EncodedEpisode(frames, images, meta, scene, words)
