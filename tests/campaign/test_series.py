"""Results in any order, commits in the seeds' order; when it is enough; many series on one pool."""

from collections.abc import Callable, Sequence
from itertools import permutations
from pathlib import Path

import pytest
from counting import Ears, Numbers, Outcome, numbers, outcome
from quick_pool import QuickPool

from rtphys.campaign.pool import WorkerError, WorkerFailure
from rtphys.campaign.series import (
    ERROR_LOG,
    FRUITLESS,
    LOOKAHEAD,
    Batch,
    Bug,
    Listener,
    Progress,
    run_all,
)

LOSS = WorkerFailure("worker_crash", "was killed by SIGKILL")


def begun(series: Numbers, workers: int) -> list[int]:
    """What begins while nothing ends."""
    seeds = []
    while series.wants(workers) and len(series.running) < workers:
        seeds.append(series.begin())
    return seeds


def take_all(series: Numbers, seeds: Sequence[int]) -> None:
    for seed in seeds:
        series.take(seed, outcome(seed))


# ---- order ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("order", [*permutations(range(5))])
def test_commits_follow_seeds_not_completion(order: tuple[int, ...]) -> None:
    series = numbers(3)
    assert [series.begin() for _ in range(5)] == [0, 1, 2, 3, 4]
    take_all(series, order)
    # The third that counts is the last: what was begun to be on the safe side is dropped.
    assert series.committed == [0, 1, 2, 3]
    progress = series.progress
    assert (progress.accepted, progress.attempts, progress.rejections) == (3, 4, {"slipped": 1})
    assert series.over and progress.done and not series.halted


def test_results_are_seen_when_they_arrive() -> None:
    """Files of another machine must be put away before their turn."""
    series = numbers(3)
    begun(series, 3)
    take_all(series, (2, 1))
    assert (series.arrivals, series.committed) == ([2, 1], [])
    take_all(series, (0,))
    assert (series.arrivals, series.committed) == ([2, 1, 0], [0, 1, 2])


def test_what_comes_after_the_end_is_dropped_unseen() -> None:
    """When it has ended, and not before: until then somebody writes its files."""
    series = numbers(2)
    for _ in range(6):
        series.begin()
    series.take(4, outcome(4))
    for seed in (0, 1):
        series.close_if_over()
        assert series.closed == 0
        series.take(seed, outcome(seed))
    assert series.dropped_seeds == [4]
    series.close_if_over()
    series.take(2, outcome(2))
    series.take(3, LOSS)
    series.take(5, WorkerError("no such folder"))
    series.close_if_over()
    assert series.dropped_seeds == [4, 2, 3, 5] and not series.running
    assert (series.arrivals, series.committed, series.closed) == ([4, 0, 1], [0, 1], 1)
    assert series.over and not series.halted


# ---- when it is enough ---------------------------------------------------------------------------


def test_it_begins_as_many_as_the_missing_results_are_worth() -> None:
    series = numbers(3)
    assert begun(series, 9) == [0, 1, 2]
    take_all(series, (0, 1))
    assert begun(series, 9) == [], "a third one is running"
    series.take(2, Outcome(2, "slipped"))
    assert begun(series, 9) == [3, 4], "one is missing, and three of four count"


@pytest.mark.parametrize("owed", [0, 1000])
def test_it_does_not_run_far_ahead_of_the_slowest(owed: int) -> None:
    """What waits for an earlier seed may lie on the disk."""
    series = numbers(1000, owed=owed)
    slowest, *others = begun(series, 2)
    ahead = list(others)
    while others:
        take_all(series, others)
        others = begun(series, 2)
        ahead += others
    assert (slowest, ahead) == (0, [*range(1, LOOKAHEAD * 2)])
    assert series.running == {0}
    take_all(series, (slowest,))
    assert begun(series, 2) == [LOOKAHEAD * 2, LOOKAHEAD * 2 + 1]


def test_results_that_were_made_elsewhere_are_not_ahead() -> None:
    """They take no room: of ten seeds one is a job here."""
    series = numbers(1000, elsewhere=frozenset(seed for seed in range(1000) if seed % 10))
    while series.wants(2):
        seed = series.begin()
        if (result := series.known(seed)) is not None:
            series.take(seed, result)
    assert len(series.running) == LOOKAHEAD * 2 and series.committed == []


def test_a_goal_that_is_reached_wants_nothing() -> None:
    series = Numbers(Progress("numbers", 2, accepted=2, attempts=5), range(5, 9))
    assert series.over and not series.wants(4)
    assert (series.progress.new_accepted, series.progress.new_attempts) == (0, 0)


def test_no_seed_left_is_the_end() -> None:
    series = numbers(5, range(3))
    assert begun(series, 9) == [0, 1, 2]
    take_all(series, (0, 1, 2))
    assert series.over and not series.progress.done
    assert series.progress.stopped == "the most attempts that were allowed were made: 3"


@pytest.mark.parametrize("there", [0, 150, FRUITLESS])
def test_a_hopeless_series_is_given_up(there: int) -> None:
    """Wherever a kill has parted it."""
    progress = Progress("numbers", 1, attempts=there, fruitless=there)
    series = Numbers(progress, range(there, 10**6))
    while series.wants(1):
        seed = series.begin()
        series.take(seed, Outcome(seed, "slipped"))
    assert progress.attempts == FRUITLESS
    assert progress.stopped == f"none of the last {FRUITLESS} attempts was accepted"
    assert series.committed == [*range(there, FRUITLESS)]


def test_one_success_gives_new_hope() -> None:
    series = Numbers(Progress("numbers", 2, fruitless=FRUITLESS - 1), range(9))
    series.take(series.begin(), Outcome(0))
    series.take(series.begin(), Outcome(1, "slipped"))
    assert (series.progress.fruitless, series.progress.stopped) == (1, "")


# ---- owed seeds ----------------------------------------------------------------------------------


def test_owed_seeds_are_done_first_and_count_nothing() -> None:
    series = numbers(2, (30, 10, 50, 51, 52), owed=2)
    assert begun(series, 9)[:2] == [30, 10]
    take_all(series, sorted(series.running, reverse=True))
    assert series.committed[:2] == [30, 10]
    while series.wants(1):
        take_all(series, (series.begin(),))
    assert series.committed == [30, 10, 50, 51, 52][: len(series.committed)]
    assert series.progress.attempts == len(series.committed) - 2
    assert series.progress.accepted == 2


@pytest.mark.parametrize("end", [{"accepted": 2}, {"fruitless": FRUITLESS}])
def test_owed_seeds_are_done_even_where_nothing_else_is_wanted(end: dict) -> None:
    series = Numbers(Progress("numbers", 2, **end), (3, 4, 9), owed=2)
    assert not series.over
    assert begun(series, 9) == [3, 4]
    take_all(series, (4, 3))
    assert series.committed == [3, 4]
    assert series.over and not series.wants(9)


# ---- halts ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("rest", [*permutations((0, 1, 3))])
def test_a_lost_seed_halts_it_and_what_is_before_is_kept(rest: tuple[int, ...]) -> None:
    """In whatever order the seeds end that were running then."""
    series = numbers(9)
    assert begun(series, 4) == [0, 1, 2, 3]
    series.take(2, LOSS)
    assert not series.wants(4) and not series.over, "others are running"
    take_all(series, rest)
    assert series.committed == [0, 1]
    assert series.over and series.halted == "seed 2: worker_crash"
    series.close_if_over()
    assert series.closed == 1


@pytest.mark.parametrize("order", [*permutations((0, 1, 2))])
def test_a_lost_seed_past_the_last_one_needed_does_not_matter(order: tuple[int, ...]) -> None:
    series = numbers(2)
    assert [series.begin() for _ in range(4)] == [0, 1, 2, 3]
    series.take(3, LOSS)
    take_all(series, order)
    assert series.committed == [0, 1]
    assert series.over and not series.halted


def test_a_series_may_give_a_lost_seed_a_result() -> None:
    series = numbers(2, forgives=True)
    begun(series, 2)
    take_all(series, (1,))
    series.take(0, LOSS)
    assert series.commits == [Outcome(0, "worker_crash"), Outcome(1)]
    assert not series.halted and series.wants(2)


def test_a_refused_commit_halts_it_and_nothing_follows() -> None:
    series = numbers(9, refused={1: "seed 1 came out otherwise"})
    begun(series, 4)
    take_all(series, (3, 1, 0))
    assert series.halted == "seed 1 came out otherwise"
    assert not series.over, "one is running"
    take_all(series, (2,))
    assert series.over and series.committed == [0]
    assert series.progress.attempts == 1


# ---- errors --------------------------------------------------------------------------------------


@pytest.mark.parametrize("order", [*permutations((0, 1, 2))])
def test_an_error_is_raised_in_its_turn(order: tuple[int, ...]) -> None:
    """One worker alone would have met it there; and none begins what would come after it."""
    series = numbers(9)
    begun(series, 3)
    with pytest.raises(WorkerError, match="the disk is full"):
        for seed in order:
            series.take(seed, WorkerError("the disk is full") if seed == 1 else outcome(seed))
            assert seed != 1 or not series.wants(3)
    assert series.committed == [0]


# ---- a batch -------------------------------------------------------------------------------------


def test_a_batch_keeps_the_results_of_all_jobs_by_number() -> None:
    jobs = {7: "a", 5: "b", 6: "c"}
    batch = Batch("words", jobs, lambda job, loss: Outcome(0, f"{job}: {loss.reason}"))
    assert [batch.begin() for _ in jobs] == [7, 5, 6]
    assert [batch.job(number) for number in jobs] == ["a", "b", "c"]
    batch.take(6, Outcome(6))
    batch.take(5, LOSS)
    assert batch.results == {} and not batch.over
    batch.take(7, Outcome(7))
    assert batch.results == {7: Outcome(7), 5: Outcome(0, "b: worker_crash"), 6: Outcome(6)}
    assert batch.over and batch.progress.accepted == 3


# ---- all series on one pool ----------------------------------------------------------------------


def setup() -> Callable[[int], Outcome]:
    return outcome


class LosingPool(QuickPool[int, Outcome]):
    def loss(self, job: int) -> str:
        return "worker_hang" if job == 4 else ""


class NarrowPool(QuickPool[int, Outcome]):
    """Does what began first first; then it has room for one, as where a job must run alone."""

    @property
    def room(self) -> int:
        return super().room if len(self.names) < self.size else max(1 - self.busy, 0)

    def wait(self, timeout: float = 1.0) -> None:
        self._jobs.append(self._jobs.pop(0))
        super().wait(timeout)


class BrokenPool(QuickPool[int, Outcome]):
    def __init__(self, failure: WorkerError) -> None:
        super().__init__(setup, 1)
        self.failure = failure

    def wait(self, timeout: float = 1.0) -> None:
        raise self.failure


def made(workers: int, *wanted: int) -> list[Numbers]:
    series = [numbers(count) for count in wanted]
    run_all(series, QuickPool[int, Outcome](setup, workers), Listener())
    return series


@pytest.mark.parametrize("workers", [2, 3, 7])
def test_commits_do_not_depend_on_the_number_of_workers(workers: int) -> None:
    one, many = made(1, 5, 0, 9), made(workers, 5, 0, 9)
    assert [study.commits for study in many] == [study.commits for study in one]
    assert [len(study.commits) for study in one] == [7, 0, 13]
    assert [study.closed for study in many] == [1, 1, 1]


@pytest.mark.parametrize("step", [1, 2])
def test_known_results_spare_their_jobs(step: int) -> None:
    study = numbers(6, elsewhere=frozenset(range(0, 99, step)))
    run_all([study], QuickPool[int, Outcome](setup, 2), Listener())
    assert study.committed == [*range(8)] and study.closed == 1
    assert all(seed % 2 for seed in study.jobs) and (step == 2) == bool(study.jobs)


def test_a_halted_series_leaves_the_others_alone() -> None:
    halted, other = numbers(9), numbers(9, forgives=True)
    run_all([halted, other], LosingPool(setup, 3), Listener())
    assert halted.committed == [0, 1, 2, 3]
    assert halted.halted == "seed 4: worker_hang" and not halted.progress.done
    assert other.progress.done and other.commits[4] == Outcome(4, "worker_hang")
    assert (halted.closed, other.closed) == (1, 1)


def test_a_series_that_waits_for_the_surplus_of_another_is_done_as_well() -> None:
    first, second = numbers(2), numbers(3)
    first.progress.new_attempts = 3  # few count, so more begin than are needed
    run_all([first, second], NarrowPool(setup, 4), Listener())
    assert first.dropped_seeds == [2, 3], "the surplus"
    assert second.committed == [0, 1, 2, 3] and second.progress.done


def test_a_listener_hears_the_counts_every_result_and_what_a_pool_notices() -> None:
    ears, written = Ears(), []
    series = [numbers(4), numbers(2)]
    pool = QuickPool[int, Outcome](setup, 2)
    run_all(series, pool, ears, committed=lambda: written.append(ears.ticks))
    assert [progress.accepted for progress in ears.progresses] == [4, 2]
    assert len(written) == sum(len(one.jobs) for one in series) <= ears.ticks
    pool.notice("a worker died")
    assert ears.notices == ["a worker died"]


def test_a_bug_leaves_its_traceback_in_a_file(tmp_path: Path) -> None:
    failure = WorkerError("numbers, seed 0: KeyError: 'x'", 70, "Traceback: tief in \udcfc, größer")
    with pytest.raises(Bug, match=r"seed 0: KeyError: 'x'\. This is a bug .*error.log") as caught:
        run_all([numbers(1)], BrokenPool(failure), Listener(), tmp_path)
    assert caught.value.exit_code == 70
    said = (tmp_path / ERROR_LOG).read_text(encoding="utf-8")
    assert said == "Traceback: tief in \\udcfc, größer\n", "a path need not be text"
    assert failure.__notes__ == [failure.trace]  # what `--debug` shows


def test_what_a_user_can_cause_is_passed_on(tmp_path: Path) -> None:
    failure = WorkerError("friction = -1 is not allowed", 2, "")
    with pytest.raises(WorkerError) as caught:
        run_all([numbers(1)], BrokenPool(failure), Listener(), tmp_path)
    assert caught.value is failure
    assert not list(tmp_path.iterdir())


def test_a_job_is_called_by_its_series_and_seed() -> None:
    pool = QuickPool[int, Outcome](setup, 2)
    run_all([numbers(2)], pool, Listener())
    assert pool.names == ["numbers, seed 0", "numbers, seed 1"]
