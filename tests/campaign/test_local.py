"""Workers that crash, hang, leak and raise; and a supervisor that does not mind."""

import os
import resource
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from multiprocessing.connection import Connection, Pipe
from pathlib import Path

import pytest
from pool_jobs import (
    Outcome,
    Trouble,
    broken_setup,
    drain,
    dying_setup,
    hanging_setup,
    killed_setup,
    outcomes,
    setup,
)
from time_limit import at_most

from rtphys.campaign import local
from rtphys.campaign.local import LocalPool, OutsideTrouble, limits_for_user_code
from rtphys.campaign.machine import Usage
from rtphys.campaign.pool import CannotStart, Limits, WorkerError, WorkerFailure

QUICK = Limits(seconds=20)


def run(jobs: list[Trouble], size: int = 2, limits: Limits = QUICK) -> dict[int, Outcome]:
    with LocalPool[Trouble, int](setup, size, limits) as pool:
        return outcomes(pool, jobs)


def failure(job: Trouble) -> WorkerError:
    """What a job raises."""
    outcome = run([job, Trouble()])[0]
    assert isinstance(outcome, WorkerError)
    return outcome


def test_every_job_is_done_by_as_many_processes_as_asked_for() -> None:
    found = run([Trouble()] * 12, size=2)
    assert sorted(found) == list(range(12))
    pids = {outcome for outcome in found.values() if isinstance(outcome, int)}
    assert 1 <= len(pids) <= 2
    assert os.getpid() not in pids


def test_what_a_library_registered_for_the_end_is_run(tmp_path: Path) -> None:
    """At the end of the campaign, and when a worker has done its number of jobs."""
    run([Trouble(f"farewell:{tmp_path / 'end'}")])
    run([Trouble(f"farewell:{tmp_path / 'spent'}"), Trouble()], 1, Limits(seconds=20, jobs=1))
    assert {path.name for path in tmp_path.iterdir()} == {"end", "spent"}


def test_what_a_job_prints_is_heard_once() -> None:
    said, ends = list[str](), list[Outcome]()
    with LocalPool[Trouble, int](setup, 1, QUICK) as pool:
        pool.notice = said.append
        for what in ("print", "", "print"):
            pool.submit("0", Trouble(what), ends.append)
            drain(pool)
    assert said == ["hello", "world"] * 2 and len(ends) == 3


@pytest.mark.parametrize("death", ["abort", "exit"])
def test_a_job_that_always_kills_its_worker_is_given_up_and_the_others_are_done(death: str) -> None:
    found = run([Trouble(), Trouble(death), Trouble(), Trouble()])
    lost = found.pop(1)
    assert isinstance(lost, WorkerFailure)
    assert lost.reason == "worker_crash"
    assert all(isinstance(outcome, int) for outcome in found.values())


def test_a_death_is_heard_while_a_process_that_the_job_forked_lives_on(tmp_path: Path) -> None:
    """As the workers of a policy's data loader do."""
    try:
        with at_most(30):
            found = run([Trouble(f"fork:{tmp_path}"), Trouble()])
    finally:
        for path in tmp_path.iterdir():
            with suppress(ProcessLookupError):
                os.kill(int(path.name), signal.SIGKILL)
    assert found[0] == WorkerFailure("worker_crash", "was killed by SIGABRT")
    assert len(list(tmp_path.iterdir())) == 2


@pytest.mark.parametrize(("death", "times"), [("abort", 1), ("exit", 1), ("killed", 3)])
def test_a_worker_may_die(tmp_path: Path, death: str, times: int) -> None:
    """Once by the job's own doing; more often when somebody else kills it."""
    found = run([Trouble(death, str(tmp_path), times)], size=1)
    assert isinstance(found[0], int)
    assert len(list(tmp_path.iterdir())) == times + 1


def test_a_job_that_computes_for_ever_is_ended_twice_and_then_given_up(tmp_path: Path) -> None:
    found = run([Trouble("spin", str(tmp_path)), Trouble()], limits=Limits(seconds=1))
    assert found[0] == WorkerFailure("worker_hang", "ran longer than 1 s")
    assert isinstance(found[1], int)
    assert len(list(tmp_path.iterdir())) == 2


def test_a_job_that_needs_too_much_memory_is_ended_twice_and_then_given_up(tmp_path: Path) -> None:
    limits = Limits(seconds=20, max_memory=350e6)
    found = run([Trouble("hoard", str(tmp_path)), Trouble()], limits=limits)
    assert found[0] == WorkerFailure("worker_crash", "used more than 0.35 GB")
    assert isinstance(found[1], int)
    assert len(list(tmp_path.iterdir())) == 2


def test_what_scale_md_says_that_a_job_may_use() -> None:
    limits = Limits()
    assert (limits.seconds, limits.patience, limits.max_memory) == (600, 6000, 6e9)
    assert local.FOREIGN_RETRIES + 1 == 6, "losses, after which the command stops"


# ---- what comes from outside ---------------------------------------------------------------------


@pytest.mark.parametrize(
    ("what", "died"), [("killed", "was killed by SIGKILL"), ("sleep", "did not end within 1 s")]
)
def test_a_job_that_others_keep_from_its_end_is_no_result(
    what: str, died: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(local, "FOREIGN_RETRIES", 2)
    found = run([Trouble(what), Trouble(), Trouble()], limits=Limits(patience=1))
    trouble = found.pop(0)
    assert isinstance(trouble, OutsideTrouble) and trouble.exit_code == 4
    assert str(trouble).startswith(f"0: 3 workers were lost over it from outside, the last {died};")
    assert all(isinstance(outcome, int) for outcome in found.values())


def test_workers_that_others_kill_while_they_start_are_no_bug(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(local, "FOREIGN_RETRIES", 3)
    ends = list[Outcome]()
    with LocalPool[Trouble, int](killed_setup, 2, QUICK) as pool:
        pool.submit("0", Trouble(), ends.append)
        drain(pool)
    (trouble,) = ends
    assert isinstance(trouble, OutsideTrouble) and trouble.exit_code == 4


def test_code_of_a_user_that_waits_for_ever_has_itself_to_blame(tmp_path: Path) -> None:
    """As far as it has nothing beside it the second time."""
    limits = replace(limits_for_user_code(2, 1), memory=6e9)
    found = run([Trouble("sleep", str(tmp_path)), Trouble()], limits=limits)
    assert found[0] == WorkerFailure("worker_hang", "did not end within 1 s")
    assert isinstance(found[1], int)
    assert len(list(tmp_path.iterdir())) == 2


def test_code_of_a_user_may_compute_in_threads(monkeypatch: pytest.MonkeyPatch) -> None:
    """As in so many that they use a minute of CPU time a second."""
    monkeypatch.setattr(Usage, "of", staticmethod(lambda _: Usage(60 * time.monotonic())))
    monkeypatch.setattr(local, "CHECK_SECONDS", 0.1)
    ends = list[Outcome]()
    with LocalPool[Trouble, int](setup, 1, limits_for_user_code(1, 30)) as pool:
        pool.submit("0", Trouble("nap"), ends.append)
        while pool.busy:
            pool.wait(0.1)
    assert len(ends) == 1 and isinstance(ends[0], int)


def test_a_job_that_was_killed_from_outside_has_fewer_beside_it(tmp_path: Path) -> None:
    ends, room = list[object](), list[int]()
    with LocalPool[Trouble, int](setup, 4, QUICK) as pool:
        for job in [Trouble("killed", str(tmp_path), 2), *[Trouble("nap")] * 3]:
            pool.submit("0", job, ends.append)
        while pool.busy:
            pool.wait()
            room.append(pool.room + pool.busy)
        assert pool.room == 4
    assert room[0] == 4 and min(room) == 1
    assert all(isinstance(end, int) for end in ends)


def test_a_server_that_is_killed_takes_no_job_with_it(tmp_path: Path) -> None:
    ends = list[object]()
    with LocalPool[Trouble, int](setup, 2, QUICK) as pool:
        for _ in range(2):
            pool.submit("0", Trouble("parent", str(tmp_path), 1), ends.append)
        drain(pool)
    assert len(ends) == 2 and all(isinstance(end, int) for end in ends)


def test_only_as_many_workers_as_memory_allows(monkeypatch: pytest.MonkeyPatch) -> None:
    said = list[str]()
    monkeypatch.setattr(local, "free_memory", lambda: 2e9)
    with LocalPool[Trouble, int](setup, 16, QUICK) as pool:
        pool.notice = said.append
        pool.submit("0", Trouble(), print)
        drain(pool)
    assert pool.size == 3
    assert said == ["3 workers, not 16: 2.0 GB of memory is free, and a worker may take 0.6 GB"]


# ---- memory, errors ------------------------------------------------------------------------------


def test_a_worker_is_replaced_after_some_jobs_or_when_it_leaks() -> None:
    found = [*run([Trouble()] * 4, size=1, limits=Limits(seconds=20, jobs=2)).values()]
    assert found[0] == found[1] != found[2] == found[3]
    small = Limits(seconds=20, memory=150e6)
    found = run([Trouble("leak"), Trouble("leak"), Trouble()], size=1, limits=small)
    assert len({*found.values()}) == 3


RAISED = {  # what happens -> how its error begins, whether it has a traceback
    "bug": ("0: TypeError: a cat is no dog", True),
    "refusal": ("0: friction = -1 is not allowed", False),
    "broken pipe": ("0: BrokenPipeError: the policy's server", True),
}


@pytest.mark.parametrize("what", RAISED)
def test_an_exception_is_an_error_of_the_job(what: str) -> None:
    begins, traced = RAISED[what]
    raised = failure(Trouble(what))
    assert str(raised).startswith(begins)
    assert ("pool_jobs.py" in raised.trace) is traced
    assert raised.exit_code == (70 if traced else 2)


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("import json; json.loads('{')", "0: JSONDecodeError: "),
        ("raise UnknownName('prop', 'ring', ['bell'])", "0: unknown prop 'ring'"),
    ],
)
def test_an_exception_in_a_users_file_comes_out_with_its_line(
    line: str, said: str, tmp_path: Path
) -> None:
    task = tmp_path / "mine.py"
    task.write_text(f"from rtphys.core.errors import UnknownName\n\ndef play():\n    {line}\n")
    raised = str(failure(Trouble(f"task:{task}")))
    assert raised.startswith(said) and raised.endswith(f" ({task}, line 4)")


@pytest.mark.parametrize(
    ("broken", "said"),
    [(broken_setup, "pack = 'nowhere'"), (dying_setup, "while it started: no driver, no cry")],
)
def test_workers_that_cannot_start_end_the_run_with_their_last_words(
    broken: Callable[[], Callable[[Trouble], int]], said: str
) -> None:
    with (
        pytest.raises(CannotStart, match=said),
        LocalPool[Trouble, int](broken, 2, QUICK) as pool,
    ):
        pool.submit("0", Trouble(), print)
        drain(pool)


@pytest.mark.parametrize(
    ("broken", "said"),
    [(broken_setup, "pack = 'nowhere'"), (hanging_setup, "was not ready after 1 s")],
)
def test_a_large_first_job_hides_no_worker_that_cannot_start(
    broken: Callable[[], Callable[[bytes], int]], said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A job that fills the line would keep the pool from hearing anything else."""
    monkeypatch.setattr(local, "START_SECONDS", 1.0)
    with pytest.raises(CannotStart, match=said), LocalPool[bytes, int](broken, 1, QUICK) as pool:
        pool.submit("0", bytes(10**7), print)
        while pool.busy:
            pool.wait()


def test_what_lies_in_the_current_folder_is_not_imported(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "selectors.py").write_text("raise RuntimeError('a file of the user')")
    monkeypatch.chdir(tmp_path)
    assert isinstance(run([Trouble()])[0], int)


def test_more_workers_than_the_usual_limit_of_open_files_allows() -> None:
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    few = len(list(Path("/proc/self/fd").iterdir())) + 15
    resource.setrlimit(resource.RLIMIT_NOFILE, (few, hard))
    try:
        found = run([Trouble()] * 8, size=8)
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))
    assert all(isinstance(outcome, int) for outcome in found.values())


def test_any_number_of_workers_begin_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Neither side may wait for the other to read. A line holds 300 messages, here a few."""

    def short_pipe() -> tuple[Connection, Connection]:
        ends = Pipe()
        for end in ends:
            with socket.socket(fileno=os.dup(end.fileno())) as one:
                one.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 1)
        return ends

    monkeypatch.setattr(local, "Pipe", short_pipe)
    with at_most(60):
        found = run([Trouble()] * 24, size=24)
    assert len({*found.values()}) == 24


ORPHAN = """
import sys
sys.path.insert(0, sys.argv[1])
from pool_jobs import Trouble, setup
from rtphys.campaign.local import LocalPool
with LocalPool(setup, 1) as pool:
    pool.submit("0", Trouble("sleep"), print)
    while not pool._workers[0].ready:
        pool.wait()
    print(pool._workers[0].pid, flush=True)
    while pool.busy:
        pool.wait()
"""


@pytest.mark.skipif(sys.platform != "linux", reason="the kernel's promise is Linux's")
def test_workers_die_with_a_supervisor_that_is_killed() -> None:
    command = [sys.executable, "-c", ORPHAN, str(Path(__file__).parent)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as supervisor:
        assert supervisor.stdout is not None
        worker = Path(f"/proc/{int(supervisor.stdout.readline())}")
        time.sleep(0.5)
        assert worker.exists()
        supervisor.kill()
    deadline = time.monotonic() + 10
    while alive(worker) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not alive(worker)


def alive(process: Path) -> bool:
    try:
        return (process / "stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False
