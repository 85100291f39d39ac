"""The phase timer: no second is counted twice."""

from types import SimpleNamespace

import pytest

from rtphys.core import timing
from rtphys.core.timing import PhaseTimer


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> SimpleNamespace:
    """A clock that stands still unless a test sets it forward; the wall goes twice as fast."""
    now = SimpleNamespace(s=0.0)
    fake = SimpleNamespace(process_time=lambda: now.s, perf_counter=lambda: 2 * now.s)
    monkeypatch.setattr(timing, "time", fake)
    return now


def test_a_phase_inside_another_interrupts_it(clock: SimpleNamespace) -> None:
    timer = PhaseTimer()
    clock.s = 5
    with timer.phase("outer"):
        clock.s += 1
        with timer.phase("inner"):
            clock.s += 10
        clock.s += 2
    clock.s += 100  # nobody's
    with timer.phase("inner"):
        clock.s += 20
    assert dict(timer.cpu_s) == {"outer": 3, "inner": 30}
    assert dict(timer.wall_s) == {"outer": 6, "inner": 60}


def test_a_phase_ends_with_an_exception(clock: SimpleNamespace) -> None:
    timer = PhaseTimer()
    with pytest.raises(ValueError), timer.phase("tried"):
        clock.s += 1
        raise ValueError
    clock.s += 7
    assert timer.cpu_s["tried"] == 1


def test_another_thread_s_time_moves_to_its_own_phase(clock: SimpleNamespace) -> None:
    timer = PhaseTimer()
    with timer.phase("render"):
        clock.s += 4
    timer.shift(1, "render", "encode")
    assert dict(timer.cpu_s) == {"render": 3, "encode": 1}
