"""Small synthetic datasets, collected as `collect` does it; every third seed is rejected."""

import json
import pickle
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import synthetic

from rtphys.data.dataset import Dataset
from rtphys.data.episode import Episode
from rtphys.data.staging import StagedEpisode, stage_episode
from rtphys.data.writer import DatasetWriter, Rejection, TaskWriter
from rtphys.spec.collection import TaskHeader

FRAMES = 4
FOLDER = "phys_random/click_bell/aloha_agilex"
FAILURE = {
    "reason": "slipped",
    "detail": "bell left the left hand",
    "event": "slip",
    "frame": 2,
    "time": 0.12,
    "object": "bell",
    "side": "left",
}


def rejected(seed: int) -> bool:
    return seed % 3 == 2


def outcome(task: TaskWriter, seed: int) -> StagedEpisode | Rejection:
    """Of a seed; with its files if the task dataset keeps failures. As it comes from a worker."""
    spec, folder = task.header.spec, task.staging(seed)
    made: StagedEpisode | Rejection
    episode = synthetic.episode(seed, FRAMES, spec.episode)
    if not rejected(seed):
        made = stage_episode(folder, episode, spec.recording.layout)
    else:
        made = Rejection(seed, "slipped", "bell left the left hand", {"friction": 0.1})
        if task.wants_failures:
            meta = {**episode.phys_meta, "failure": FAILURE}
            meta["verdict"] = {**meta["verdict"], "accepted": False}  # type: ignore[dict-item]
            failed = replace(episode, phys_meta=meta)
            made = replace(made, kept=stage_episode(folder, failed, spec.recording.layout))
    return pickle.loads(pickle.dumps(made))


def wanting(episodes: int, what: TaskHeader | None = None) -> TaskHeader:
    """The same, but so many episodes."""
    what = what or synthetic.header()
    return replace(what, spec=replace(what.spec, episodes=episodes))


def collect(
    out: Path, episodes: int, what: TaskHeader | None = None, attempts: int | None = None
) -> Path:
    """Until there are so many episodes, or attempts. Returns the folder."""
    with DatasetWriter(out) as dataset:
        task = dataset.task(wanting(max(episodes, 1), what))
        while task.totals.episodes < episodes and task.totals.attempts != attempts:
            task.record(outcome(task, task.next_seed))
    return out


def write(out: Path, *episodes: Episode, what: TaskHeader | None = None) -> Dataset:
    """These episodes, of seeds 0, 1, ..., and nothing else of that task dataset."""
    with DatasetWriter(out) as dataset:
        task = dataset.task(wanting(len(episodes), what))
        for seed, one in enumerate(episodes):
            task.record(stage_episode(task.staging(seed), one, task.header.spec.recording.layout))
    return Dataset(out)


def labelled(**changes: Mapping[str, object]) -> Episode:
    """Episode of seed 0; attribute -> what its label says instead."""
    episode = synthetic.episode(0)
    labels: Any = episode.phys_meta["attributes"]
    changed = {key: {**label, **changes.get(key, {})} for key, label in labels.items()}
    return replace(episode, phys_meta={**episode.phys_meta, "attributes": changed})


def keep(out: Path, kept: str | None = "all", attempts: int = 7) -> None:
    """So many attempts, and the failures among them."""
    collect(out, attempts, synthetic.header(keep_failures=kept), attempts)


def run_ahead(out: Path) -> None:
    """Three episodes of a run that wrote its manifest after the second attempt of four."""
    collect(out, 2)
    old = {name: data for name, data in content(out).items() if "ledger" not in name}
    collect(out, 3)
    for name in ("manifest.json", *(f"{FOLDER}/{n}" for n in ("seed.txt", "scene_info.json"))):
        (out / name).write_bytes(old[name])


def content_but_pictures(out: Path) -> dict[str, object]:
    """As `content`; of HDF5 files all but the picture streams, without digests of whole files."""
    found: dict[str, object] = {}
    for name, data in content(out).items():
        if name.endswith(".hdf5"):
            with h5py.File(out / name) as file:
                nodes: dict[str, object] = {}
                file.visititems(lambda key, node, nodes=nodes: nodes.update({key: _plain(node)}))
            found[name] = nodes
        elif name.endswith("ledger.jsonl"):
            texts = [line.partition(b" ")[2] for line in data.splitlines()]
            found[name] = [json.loads(text, object_hook=_without_files) for text in texts]
        elif name == "manifest.json":
            task_datasets = json.loads(data)["task_datasets"]
            found[name] = {key: {**one, "ledger": None} for key, one in task_datasets.items()}
        else:
            found[name] = data
    return found


def _without_files(node: dict[str, object]) -> dict[str, object]:
    return {key: value for key, value in node.items() if key != "files"}


def _plain(node: h5py.Group | h5py.Dataset) -> object:
    notes = {key: str(value) for key, value in node.attrs.items()}
    if not isinstance(node, h5py.Dataset):
        return notes
    streams = node.dtype.kind == "S"
    return (
        notes,
        node.shape,
        None if streams else str(node.dtype),
        streams or np.asarray(node[()]).tobytes(),
    )


def content(out: Path) -> dict[str, bytes]:
    """Every file below a folder."""
    return {p.relative_to(out).as_posix(): p.read_bytes() for p in out.rglob("*") if p.is_file()}
