"""Three hundred and more malformed inputs through the real program: one sentence each, no file."""

import json
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path

import numpy as np
import pytest
from collected import FOLDER, collect, content
from time_limit import at_most
from typer.testing import CliRunner, Result

from rtphys.assets.pack import default_pack
from rtphys.cli.main import app
from rtphys.core.seeds import stream

SECONDS = 20  # a hang; the slowest answer takes a tenth of it
GENERATED = 120
HDF5 = f"dataset/{FOLDER}/data/episode_0000000.hdf5"


@dataclass(frozen=True)
class Case:
    """A command line, and files of the sandbox that are replaced before it."""

    arguments: tuple[str, ...]
    files: Mapping[str, bytes] = field(default_factory=dict)
    surely: bool = True  # False: what a generator made may happen to be in order

    def __str__(self) -> str:
        kept = {name: data[:200] for name, data in self.files.items()}
        return f"rtphys {' '.join(self.arguments)!r} {kept or ''}"


NUMBERS = ("0", "-1", "x", "", "1.5", "1e3", "nan", "99999999999999999999999")
NAMES = ("", " ", "no_such", "../x", "a/b", "Ünïcode", "x" * 300, "-", "{}", "%s", "\udcff")
HELD = (
    *("friction", "=1", "friction=", "friction=nan", "friction=inf", "friction=-1", "friction=x"),
    *("friction=1,2", "friction=1=2", "frction=1", "center_of_mass=1", "center_of_mass=a,b,c"),
    *("center_of_mass=0,0", "table_tilt=900", "object_scale=0", "object_scale=1e9", "=", "==", ""),
)
SWEEPS = (
    *("friction", "friction=", "friction=0.1,0.1", "friction=0.1,-3", "frction=0.1", "=,", "=0.1"),
    *("friction=0.1,,0.2", "friction=;", "center_of_mass=1,2,3,4", "friction=0.1;x"),
)


def command_lines() -> Iterator[Case]:
    """By hand: each option of each command that has values, with values it cannot have."""
    collect = ("collect", "--task", "click_bell")
    for name in NAMES:
        yield Case(("collect", "--task", name))
        for option in ("--protocol", "--layout", "--shader", "--split", "--twin", "--fallback"):
            if name:
                yield Case((*collect, option, name))
        for command in (("check",), ("domains", "show"), ("domains", "check")):
            yield Case((*command, name))
        yield Case(("verify", name or "no"))
        if name:
            yield Case(("verify", "dataset", "--expect", name))
        if name != "no_such":  # which would be a fine name
            yield Case(("new-task", name))
        yield Case(("export", "lerobot", "dataset", "--out", "out", "--version", name))
        yield Case(("export", "lerobot", "dataset", "--out", "out", "--camera-names", name))
        yield Case(("convert", "dataset", "--out", "out", "--to", name))
    for number in NUMBERS:
        for option in ("--episodes", "--workers"):
            yield Case((*collect, option, number))
        yield Case(("show", "dataset", "--number", number if number != "0" else "1"))
    for number in ("-1", "x", "", "1.5", "nan"):
        yield Case((*collect, "--max-attempts", number))
        yield Case((*collect, "--seed", number))
        yield Case(("verify", "dataset", "--reproduce", number))
    for cameras in ("left", "lft", "head,head", ",", "head;left", "head_camera,head"):
        yield Case((*collect, "--cameras", cameras))
    for held in HELD:
        yield Case((*collect, "--set", held))
    for sweep in SWEEPS:
        yield Case((*collect, "--sweep", sweep))
    for only in ("frction", "friction,frction", "friction;mass"):
        yield Case((*collect, "--protocol", "phys_random", "--only", only))
    for line in ("--nonsense", "--episodes", "collect --task", "nonsense", "export nonsense x"):
        yield Case(tuple(line.split()))


YAML = (
    *(b"[", b"- 1", b"3", b"text", b"a: b: c", b"\ta: 1", b"a: 1\na", b"{", b"\xff\xfe", b"\x00"),
    *(b"!!python/object/apply:os.system [x]", b"&a [*a]", b"1: 2", b"? [a]\n: b", b"%YAML 9.9"),
    *(b"physics: 3", b"physics: []", b"physics: {friction: {}}", b"extends: nobody", b"extends: 3"),
    *(b"physics: {frction: 1}", b"physics: {friction: {uniform: [2, 1]}}", b"nonsense: 1"),
    *(b"physics: {friction: {uniform: [1]}}", b"physics: {friction: {uniform: [a, b]}}"),
    *(b"physics: {friction: {uniform: [.nan, 1]}}", b"physics: {friction: {unifrm: [0, 1]}}"),
    *(b"physics: {friction: {choice: []}}", b"physics: {friction: {same_as: friction}}"),
    *(b"physics: {friction: -1}", b"physics: {friction: 1e999}", b"physics: {friction: [1, 2, 3]}"),
    *(b"physics: {friction: {by: {camera_mode: {}}}}", b"visual: {clutter: -1}", b"visual: 3"),
    *(b"visual: {clutter: 1.5}", b"visual: {clutter: 999}", b"visual: {textures: 1}"),
    *(b"physics: maybe", b"visual: {nonsense: true}", b"visual: {flicker_rate: 2}"),
    b"[" * 5000,
    b"a: &a [x,x]\n"
    + b"".join(b"%c: &%c [*%c,*%c]\n" % (n + 1, n + 1, n, n) for n in range(97, 121)),
)


def yaml_files() -> Iterator[Case]:
    """The same texts as a domain, a protocol and the sentences of a task."""
    collect = ("collect", "--task", "own", "--protocol", "odd")
    for text in YAML:
        if not text.startswith((b"visual", b"physics: maybe")):
            yield Case(("domains", "check", "odd.yaml"), {"odd.yaml": text})
        if not text.startswith(b"extends"):
            yield Case(collect, {"library/protocols/odd.yaml": text})
        yield Case(("collect", "--task", "own"), {"library/tasks/own.yaml": text})


def json_and_hdf5() -> Iterator[Case]:
    """Damage to the files of a dataset that no reader of them survives."""
    whole = (b"", b"{", b"[]", b"3", b"null", b"\xff", b'{"schema_version": "9"}', b"[" * 5000)
    readers = (("show",), ("report",), ("verify",), ("export", "card"))
    for text in whole:
        for reader in readers:
            yield Case((*reader, "dataset"), {"dataset/manifest.json": text})
        yield Case(("convert", "dataset", "--out", "out"), {"dataset/manifest.json": text})
        meta = f"dataset/{FOLDER}/phys_meta/episode_0000000.json"
        for reader in (("show",), ("report",), ("verify",)):
            yield Case((*reader, "dataset"), {meta: text})
    signature = b"\x89HDF\r\n\x1a\n"
    for data in (b"", b"x" * 4000, signature, signature + bytes(4000), b"\x00" * 100):
        for reader in (("show",), ("report",), ("verify",)):
            yield Case((*reader, "dataset"), {HDF5: data})
        yield Case(("export", "lerobot", "dataset", "--out", "out"), {HDF5: data})


def generated(dataset: Mapping[str, bytes], count: int) -> Iterator[Case]:
    """Sound files with a few bytes changed, left out or put in, from keyed streams."""
    readers = (("show",), ("report",), ("verify",), ("export", "card"))
    names = sorted(name for name in dataset if name.endswith(("json", "jsonl", "hdf5", "mp4")))
    for number in range(count):
        rng = stream(number, "malformed")
        name = names[number % len(names)]
        reader = readers[int(rng.integers(len(readers)))]
        yield Case((*reader, "dataset"), {name: stirred(dataset[name], rng)}, surely=False)


def stirred(data: bytes, rng: np.random.Generator) -> bytes:
    """Up to three small changes."""
    for _ in range(int(rng.integers(1, 4))):
        at, way = int(rng.integers(len(data) + 1)), int(rng.integers(4))
        some = rng.bytes(int(rng.integers(1, 9)))
        if way == 0:
            data = data[:at]
        elif way == 1:
            data = data[:at] + some + data[at + len(some) :]
        elif way == 2:
            data = data[:at] + json.dumps(float(rng.normal())).encode() + data[at:]
        else:
            data = data[:at] + data[at + len(some) :]
    return data


TASK = """
from dataclasses import replace
from rtphys.task import load_task
task = replace(load_task("click_bell"), phrases=load_task("click_bell").phrases)
"""


@pytest.fixture
def sandbox(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A dataset and a user's library, in the working folder."""
    collect(tmp_path / "dataset", 1)
    (tmp_path / "library/tasks").mkdir(parents=True)
    (tmp_path / "library/protocols").mkdir()
    (tmp_path / "library/tasks/own.py").write_text(TASK)
    monkeypatch.setenv("RTPHYS_LIBRARY", str(tmp_path / "library"))
    monkeypatch.setenv("RTPHYS_ASSETS", str(default_pack().root))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path.parent / f"{tmp_path.name}-cache"))
    # Python's own cache of the library's task, which no command asks for.
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@contextmanager
def replaced(sandbox: Path, case: Case) -> Iterator[None]:
    """The case's files in place, afterwards what was there."""
    before = {n: (sandbox / n).read_bytes() for n in case.files if (sandbox / n).exists()}
    for name, data in case.files.items():
        (sandbox / name).write_bytes(data)
    try:
        yield
    finally:
        for name in case.files:
            (sandbox / name).unlink()
        for name, data in before.items():
            (sandbox / name).write_bytes(data)


def complaints(case: Case, result: Result, written: set[str]) -> list[str]:
    """What is wrong with an answer."""
    found = []
    if result.exception is not None and not isinstance(result.exception, SystemExit):
        found.append(f"raised {result.exception!r}")
    if "Traceback" in result.output:
        found.append("shows a traceback")
    if case.surely and result.exit_code == 0:
        found.append("was accepted")
    if result.exit_code != 0 and written:
        found.append(f"wrote {sorted(written)}")
    if result.exit_code != 0 and not result.output.strip():
        found.append("said nothing")
    return found


def test_every_malformed_input_is_a_sentence(sandbox: Path) -> None:
    sound = content(sandbox)
    cases = [*chain(command_lines(), yaml_files(), json_and_hdf5()), *generated(sound, GENERATED)]
    assert len(cases) >= 300
    wrong = []
    for case in cases:
        with replaced(sandbox, case):
            before = content(sandbox)
            with at_most(SECONDS):
                result = CliRunner().invoke(app, list(case.arguments))
            after = content(sandbox)
        written = {name for name in after if after[name] != before.get(name)}
        wrong += [f"{case}: {text}" for text in complaints(case, result, written)]
        for name in after.keys() - before.keys():
            (sandbox / name).unlink()
        assert before.keys() <= after.keys(), f"{case} removed files"
        if result.exit_code == 0:  # a report or a card of a dataset that happens to be sound
            assert content(sandbox) == sound, str(case)
    assert not wrong, f"{len(wrong)} of {len(cases)}:\n" + "\n".join(wrong)
