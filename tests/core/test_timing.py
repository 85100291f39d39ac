"""The phase timer, on a clock that the test turns."""

from types import SimpleNamespace

import pytest

from rtphys.core import timing


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> SimpleNamespace:
    """`cpu` and `wall` seconds, as the timer reads them."""
    now = SimpleNamespace(cpu=100.0, wall=500.0)
    fake = SimpleNamespace(process_time=lambda: now.cpu, perf_counter=lambda: now.wall)
    monkeypatch.setattr(timing, "time", fake)
    return now


def spend(clock: SimpleNamespace, cpu: float, wall: float) -> None:
    clock.cpu += cpu
    clock.wall += wall


def test_an_inner_phase_interrupts_the_outer_one(clock: SimpleNamespace) -> None:
    timer = timing.Laps()
    spend(clock, 50, 50)  # outside every phase: counted nowhere
    with timer.phase("plan"):
        spend(clock, 1, 2)
        with timer.phase("step"):
            spend(clock, 4, 8)
        spend(clock, 16, 32)
    spend(clock, 50, 50)
    with timer.phase("step"):
        spend(clock, 64, 128)
    assert timer.cpu_s == {"plan": 17, "step": 68}
    assert timer.wall_s == {"plan": 34, "step": 136}


def test_a_phase_ends_with_an_error_too(clock: SimpleNamespace) -> None:
    timer = timing.Laps()

    def fail() -> None:
        spend(clock, 1, 1)
        raise OSError

    with pytest.raises(OSError), timer.phase("outer"):
        timer.timed("inner", fail)()
    spend(clock, 9, 9)
    with timer.phase("next"):
        pass
    assert timer.cpu_s == {"outer": 0, "inner": 1, "next": 0}


def test_shifted_cpu_time_keeps_the_sum(clock: SimpleNamespace) -> None:
    timer = timing.Laps()
    with timer.phase("step"):
        spend(clock, 5, 5)
    timer.shift(2, "step", "encode")
    assert timer.cpu_s == {"step": 3, "encode": 2} and timer.wall_s == {"step": 5}
