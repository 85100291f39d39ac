"""Datasets that nobody should give: each a change to a sound one, with its checksums made anew.

A case is named by its label; it changes the folder `dataset`, and may point at `outside`, a folder
whose files may neither be read nor written.
"""

import json
import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from rtphys.data.episode import JSON
from rtphys.data.files import FileFacts
from rtphys.data.journal import START, link
from rtphys.data.json_text import compact

LEAF = "phys_random/click_bell/aloha_agilex"
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

    def __str__(self) -> str:
        return self.label


def corpus() -> Iterator[Hostile]:
    """Every case, in a stable order."""
    yield from _names()
    yield from _values("manifest.json", MANIFEST_PLACES)
    yield from _values(f"{LEAF}/phys_meta/episode_0000000.json", LABEL_PLACES)
    yield from _values(f"{LEAF}/instruction/episode_0000000.json", (("seen",), ("seen", 0)))
    yield from _journal()
    yield from _strange_files()


def hostile_shards(whole: JSON) -> Iterator[Hostile]:
    """A file `shard.json` with a value in each place that does not belong there."""
    units: tuple[tuple[str | int, ...], ...] = (("index",), ("of",), ("units",), ("units", 0))
    units += tuple(("units", 0, key) for key in ("leaf", "twin", "episodes", "plan"))
    units += tuple(("units", 0, "plan", key) for key in ("task", "protocol", "config", "layout"))
    units += tuple(("units", 0, "plan", key) for key in ("cameras", "overrides", "first_seed"))
    for place in units:
        for value in (*VALUES, *NAMES):
            label = f"shard {'.'.join(map(str, place))} = {str(value)[:20]!r}"
            yield Hostile(label, _shard(whole, place, value))
    for text in RAW:
        yield Hostile(f"shard {text[:20]}", lambda d, _, t=text: _write(d / "shard.json", t))


def _shard(whole: JSON, place: tuple[str | int, ...], value: object) -> Change:
    def change(dataset: Path, _: Path) -> None:
        _write(dataset / "shard.json", json.dumps(whole))
        _edit(dataset / "shard.json", place, value)

    return change


def _write(path: Path, text: str) -> None:
    path.write_text(text)


OF_LEAF: tuple[tuple[str | int, ...], ...] = (
    *(("episodes",), ("seeds",), ("seeds", 0), ("attempts",), ("attempts", 0, "seed")),
    *(("stride",), ("cameras",), ("domain", "digest"), ("overrides",), ("first_seed",)),
    *(("journal", "entries"), ("visual",), ("only",), ("acting",), ("twin",), ("versions",)),
)
MANIFEST_PLACES: tuple[tuple[str | int, ...], ...] = (
    *(("leaves", LEAF, *place) for place in OF_LEAF),
    *(("domains",), ("files",), ("dataset_version",), ("leaves",)),
)
LABEL_PLACES: tuple[tuple[str | int, ...], ...] = (
    *(("seed",), ("attributes",), ("attributes", "friction", "value"), ("draws",), ("recipe",)),
    *(("attributes", "center_of_mass", "value"), ("cameras",), ("verdict",), ("episode",)),
    *(("verdict", "first_success_time"), ("readback", "bodies"), ("state_hash",), ("task",)),
)


def _names() -> Iterator[Hostile]:
    for key in ("task", "config", "embodiment", "twin", "layout"):
        for name in NAMES:
            yield Hostile(f"manifest {key} = {name!r}", _in_manifest(("leaves", LEAF, key), name))
    for path in PATHS:
        yield Hostile(f"manifest lists {path!r}", _listing(path))


def _values(file: str, places: tuple[tuple[str | int, ...], ...]) -> Iterator[Hostile]:
    for place in places:
        where = ".".join(map(str, place)).replace(LEAF, "*")
        for value in VALUES:
            yield Hostile(f"{file} {where} = {str(value)[:20]!r}", _put(file, place, value))
        for text in RAW:
            yield Hostile(f"{file} {where} = {text[:20]}", _put_raw(file, place, text))


def _journal() -> Iterator[Hostile]:
    for key in ("task", "protocol", "config", "embodiment", "twin"):
        for name in NAMES[:6]:
            yield Hostile(f"journal {key} = {name!r}", _rewritten(0, (key,), name))
    for key in ("stride", "cameras", "overrides", "domain", "first_seed", "layout", "versions"):
        for value in VALUES:
            label = f"journal {key} = {str(value)[:20]!r}"
            yield Hostile(label, _rewritten(0, (key,), value))
    for key in ("seed", "episode", "frames", "files", "scene_info", "physics", "verdict"):
        for value in VALUES:
            label = f"attempt {key} = {str(value)[:20]!r}"
            yield Hostile(label, _rewritten(1, (key,), value))
    for path in PATHS:
        facts: JSON = {path: {"size": 1, "sha256": "0" * 64}}
        yield Hostile(f"attempt lists {path!r}", _rewritten(1, ("files",), facts))
    yield Hostile("a planted journal", _planted)


def _strange_files() -> Iterator[Hostile]:
    files = ("manifest.json", f"{LEAF}/journal.jsonl", f"{LEAF}/scene_info.json")
    files += tuple(f"{LEAF}/{kind}/episode_0000000.{end}" for kind, end in EPISODE)
    for name in files:
        yield Hostile(f"{name} is a FIFO", _replaced(name, os.mkfifo))
        yield Hostile(f"{name} is a folder", _replaced(name, os.mkdir))
        yield Hostile(f"{name} -> /dev/zero", _linked(name, "/dev/zero"))
        yield Hostile(f"{name} -> itself", _linked(name, Path(name).name))
        yield Hostile(f"{name} -> outside", _linked(name, None))
    for name in (LEAF, "phys_random", *(f"{LEAF}/{kind}" for kind, _ in EPISODE)):
        yield Hostile(f"{name}/ is a link", _linked_folder(name))
    for name in (f"{LEAF}/.staging", f"{LEAF}/seed.txt", ".rtphys.lock", ".manifest.json.part"):
        yield Hostile(f"{name} -> outside", _linked(name, None))


EPISODE = (("data", "hdf5"), ("video", "mp4"), ("phys_meta", "json"), ("instruction", "json"))


# ---- the changes ---------------------------------------------------------------------------------


def _set(node: JSON, place: tuple[str | int, ...], value: object) -> None:
    *way, last = place
    for step in way:
        node = node[step]  # type: ignore[index, call-overload]
    node[last] = value  # type: ignore[index]


def _edit(path: Path, place: tuple[str | int, ...], value: object) -> None:
    content = json.loads(path.read_text())
    _set(content, place, value)
    path.write_text(json.dumps(content))


def _relist(dataset: Path, file: str) -> None:
    """The manifest with the present checksum of a file."""
    facts = FileFacts.of((dataset / file).read_bytes()).model_dump()
    _edit(dataset / "manifest.json", ("files", file), facts)


def _in_manifest(place: tuple[str | int, ...], value: object) -> Change:
    return lambda dataset, _: _edit(dataset / "manifest.json", place, value)


def _listing(path: str) -> Change:
    facts = {"size": 1, "sha256": "0" * 64}
    return lambda dataset, _: _edit(dataset / "manifest.json", ("files", path), facts)


def _put(file: str, place: tuple[str | int, ...], value: object) -> Change:
    def change(dataset: Path, _: Path) -> None:
        _edit(dataset / file, place, value)
        if file != "manifest.json":
            _relist(dataset, file)

    return change


def _put_raw(file: str, place: tuple[str | int, ...], text: str) -> Change:
    def change(dataset: Path, outside: Path) -> None:
        _put(file, place, "@here@")(dataset, outside)
        path = dataset / file
        path.write_text(path.read_text().replace('"@here@"', text))
        if file != "manifest.json":
            _relist(dataset, file)

    return change


def _rewritten(line: int, place: tuple[str | int, ...], value: object) -> Change:
    """An entry changed, and the chain of checks made anew."""

    def change(dataset: Path, _: Path) -> None:
        path = dataset / LEAF / "journal.jsonl"
        entries = [json.loads(text)["entry"] for text in path.read_text().splitlines()]
        _set(entries[line], place, value)
        _write_journal(path, entries)

    return change


def _write_journal(path: Path, entries: list[JSON]) -> None:
    check, lines = START, []
    for entry in entries:
        try:
            check = link(check, entry)
            lines.append(compact({"check": check, "entry": entry}) + b"\n")
        except UnicodeEncodeError:
            lines.append(json.dumps({"check": check, "entry": entry}).encode() + b"\n")
    path.write_bytes(b"".join(lines))


def _planted(dataset: Path, _: Path) -> None:
    """A journal in a folder of its own that says it were that of a folder outside."""
    entries = [
        json.loads(text)["entry"]
        for text in (dataset / LEAF / "journal.jsonl").read_text().splitlines()
    ]
    _set(entries[0], ("config",), "../outside")
    folder = dataset / "a/b/c"
    folder.mkdir(parents=True)
    _write_journal(folder / "journal.jsonl", entries)


def _replaced(name: str, make: Callable[[Path], None]) -> Change:
    def change(dataset: Path, _: Path) -> None:
        (dataset / name).unlink()
        make(dataset / name)

    return change


def _linked(name: str, target: str | None) -> Change:
    def change(dataset: Path, outside: Path) -> None:
        (dataset / name).unlink(missing_ok=True)
        (dataset / name).symlink_to(target or outside / "secret.txt")

    return change


def _linked_folder(name: str) -> Change:
    def change(dataset: Path, outside: Path) -> None:
        (dataset / name).rename(outside / "moved")
        (dataset / name).symlink_to(outside / "moved")

    return change
