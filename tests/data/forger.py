"""Rewrites a dataset so that all its checksums are right again.

A forger changes files and entries, then journal, side files and manifest follow from them.
"""

import json
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from rtphys.data import jpeg
from rtphys.data.encode import EncodedImages, encode_images
from rtphys.data.episode import Frames
from rtphys.data.files import facts_of
from rtphys.data.hdf5_file import open_read
from rtphys.data.hdf5_native import native_bytes, read_native
from rtphys.data.journal import Journal, read_journal
from rtphys.data.json_text import pretty
from rtphys.data.layout import TaskDataset
from rtphys.data.manifest import TaskDatasetHistory, manifest_of

HEAD = "head_camera"
Entry = dict[str, Any]


@dataclass
class Forger:
    """A dataset of one task: seed 0 is rejected, seeds 1 and 2 are its episodes."""

    place: TaskDataset
    entries: list[Entry] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.entries = [json.loads(json.dumps(e)) for e in Journal(self.place.journal).entries()]

    @property
    def header(self) -> Entry:
        """The conditions."""
        return self.entries[0]

    def entry(self, number: int) -> Entry:
        """Of an episode."""
        return next(one for one in self.entries if one.get("episode") == number)

    def label(self, number: int, change: Callable[[Entry], object]) -> None:
        """Rewrites a label."""
        path = self.place.episode(number).phys_meta
        content = json.loads(path.read_text())
        change(content)
        path.write_bytes(pretty(content))

    def hdf5(
        self,
        number: int,
        change: Callable[[Frames, EncodedImages], Frames | None],
        video: bool = False,
    ) -> None:
        """Rewrites an episode's arrays and pictures, the official ones along; also its video."""
        paths = self.place.episode(number)
        with open_read(paths.hdf5) as file:
            frames, images, seen = read_native(file)
        frames = change(frames, images) or frames
        paths.hdf5.write_bytes(native_bytes(frames, images, seen, ""))
        if video:
            pictures = ({HEAD: jpeg.decode(one)} for one in images.jpegs[HEAD])
            paths.video.write_bytes(encode_images(pictures).video)

    def arrays(self, number: int, **changed: Callable[[np.ndarray], np.ndarray]) -> None:
        """Rewrites arrays by name."""
        self.hdf5(
            number,
            lambda frames, _: replace(
                frames, **{k: f(getattr(frames, k)) for k, f in changed.items()}
            ),
        )

    def pictures(
        self, number: int, draw: Callable[[int, np.ndarray], np.ndarray | bytes], video: bool = True
    ) -> None:
        """Draws every picture of the head camera anew, from its number and pixels."""

        def change(_: Frames, images: EncodedImages) -> None:
            for index, stream in enumerate(images.jpegs[HEAD]):
                new = draw(index, jpeg.decode(stream))
                images.jpegs[HEAD][index] = new if isinstance(new, bytes) else jpeg.encode(new)

        self.hdf5(number, change, video)

    def finish(self) -> None:
        """Makes journal, side files and manifest of what is there now."""
        place = self.place
        place.journal.unlink()
        journal = Journal(place.journal)
        for entry in self.entries:
            if entry.get("verdict") == "accepted":
                paths = place.episode(entry["episode"]).all()
                names = [path.relative_to(place.folder).as_posix() for path in paths]
                entry["files"] = {n: facts_of(place.folder / n).model_dump() for n in names}
            journal.append(entry, durable=False)
        history = TaskDatasetHistory(place, read_journal(place.journal).lines)
        for path, data in history.side_files().items():
            path.write_bytes(data)
        (place.out / "manifest.json").write_bytes(manifest_of([history]))


Forge = Callable[[Forger], object]


def forge(out: Path, change: Forge) -> None:
    """Applies a forgery to the dataset, and makes all checksums anew."""
    (journal,) = out.glob("*/*/*/journal.jsonl")
    config, task, _ = journal.parent.relative_to(out).parts
    forger = Forger(TaskDataset(out, config, task))
    change(forger)
    forger.finish()
