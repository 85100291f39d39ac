"""Datasets that nobody should give: each a change to a sound one, with its checksums made anew.

A case is named by its label; it changes the folder `dataset`, and may point at `outside`, a folder
whose files may neither be read nor written.
"""

import json
import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from collected import FOLDER
from forger import Entry, put, read_entries, write_entries

from rtphys.core.untrusted import JSON
from rtphys.data.files import FileFacts
from rtphys.data.ledger import read_lines

LEDGER = f"{FOLDER}/ledger.jsonl"
Place = tuple[str | int, ...]
Change = Callable[[Path, Path], None]  # the dataset, the folder outside

NAMES = (
    *("../outside", "..", ".", "", "/elsewhere/x", "a/../../outside", "a\0b", "x" * 300, ".hidden"),
    *("a\nb", "\x1b[31m", "a\\b", " ", "\ud800", "//", "a/", "\u202egnp", "-" * 201),
)
PATHS = (
    *("../outside/secret.txt", "/etc/hostname", "/dev/zero", "a//b", "", "./manifest.json", "a/.."),
    *("x\0y", "phys_random/../../outside/secret.txt", "x" * 5000, "../" * 40 + "dev/zero"),
)
VALUES = (
    *(None, True, -1, 0, 10**12, 10**18, 10**19, 10**4000, -(2**70), 1.5, 1e308, "", "x", [], {}),
    *([1], [1, 2, 3, 4], [0, 0], [[]], {"a": {}}, [None], "\x1b]0;x\x07", "[/]", "NaN", "\0"),
)
RAW = (  # JSON text that no `json.dumps` writes
    *("1e999", "-1e999", "NaN", "Infinity", '"\\ud800"', '"\\udfff\\ud800"', "9" * 5000, "-0"),
    *("[" * 70 + "]" * 70, '{"a":' * 70 + "1" + "}" * 70, '{"a":1,"a":2}', "1E+400", '"\\u0000"'),
)


@dataclass(frozen=True)
class Hostile:
    """One change, and its label for messages."""

    label: str
    apply: Change


def corpus() -> Iterator[Hostile]:
    """Every case, in a stable order."""
    yield from _names()
    yield from _values("manifest.json", MANIFEST_PLACES)
    yield from _values(f"{FOLDER}/phys_meta/episode_0000000.json", LABEL_PLACES)
    yield from _values(f"{FOLDER}/instruction/episode_0000000.json", (("seen",), ("seen", 0)))
    yield from _ledger()
    yield from _strange_files()


OF_SPEC: tuple[Place, ...] = (
    *(("episode", "only"), ("episode", "overrides"), ("episode", "ranges"), ("first_seed",)),
    *(("recording", "cameras"), ("recording", "size"), ("twin",), ("keep_failures",), ("shards",)),
)
OF_HEADER: tuple[Place, ...] = (
    *(("spec", *place) for place in OF_SPEC),
    *(("resolved", "domain", "digest"), ("resolved", "visual"), ("resolved", "versions")),
    *(("resolved", "domain", "rules"), ("resolved", "assets"), ("resolved",), ("spec",)),
)
OF_ENTRY: tuple[Place, ...] = (
    *(("episodes",), ("attempts",), ("failures",), ("rejections",), ("could_act",), ("listed",)),
    *(("ledger", "lines"), ("ledger", "bytes"), ("ledger", "check"), ("ledger",)),
)
MANIFEST_PLACES: tuple[Place, ...] = (
    *(("task_datasets", FOLDER, *place) for place in (*OF_HEADER, *OF_ENTRY)),
    *(("task_datasets", FOLDER), ("dataset_version",), ("task_datasets",)),
)
LABEL_PLACES: tuple[Place, ...] = (
    *(("seed",), ("attributes",), ("attributes", "friction", "value"), ("draws",), ("recipe",)),
    *(("attributes", "center_of_mass", "value"), ("cameras",), ("verdict",), ("episode",)),
    *(("verdict", "first_success_time"), ("readback", "bodies"), ("state_hash",), ("task",)),
)
OF_ROW: tuple[Place, ...] = (
    *(("seed",), ("episode",), ("frames",), ("files",), ("scene_info",), ("physics",)),
    *(("verdict",), ("recovered",), ("physics", "friction"), ("scene_info", "info", "{A}")),
)
PLACE_NAMES: tuple[Place, ...] = (  # what the folder of a task dataset is called after
    *(("spec", "episode", key) for key in ("task", "protocol", "embodiment")),
    *(("spec", "config"), ("spec", "twin"), ("spec", "twin_of"), ("spec", "recording", "layout")),
)


def _names() -> Iterator[Hostile]:
    for place in PLACE_NAMES:
        for name in NAMES:
            label = f"manifest {'.'.join(map(str, place))} = {name!r}"
            yield Hostile(
                label, partial(_put, "manifest.json", ("task_datasets", FOLDER, *place), name)
            )
    for name in NAMES:
        yield Hostile(f"manifest lists {name!r}", partial(_renamed, name))


def _values(file: str, places: tuple[Place, ...]) -> Iterator[Hostile]:
    for place in places:
        where = ".".join(map(str, place)).replace(FOLDER, "*")
        for value in VALUES:
            yield Hostile(
                f"{file} {where} = {str(value)[:20]!r}", partial(_put, file, place, value)
            )
        for text in RAW:
            yield Hostile(f"{file} {where} = {text[:20]}", partial(_put_raw, file, place, text))


def _ledger() -> Iterator[Hostile]:
    for place in PLACE_NAMES:
        for name in NAMES[:6]:
            label = f"ledger {'.'.join(map(str, place))} = {name!r}"
            yield Hostile(label, partial(_rewritten, 0, place, name, ""))
    for line, places in ((0, OF_HEADER), (1, OF_ROW)):
        for place in places:
            for value in VALUES:
                label = f"line {line + 1} {'.'.join(map(str, place))} = {str(value)[:20]!r}"
                yield Hostile(label, partial(_rewritten, line, place, value, ""))
            for text in RAW:
                label = f"line {line + 1} {'.'.join(map(str, place))} = {text[:20]}"
                yield Hostile(label, partial(_rewritten, line, place, "@here@", text))
    for path in PATHS:
        facts: JSON = {path: {"size": 1, "sha256": "0" * 64}}
        yield Hostile(f"attempt lists {path!r}", partial(_rewritten, 1, ("files",), facts, ""))
    yield Hostile("a planted ledger", _planted)


def _strange_files() -> Iterator[Hostile]:
    files = ("manifest.json", LEDGER, f"{FOLDER}/scene_info.json")
    files += tuple(f"{FOLDER}/{kind}/episode_0000000.{end}" for kind, end in EPISODE)
    for name in files:
        yield Hostile(f"{name} is a FIFO", partial(_replaced, name, os.mkfifo))
        yield Hostile(f"{name} is a folder", partial(_replaced, name, os.mkdir))
        yield Hostile(f"{name} -> /dev/zero", partial(_linked, name, "/dev/zero"))
        yield Hostile(f"{name} -> itself", partial(_linked, name, Path(name).name))
        yield Hostile(f"{name} -> outside", partial(_linked, name, None))
    for name in (FOLDER, "phys_random", *(f"{FOLDER}/{kind}" for kind, _ in EPISODE)):
        yield Hostile(f"{name}/ is a link", partial(_linked_folder, name))
    for name in (f"{FOLDER}/.staging", f"{FOLDER}/seed.txt", ".rtphys.lock", ".manifest.json.part"):
        yield Hostile(f"{name} -> outside", partial(_linked, name, None))


EPISODE = (("data", "hdf5"), ("video", "mp4"), ("phys_meta", "json"), ("instruction", "json"))


# ---- the changes: of the dataset, with a folder outside ------------------------------------------


def _edit(path: Path, place: Place, value: object) -> None:
    content = json.loads(path.read_text())
    put(*place, value=value)(content)
    path.write_text(json.dumps(content))


def _write(dataset: Path, entries: list[Entry], raw: str = "") -> None:
    """A ledger with a sound chain, and a manifest that agrees with it."""
    write_entries(dataset / LEDGER, entries, raw)
    *_, last = read_lines(dataset / LEDGER)
    state = {"lines": last.number, "bytes": last.end, "check": last.check}
    _edit(dataset / "manifest.json", ("task_datasets", FOLDER, "ledger"), state)


def _put(file: str, place: Place, value: object, dataset: Path, _: Path, raw: str = "") -> None:
    """A value of a JSON file, whose checksum is made anew. `raw` replaces "@here@"."""
    path = dataset / file
    _edit(path, place, value)
    if raw:
        path.write_text(path.read_text().replace('"@here@"', raw))
    if file != "manifest.json":
        facts, entries = FileFacts.of(path.read_bytes()), read_entries(dataset / LEDGER)
        listed = {"size": facts.size, "sha256": facts.sha256}
        entries[1]["files"][file.removeprefix(f"{FOLDER}/")] = listed
        _write(dataset, entries)


def _put_raw(file: str, place: Place, text: str, dataset: Path, outside: Path) -> None:
    _put(file, place, "@here@", dataset, outside, text)


def _renamed(name: str, dataset: Path, _: Path) -> None:
    """The task dataset's key in the manifest."""
    content = json.loads((dataset / "manifest.json").read_text())
    content["task_datasets"] = {name: content["task_datasets"][FOLDER]}
    (dataset / "manifest.json").write_text(json.dumps(content))


def _rewritten(line: int, place: Place, value: object, raw: str, dataset: Path, _: Path) -> None:
    """A line changed, and the chain of checks made anew. `raw` replaces "@here@"."""
    entries = read_entries(dataset / LEDGER)
    put(*place, value=value)(entries[line])
    _write(dataset, entries, raw)


def _planted(dataset: Path, _: Path) -> None:
    """A ledger in a folder of its own that says it were that of a folder outside."""
    entries = read_entries(dataset / LEDGER)
    put("spec", "config", value="../outside")(entries[0])
    (dataset / "a/b/c").mkdir(parents=True)
    write_entries(dataset / "a/b/c/ledger.jsonl", entries)


def _replaced(name: str, make: Callable[[Path], None], dataset: Path, _: Path) -> None:
    (dataset / name).unlink()
    make(dataset / name)


def _linked(name: str, target: str | None, dataset: Path, outside: Path) -> None:
    (dataset / name).unlink(missing_ok=True)
    (dataset / name).symlink_to(target or outside / "secret.txt")


def _linked_folder(name: str, dataset: Path, outside: Path) -> None:
    (dataset / name).rename(outside / "moved")
    (dataset / name).symlink_to(outside / "moved")
