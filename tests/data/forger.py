"""Rewrites a dataset so that all its checksums are right again.

A forger changes files and lines, then ledger, side files and manifest follow from them.
"""

import json
from collections.abc import Callable
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from rtphys.data import jpeg
from rtphys.data.episode import Frames
from rtphys.data.files import facts_of
from rtphys.data.hdf5_episode import episode_bytes, read_episode
from rtphys.data.hdf5_file import open_read
from rtphys.data.json_text import compact, pretty
from rtphys.data.layout import EMBODIMENT, MANIFEST, TaskDataset
from rtphys.data.ledger import START, chained, read_header
from rtphys.data.manifest import manifest_bytes, read_entry
from rtphys.data.video import EncodedImages, encode_images
from rtphys.data.writer import write_side_files
from rtphys.spec.collection import TaskHeader

HEAD = "head_camera"
Entry = dict[str, Any]


@dataclass
class Forger:
    """A dataset of one task: seed 0 is rejected, seeds 1 and 2 are its episodes."""

    place: TaskDataset
    entries: list[Entry] = field(default_factory=list)  # of its ledger, the header first

    def __post_init__(self) -> None:
        self.entries = read_entries(self.place.ledger)

    @property
    def header(self) -> Entry:
        """What was collected."""
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
            seen = json.loads(file["instructions"][()])
        frames, images, _ = read_episode(paths.hdf5, "native")
        frames = change(frames, images) or frames
        paths.hdf5.write_bytes(episode_bytes("native", frames, images, seen))
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
        """Makes ledger, side files and manifest of what is there now."""
        place = self.place
        for entry in self.entries[1:]:
            holder = entry if entry["verdict"] == "accepted" else entry.get("kept")
            names = holder["files"] if holder else ()
            for name in [name for name in names if (place.folder / name).is_file()]:
                holder["files"][name] = asdict(facts_of(place.folder / name))
        write_entries(place.ledger, self.entries)
        header = read_header(TaskHeader, place.ledger)
        entry = read_entry(place, header)
        write_side_files(place, entry.failures)
        (place.out / MANIFEST).write_bytes(manifest_bytes({place.name: entry}))


def read_entries(ledger: Path) -> list[Entry]:
    """The JSON of every line."""
    return [json.loads(line.partition(b" ")[2]) for line in ledger.read_bytes().splitlines()]


def write_entries(ledger: Path, entries: list[Entry], raw: str = "") -> None:
    """Lines with a sound chain, even of what no writer would write.

    Args:
        raw: text instead of the value "@here@".
    """
    check, lines = START, list[bytes]()
    for entry in entries:
        try:
            text = compact(entry)
        except UnicodeEncodeError:  # half a character
            text = json.dumps(entry).encode()
        text = text.replace(b'"@here@"', raw.encode()) if raw else text
        check = chained(check, text)
        lines.append(check.encode() + b" " + text + b"\n")
    ledger.write_bytes(b"".join(lines))


Forge = Callable[[Forger], object]


def put(*way: Any, value: Any) -> Callable[[Any], None]:
    """Sets a value deep in a JSON object; a function is given the old one."""

    def change(node: Any) -> None:
        for step in way[:-1]:
            node = node[step]
        node[way[-1]] = value(node[way[-1]]) if callable(value) else value

    return change


def forge(out: Path, change: Forge) -> None:
    """Applies a forgery to the dataset of one task, and makes all checksums anew."""
    (ledger,) = out.glob("*/*/*/ledger.jsonl")
    config, task, _ = ledger.parent.relative_to(out).parts
    forger = Forger(TaskDataset(out, config, task, EMBODIMENT, "native"))
    change(forger)
    forger.finish()
