"""Motions in time: straight, smooth, tracked; within their limits and from rest to rest."""

from math import ceil, inf, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rtphys.core.errors import Infeasible
from rtphys.core.poses import Array
from rtphys.plan.path import retime
from rtphys.plan.trajectory import (
    JERK,
    LONGER,
    JointLimits,
    Straight,
    Tracker,
    Trajectory,
    straight,
    stroke,
)

DT = 1 / 250
LIMITS = JointLimits(np.full(6, 2.5), np.full(6, 10.0))


def s_curve(way: float, v: float, a: float, jerk: float) -> float:
    """Least duration [s] of a way from rest to rest."""
    ramp = v / a + a / jerk if v * jerk >= a * a else 2 * sqrt(v / jerk)
    if way >= v * ramp:
        return way / v + ramp
    x = a / jerk
    if way >= 2 * a * x * x:
        return x + sqrt(x * x + 4 * way / a)
    return 4 * (way / (2 * jerk)) ** (1 / 3)


def allowed(unlimited: float) -> float:
    return ceil(LONGER * unlimited / DT - 1e-6) * DT


def jerk_of(commands: Array) -> float:
    """Largest third difference of commands, with the rest before and after."""
    whole = np.concatenate([*[commands[:1]] * 3, commands, *[commands[-1:]] * 3])
    return float(np.abs(np.diff(whole, 3, axis=0)).max()) / DT**3


def random_way(seed: int) -> tuple[Array, Array, JointLimits]:
    rng = np.random.default_rng(seed)
    pace = rng.uniform(0.05, 1)
    limits = JointLimits(rng.uniform(0.5, 3, 6), rng.uniform(2, 14, 6)).scaled(pace)
    q0, q1 = rng.uniform(-1.5, 1.5, (2, 6))
    return q0, q0 + 10 ** rng.uniform(-5, 0) * (q1 - q0), limits


def duration(motion: Trajectory) -> float:
    return (len(motion) - 1) * DT


@settings(max_examples=80)
@given(seed=st.integers(0, 100_000))
def test_motions_are_straight_legal_and_as_smooth_as_their_time_allows(seed: int) -> None:
    q0, q1, limits = random_way(seed)
    motion = straight(q0, q1, limits)
    change = q1 - q0
    done = (motion.q - q0) @ change / (change @ change)
    np.testing.assert_allclose(motion.q, q0 + done[:, None] * change, rtol=0, atol=1e-12)
    assert (np.diff(done) >= -1e-12).all()
    np.testing.assert_array_equal(motion.q[[0, -1]], [q0, q1])
    assert (motion.qd[[0, -1]] == 0).all()
    assert (np.abs(motion.qd) <= limits.velocity * (1 + 1e-6)).all()
    acceleration = np.abs(np.diff(motion.qd, axis=0)) / DT
    assert (acceleration <= limits.acceleration * (1 + 1e-6)).all()

    reach = np.abs(change)
    most = float(reach.max())
    v, a = (float((each * most / reach).min()) for each in (limits.velocity, limits.acceleration))
    within = allowed(s_curve(most, v, a, inf))
    if s_curve(most, v, a, JERK) <= within:
        least = JERK
        assert duration(motion) - DT < s_curve(most, v, a, JERK) <= duration(motion) + 1e-9
    else:
        assert duration(motion) == pytest.approx(within)
        least = max(JERK, _least_jerk(most, v, a, within))
    assert jerk_of(motion.q) <= 1.011 * least + 1e-9 / DT**3


def _least_jerk(way: float, v: float, a: float, seconds: float) -> float:
    low, high = 1.0, 1e12
    for _ in range(200):
        middle = sqrt(low * high)
        low, high = (low, middle) if s_curve(way, v, a, middle) <= seconds else (middle, high)
    return high


def test_a_long_motion_keeps_the_limit_and_a_short_one_its_time() -> None:
    far = straight(np.zeros(6), np.linspace(0, 2, 6), LIMITS)
    assert 0.97 * JERK < jerk_of(far.q) <= JERK * (1 + 1e-6)
    assert 0 <= duration(far) - (2 / 2.5 + 2.5 / 10 + 10 / JERK) < DT
    near = straight(np.zeros(6), np.full(6, 0.02), LIMITS)
    unlimited = 2 * sqrt(0.02 / 10)
    assert jerk_of(near.q) > JERK
    assert duration(near) == pytest.approx(allowed(unlimited))


def test_samples_lie_on_the_curve_at_every_step() -> None:
    motion = straight(np.zeros(6), np.full(6, 2.0), LIMITS)
    q, n = motion.q[:, 0], len(motion) - 1
    # Under 100 rad/s^3, 10 rad/s^2 are reached after 0.1 s; 1.15 s is no whole number of steps.
    slowed = 1.15 / (n * DT)
    t = np.arange(n + 1) * DT * slowed
    rise = t <= 0.1
    np.testing.assert_allclose(q[rise], JERK * t[rise] ** 3 / 6, atol=1e-12)
    even = (t > 0.1) & (t <= 0.25)
    since = t[even] - 0.1
    np.testing.assert_allclose(q[even], 1 / 60 + 0.5 * since + 5 * since**2, atol=1e-12)
    np.testing.assert_allclose(q + q[::-1], 2.0, atol=1e-12)
    np.testing.assert_allclose(motion.qd[rise, 0], slowed * JERK * t[rise] ** 2 / 2, atol=1e-12)


def test_same_input_same_bits() -> None:
    for seed in range(5):
        q0, q1, limits = random_way(seed)
        first, second = (straight(q0.copy(), q1.copy(), limits) for _ in range(2))
        assert first.q.tobytes() == second.q.tobytes()
        assert first.qd.tobytes() == second.qd.tobytes()


@settings(max_examples=60)
@given(begin=st.integers(0, 1000), end=st.integers(0, 1000), rate=st.floats(0.1, 0.6))
def test_strokes_are_smooth_and_never_too_fast(begin: int, end: int, rate: float) -> None:
    g0, g1 = begin / 1000, end / 1000
    seconds = max(rate * abs(g1 - g0), 0.02)
    commands = stroke(g0, g1, seconds)
    if g0 == g1:
        assert commands.tolist() == [g1]
        return
    assert commands[0] == g0
    assert commands[-1] == pytest.approx(g1, abs=1e-15)
    done = (commands - g0) / (g1 - g0)
    assert (np.diff(done) >= -1e-9).all()
    assert np.diff(done).max() <= DT / seconds * (1 + 1e-6)
    within = allowed(seconds)
    assert (len(commands) - 1) * DT <= within + 1e-9
    speed = abs(g1 - g0) / seconds
    least = max(JERK, _least_jerk(abs(g1 - g0), speed, 1e9, within))
    assert jerk_of(commands) <= 1.011 * least + 1e-12 / DT**3


def test_what_has_no_course_is_infeasible() -> None:
    with pytest.raises(Infeasible) as caught:
        straight(np.zeros(2), np.full(2, 1e300), JointLimits(np.ones(2), np.ones(2)))
    assert caught.value.reason == "retime_failed"


ACTION_LIMITS = JointLimits(np.full(6, 2.0), np.full(6, 6.0))


def fastest(q0: Array, q1: Array, limits: JointLimits) -> Trajectory:
    way = Straight(q0, q1, limits)
    return way.sampled(way.steps)


@settings(max_examples=40)
@given(seed=st.integers(0, 10_000))
def test_point_to_point_is_straight_and_legal(seed: int) -> None:
    rng = np.random.default_rng(seed)
    limits = JointLimits(rng.uniform(0.5, 3, 6), rng.uniform(2, 8, 6))
    q0, q1 = rng.uniform(-1.5, 1.5, (2, 6))
    motion = fastest(q0, q1, limits)
    along = (motion.q - q0) @ (q1 - q0) / ((q1 - q0) @ (q1 - q0))
    assert len(motion) <= len(retime(np.array([q0, q1]), limits))  # no slower than the planner's
    np.testing.assert_allclose(motion.q, q0 + along[:, None] * (q1 - q0), atol=1e-9)
    assert (np.diff(along) >= -1e-12).all()
    np.testing.assert_array_equal(motion.q[[0, -1]], [q0, q1])
    assert (motion.qd[[0, -1]] == 0).all()
    assert (np.abs(motion.qd) <= limits.velocity * (1 + 1e-6)).all()
    acceleration = np.abs(np.diff(motion.qd, axis=0)) / DT
    assert (acceleration <= limits.acceleration * (1 + 1e-6)).all()
    # Independent of any solver: the slowest joint's own trapezoid is a lower bound.
    v, a, d = limits.velocity, limits.acceleration, np.abs(q1 - q0)
    alone = np.where(d > v * v / a, d / v + v / a, 2 * np.sqrt(d / a))
    assert len(motion) - 1 >= np.floor(alone.max() / DT)


def test_nowhere_to_go_is_one_sample() -> None:
    motion = fastest(np.ones(6), np.ones(6), ACTION_LIMITS)
    assert len(motion) == 1
    assert (motion.qd == 0).all()


def test_a_small_motion_fills_the_time_it_has() -> None:
    way = Straight(np.zeros(6), np.full(6, 0.003), ACTION_LIMITS)
    fast, slow = way.sampled(way.steps), way.sampled(50)
    assert len(fast) - 1 < 50 == len(slow) - 1
    np.testing.assert_array_equal(slow.q[[0, -1]], fast.q[[0, -1]])
    share = (len(fast) - 1) / 50
    assert np.abs(slow.qd).max() <= 1.1 * share * np.abs(fast.qd).max()


def test_ruckig_agrees_where_limits_are_equal() -> None:
    goal = np.array([1.0, -0.5, 0.2, 0, 0.7, 0])
    motion = fastest(np.zeros(6), goal, ACTION_LIMITS)
    tracker = Tracker(np.zeros(6), ACTION_LIMITS)
    tracker.follow(goal)
    tracked = tracker.advance(len(motion) - 1)
    np.testing.assert_allclose(motion.q[:, 0], tracked.q[:, 0], atol=5e-3)  # the leading joint


def test_not_a_number_is_refused() -> None:
    with pytest.raises(ValueError, match="finite"):
        Straight(np.zeros(6), np.full(6, np.nan), ACTION_LIMITS)
    with pytest.raises(ValueError, match="finite"):
        Tracker(np.zeros(6), ACTION_LIMITS).follow(np.full(6, np.nan))


def test_tracker_reaches_its_target_and_stays() -> None:
    tracker = Tracker(np.zeros(6), ACTION_LIMITS)
    goal = np.array([0.5, -0.3, 0.1, 0, 0, 0.2])
    tracker.follow(goal)
    motion = tracker.advance(300)
    np.testing.assert_allclose(motion.q[-1], goal, atol=1e-9)
    np.testing.assert_allclose(motion.qd[-1], 0, atol=1e-9)


def test_tracker_bends_without_breaking_limits() -> None:
    rng = np.random.default_rng(0)
    tracker = Tracker(np.zeros(6), ACTION_LIMITS)
    q, qd = np.zeros((1, 6)), np.zeros((1, 6))
    for _ in range(40):
        tracker.follow(rng.uniform(-1, 1, 6))
        motion = tracker.advance(15)
        np.testing.assert_array_equal(motion.q[0], q[-1])  # it goes on where it was
        np.testing.assert_array_equal(motion.qd[0], qd[-1])
        q, qd = np.concatenate([q, motion.q[1:]]), np.concatenate([qd, motion.qd[1:]])
    assert np.abs(qd).max() <= 2 * (1 + 1e-6)
    assert np.abs(np.diff(qd, axis=0)).max() / DT <= 6 * (1 + 1e-6)
    np.testing.assert_allclose(np.diff(q, axis=0), (qd[1:] + qd[:-1]) * DT / 2, atol=6 * DT**2 / 4)
    assert np.abs(qd[15::15]).max() > 0.5  # it does not stop between targets


def test_still_tracker_stays() -> None:
    tracker = Tracker(np.full(6, 0.3), ACTION_LIMITS)
    motion = tracker.advance(1)
    np.testing.assert_allclose(motion.q, 0.3)
    np.testing.assert_allclose(motion.qd, 0)
