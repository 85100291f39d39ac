"""Anything may lie in a dataset folder: never a traceback, never a hang, nothing written."""

import json
import shutil
from pathlib import Path

import pytest
import synthetic
from collected import FOLDER, collect, content
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from typer import Typer
from typer.testing import CliRunner

from rtphys.cli.datasets import verify as verify_command
from rtphys.core.errors import RtphysError
from rtphys.data.check_episode import check_hdf5
from rtphys.data.verify import verify
from rtphys.data.writer import DatasetWriter

FILES = (
    "manifest.json",
    f"{FOLDER}/ledger.jsonl",
    f"{FOLDER}/data/episode_0000000.hdf5",
    f"{FOLDER}/video/episode_0000000.mp4",
    f"{FOLDER}/phys_meta/episode_0000000.json",
    f"{FOLDER}/instruction/episode_0000000.json",
    f"{FOLDER}/scene_info.json",
)
JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=8), inner),
    max_leaves=8,
)


@pytest.fixture(scope="module")
def dataset(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("dataset")
    collect(out, 1)
    return out


def check(out: Path, name: str, data: bytes) -> None:
    """Replaces one file, verifies, and puts it back."""
    path = out / name
    before = path.read_bytes()
    path.write_bytes(data)
    try:
        held = content(out)
        report = verify(out)
        assert data == before or not report.sound or report.notes
        assert content(out) == held
    finally:
        path.write_bytes(before)


ANY = settings(max_examples=60, suppress_health_check=[HealthCheck.too_slow])


@ANY
@given(
    name=st.sampled_from(FILES),
    data=st.binary(max_size=300) | JSON.map(lambda value: json.dumps(value).encode()),
)
def test_any_bytes_in_any_file(dataset: Path, name: str, data: bytes) -> None:
    check(dataset, name, data)


@ANY
@given(name=st.sampled_from(FILES), data=st.data())
def test_cut_and_stirred_files(dataset: Path, name: str, data: st.DataObject) -> None:
    whole = (dataset / name).read_bytes()
    cut = data.draw(st.integers(0, len(whole)))
    place = data.draw(st.integers(0, len(whole)))
    check(dataset, name, whole[:place] + data.draw(st.binary(max_size=9)) + whole[place:cut])


@ANY
@given(place=st.integers(0, 10**6), data=st.binary(min_size=1, max_size=4))
def test_stirred_hdf5_either_opens_or_says_why(dataset: Path, place: int, data: bytes) -> None:
    """Beneath the checksum: HDF5's own reader must not bring the process down."""
    whole = (dataset / FILES[2]).read_bytes()
    place %= len(whole)
    path = dataset.parent / "stirred.hdf5"
    path.write_bytes(whole[:place] + data + whole[place + len(data) :])
    check_hdf5(path, "native", decode=True)


@ANY
@given(name=st.sampled_from(FILES[:2]), data=st.binary(max_size=100))
def test_the_writer_refuses_a_folder_it_cannot_read(
    dataset: Path, tmp_path_factory: pytest.TempPathFactory, name: str, data: bytes
) -> None:
    copy = tmp_path_factory.mktemp("copy") / "out"
    shutil.copytree(dataset, copy)
    (copy / name).write_bytes(data)
    before = content(copy)
    try:
        with DatasetWriter(copy) as writer:
            writer.task(synthetic.header())
    except RtphysError:
        assert content(copy) == before
    shutil.rmtree(copy)


@pytest.mark.parametrize("argument", ["", ".", "/dev/null", "/proc/self/mem", "no/such", "\udcff"])
def test_command_line(argument: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    app = Typer()
    app.command()(verify_command)
    result = CliRunner().invoke(app, [argument])
    assert result.exit_code == 1, result.output
    assert isinstance(result.exception, SystemExit)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
@pytest.mark.sim
def test_replay_notices_a_hash_that_no_simulation_gives(
    dataset: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The synthetic episode was never simulated."""
    monkeypatch.delenv("XDG_CACHE_HOME")  # else it builds an asset pack of its own
    app = Typer()
    app.command()(verify_command)
    result = CliRunner().invoke(app, [str(dataset), "--reproduce", "1", "--fresh"])
    assert result.exit_code == 1, result.output
    assert "state_hash is" in result.output
