"""A policy that raises where it is opened or closed: its failure, in one line that names it."""

from collections.abc import Callable
from pathlib import Path

import pytest

from rtphys.core.errors import BadValue, Infeasible, RtphysError
from rtphys.policies import (
    PolicyBroken,
    PolicySession,
    PolicySetup,
    check_options,
    open_policy,
)
from rtphys.spec.episode import EpisodeSpec
from rtphys.spec.recording import RecordingSpec
from rtphys.studies import evaluate
from rtphys.studies.evaluate import EvaluateWorker, EvaluationTask

RAISED = (
    *("raise ValueError('two\\nlines')", "1 / 0", "raise SystemExit(3)", "raise GeneratorExit"),
    *("raise MemoryError", "raise BaseException", "raise StopIteration", "import no_such_module"),
    *("import asyncio; raise asyncio.CancelledError", "raise OSError(28, 'full', 'x')"),
    "def f(): f()\n    f()",
)
PLAYS = "class Mine:\n  needs_images = False\n  def play(self, episode): {play}\n"


def own(tmp_path: Path, text: str) -> str:
    (tmp_path / "mine.py").write_text(text)
    return f"python:{tmp_path / 'mine.py'}:make"


@pytest.mark.parametrize("raised", RAISED)
def test_a_constructor_that_raises(raised: str, tmp_path: Path) -> None:
    spec = own(tmp_path, f"def make(setup):\n    {raised}\n")
    with pytest.raises(PolicyBroken) as caught:
        open_policy(spec)
    text = str(caught.value)
    assert text.startswith(f"policy {spec} cannot be opened: ") and "\n" not in text
    assert "(mine.py, line " in text and caught.value.exit_code == 5


@pytest.mark.parametrize("raised", RAISED)
def test_a_module_that_raises(raised: str, tmp_path: Path) -> None:
    with pytest.raises(RtphysError) as caught:
        open_policy(own(tmp_path, f"if True:\n    {raised}\n"))
    text = str(caught.value)
    assert "mine.py" in text and "\n" not in text.replace("two\nlines", "")


def test_a_policy_that_does_not_say_whether_it_needs_pictures(tmp_path: Path) -> None:
    spec = own(tmp_path, "class make:\n  def __init__(self, setup): ...\n  def play(self, e): ...")
    with pytest.raises(PolicyBroken, match="no attribute 'needs_images'"):
        open_policy(spec)


@pytest.fixture
def job(monkeypatch: pytest.MonkeyPatch) -> Callable[[int], EvaluationTask]:
    """Jobs whose episode is made of nothing; its record is its trace."""
    monkeypatch.setattr(evaluate, "_judged", lambda episode, trace, sees: trace)
    monkeypatch.setattr(evaluate, "begin", lambda *_: None)
    spec = EpisodeSpec("click_bell", "clean")
    return lambda number: EvaluationTask(spec.at(0), PolicySetup("click_bell", seed=number))


def worker_of(spec: str) -> EvaluateWorker:
    worker = object.__new__(EvaluateWorker)  # without an asset pack, which these episodes lack too
    vars(worker).update(policy=spec, pack=None, recording=RecordingSpec())
    vars(worker).update(_session=PolicySession(spec), tasks={"click_bell": None})
    return worker


@pytest.mark.parametrize("raised", ["raise ValueError('x')", "raise SystemExit", "[][1]"])
def test_a_policy_that_cannot_be_closed(
    raised: str, tmp_path: Path, job: Callable[[int], EvaluationTask], monkeypatch
) -> None:
    text = PLAYS.format(play="pass") + f"  def close(self):\n    {raised}\n"
    spec = own(tmp_path, f"{text}def make(setup): return Mine()\n")
    worker = worker_of(spec)
    assert str(worker.do(job(0)).record) == ""
    with pytest.raises(PolicyBroken, match="cannot be closed"):
        worker.do(job(1))
    assert str(worker.do(job(1)).record) == "", "it goes on with a new one"
    monkeypatch.setattr(evaluate, "begin", _infeasible)
    assert worker.do(job(1)).record.reason == "infeasible"


def _infeasible(*_: object) -> None:
    raise Infeasible("unreachable")


@pytest.mark.parametrize("raised", ["raise ValueError('x')", "raise BaseException('x')"])
def test_a_crash_of_a_policy_that_cannot_be_closed_either(
    raised: str, tmp_path: Path, job: Callable[[int], EvaluationTask]
) -> None:
    text = PLAYS.format(play=f"\n    {raised}") + "  def close(self): 1 / 0\n"
    spec = own(tmp_path, f"{text}def make(setup): return Mine()\n")
    worker = worker_of(spec)
    for _ in range(2):
        trace = str(worker.do(job(0)).record)
        assert "mine.py" in trace and "x" in trace
        assert trace.endswith("closed: ZeroDivisionError: division by zero (mine.py, line 5)\n")


def test_what_a_crash_says_fits_a_record(
    tmp_path: Path, job: Callable[[int], EvaluationTask]
) -> None:
    """A message may quote a name that is not UTF-8, or megabytes of weights."""
    raised = "raise OSError('caf\\udce9.npz ' + 'x' * 10**7)"
    text = PLAYS.format(play=f"\n    {raised}") + "  def close(self): ...\n"
    worker = worker_of(own(tmp_path, f"{text}def make(setup): return Mine()\n"))
    trace = str(worker.do(job(0)).record)
    assert "mine.py" in trace and "OSError: caf\\udce9.npz xxx" in trace
    assert len(trace.encode()) < 200_000


def test_a_name_that_is_not_utf8_is_refused_before_any_episode() -> None:
    for spec, given in (("python:caf\udce9.py:make", {}), ("python:a:make", {"at": "\udce9"})):
        with pytest.raises(BadValue, match="results hold UTF-8 text"):
            check_options(spec, given)
