"""A corpus of hostile datasets through the readers: an error of ours, soon, and nothing outside."""

import ast
import shutil
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest
import synthetic
from collected import collect
from evaluations import FINGERPRINT
from hostile import Hostile, corpus
from time_limit import Hang, at_most
from typer.testing import CliRunner

import rtphys
from rtphys.cli.main import app
from rtphys.core.errors import BadFile, RtphysError
from rtphys.data.dataset import Dataset
from rtphys.data.rewrite import convert, merge, subset
from rtphys.data.verify import verify
from rtphys.data.writer import DatasetWriter
from rtphys.export.card import CardText, croissant
from rtphys.policies.baselines import Replay
from rtphys.policies.policy import PolicyGone
from rtphys.report.page import gather
from rtphys.studies.evaluate import certified
from rtphys.studies.requests import EvaluationRun

SECONDS = 10
SECRET = "the secret of another folder"
CASES = tuple(corpus())


def _collect(dataset: Path, _: Path) -> None:
    with DatasetWriter(dataset) as writer:
        writer.task(synthetic.header())


def _read(dataset: Path, _: Path) -> None:
    for episode in Dataset(dataset):
        _ = (episode.frames, episode.physics, episode.instructions, len(episode))


def _show(dataset: Path, out: Path) -> None:
    result = CliRunner().invoke(app, ["show", str(dataset), "--out", str(out)])
    if result.exception is not None and not isinstance(result.exception, SystemExit):
        raise result.exception
    assert SECRET not in result.output and "\x1b" not in result.output


class _Anywhere:
    """An episode that takes every action."""

    task, seed, over = "click_bell", 0, False

    def act(self, action: np.ndarray) -> None:
        assert action.ndim == 1


def _replay(dataset: Path, _: Path) -> None:
    try:
        Replay(dataset, "click_bell", "phys_random").play(_Anywhere())  # type: ignore[arg-type]
    except PolicyGone as gone:
        raise BadFile(dataset, str(gone)) from gone


def _instances(dataset: Path, _: Path) -> None:
    cell = ("click_bell",), ("phys_random",)
    plan = EvaluationRun(*cell, 1, instances=dataset, accept_changes=True)
    certified(plan, "phys_random", "click_bell", FINGERPRINT)


READERS: dict[str, Callable[[Path, Path], object]] = {
    "verify-manifest": lambda dataset, _: verify(dataset),
    "Dataset": _read,
    "convert": lambda dataset, out: convert(dataset, out, "legacy"),
    "report": lambda dataset, _: gather(Dataset(dataset)),
    "export": lambda dataset, _: croissant(Dataset(dataset), CardText("name")),
    "collect": _collect,
    "show": _show,
    "replay": _replay,
    "instances": _instances,
    "merge": lambda dataset, out: merge([dataset], out),
    "subset": lambda dataset, out: subset(Dataset(dataset).where(seeds=range(9)), out),
}


@pytest.fixture(scope="module")
def sound(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("sound")
    collect(out, 1)
    return out


def state(folder: Path) -> dict[str, tuple[int, int]]:
    """Size and time of every file, of folders the time alone."""
    paths = [folder, *folder.rglob("*")]
    return {str(p): (p.lstat().st_size, p.lstat().st_mtime_ns) for p in paths}


def complaint(case: Hostile, reader: str, sound: Path, room: Path) -> str:
    """What is wrong with a reader's answer to a case; empty if nothing is."""
    dataset, outside = room / "dataset", room / "outside"
    shutil.copytree(sound, dataset)
    outside.mkdir()
    (outside / "secret.txt").write_text(SECRET)
    case.apply(dataset, outside)
    before = state(outside)
    try:
        with at_most(SECONDS):
            READERS[reader](dataset, room / "out")
    except RtphysError as error:
        if not str(error) or len(str(error)) > 5000 or SECRET in str(error):
            return f"{case.label}: {reader} says {str(error)[:100]!r}"
    except (Exception, Hang) as error:
        return f"{case.label}: {reader} raised {type(error).__name__}: {str(error)[:150]}"
    if state(outside) != before or {p.name for p in room.iterdir()} - {"dataset", "outside", "out"}:
        return f"{case.label}: {reader} wrote outside"
    return ""


def check(cases: Sequence[Hostile], reader: str, sound: Path, tmp_path: Path) -> None:
    wrong = []
    for number, case in enumerate(cases):
        room = tmp_path / str(number)
        room.mkdir()
        wrong += [text] if (text := complaint(case, reader, sound, room)) else []
        shutil.rmtree(room)
    assert not wrong, f"{len(wrong)} of {len(cases)}:\n" + "\n".join(wrong)


@pytest.mark.parametrize("reader", READERS)
def test_a_sound_dataset_is_read(reader: str, sound: Path, tmp_path: Path) -> None:
    dataset = Path(shutil.copytree(sound, tmp_path / "dataset"))
    READERS[reader](dataset, tmp_path / "out")


@pytest.mark.parametrize("reader", READERS)
def test_some_hostile_datasets(reader: str, sound: Path, tmp_path: Path) -> None:
    """A case in ten, each by one reader; few by `show`, which draws a plot."""
    step = (100 if reader == "show" else 10) * len(READERS)
    check(CASES[10 * list(READERS).index(reader) :: step], reader, sound, tmp_path)


@pytest.mark.parametrize("layer", ["data", "results", "policies"])
def test_nothing_that_reads_can_unpickle_or_run_what_it_reads(layer: str) -> None:
    able = {"pickle", "marshal", "shelve", "dill", "eval", "exec", "compile", "allow_pickle=True"}
    sources = [*(Path(rtphys.__file__).parent / layer).rglob("*.py")]
    assert sources
    for source in sources:
        for node in ast.walk(ast.parse(source.read_text())):
            match node:
                case ast.Import():
                    used = {name.name for name in node.names}
                case ast.ImportFrom():
                    used = {node.module}
                case ast.Call(func=ast.Name()):
                    used = {node.func.id}
                case ast.keyword():
                    used = {ast.unparse(node)}
                case _:
                    continue
            assert not used & able, f"{source}, line {node.lineno}"


@pytest.mark.slow
@pytest.mark.parametrize("reader", READERS)
def test_hostile_datasets(reader: str, sound: Path, tmp_path: Path) -> None:
    """Every case; one in ten by `show`, which draws a plot."""
    assert len(CASES) > 1500
    check(CASES[:: 10 if reader == "show" else 1], reader, sound, tmp_path)
