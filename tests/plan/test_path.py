"""Time along a path: within limits, near the polyline, with toppra's own speeds bit for bit."""

from itertools import pairwise

import numpy as np
import pytest
from b1_arms import BENT
from hypothesis import given, settings
from hypothesis import strategies as st
from toppra.algorithm import TOPPRA
from toppra.constraint import JointAccelerationConstraint, JointVelocityConstraint
from toppra.interpolator import SplineInterpolator

from rtphys.core.errors import BadValue, Infeasible
from rtphys.core.seeds import stream
from rtphys.plan import path as timing
from rtphys.plan.path import CORNER, BlendedPath, fastest, retime
from rtphys.plan.trajectory import JointLimits, Straight

DT = 1 / 250
LIMITS = JointLimits(np.full(6, 2.0), np.full(6, 6.0))


def distance_to_polyline(points: np.ndarray, corners: np.ndarray) -> np.ndarray:
    a, b = corners[:-1], corners[1:]
    edge = b - a
    t = np.einsum("pkd,kd->pk", points[:, None] - a, edge) / np.einsum("kd,kd->k", edge, edge)
    near = a + np.clip(t, 0, 1)[..., None] * edge
    return np.linalg.norm(points[:, None] - near, axis=2).min(axis=1)


def assert_legal(motion, limits=LIMITS) -> None:
    assert (np.abs(motion.qd) <= limits.velocity * (1 + 1e-6)).all()
    acceleration = np.diff(motion.qd, axis=0) / DT
    assert (np.abs(acceleration) <= limits.acceleration * (1 + 1e-6)).all()
    assert (motion.qd[[0, -1]] == 0).all()
    # Velocity is the derivative of position: the trapezoid rule is off by a dt^2 / 4 at most.
    moved = np.diff(motion.q, axis=0) - (motion.qd[1:] + motion.qd[:-1]) * DT / 2
    assert np.abs(moved).max() <= limits.acceleration.max() * DT**2 / 4 + 1e-9


@settings(max_examples=40)
@given(seed=st.integers(0, 10_000), n=st.integers(2, 7), d=st.sampled_from([6, 12]))
def test_limits_and_corridor_hold_on_any_polyline(seed: int, n: int, d: int) -> None:
    rng = np.random.default_rng(seed)
    limits = JointLimits(rng.uniform(0.5, 3, d), rng.uniform(2, 8, d))
    corners = rng.uniform(-1.5, 1.5, (n, d))
    motion = retime(corners, limits)
    assert_legal(motion, limits)
    np.testing.assert_array_equal(motion.q[0], corners[0])
    np.testing.assert_array_equal(motion.q[-1], corners[-1])
    assert distance_to_polyline(motion.q, corners).max() <= CORNER / 2 + 1e-9


def test_straight_line_is_straight_and_as_fast_as_its_jerk_allows() -> None:
    goal = np.array([1.5, -0.75, 0.3, 0, 0, 0])
    motion = retime(np.array([np.zeros(6), goal]), LIMITS)
    assert_legal(motion)
    assert distance_to_polyline(motion.q, np.array([np.zeros(6), goal])).max() < 1e-12
    optimum = 1.5 / 2 + 2 / 6 + 6 / 100  # s/v + v/a + a/jerk for the joint that moves most
    assert optimum <= (len(motion) - 1) * DT < optimum + DT


def test_collinear_points_cost_no_time() -> None:
    ends = np.array([np.zeros(6), np.full(6, 1.0)])
    direct = Straight(*ends, LIMITS).steps  # neither has a limit of jerk
    assert len(retime(np.linspace(*ends, 9), LIMITS)) <= direct + 4


def test_corner_is_passed_without_stopping() -> None:
    corners = np.zeros((3, 6))
    corners[1:, 0], corners[2, 1] = 1.0, 1.0
    motion = retime(corners, LIMITS)
    assert_legal(motion)
    at_corner = np.argmin(np.linalg.norm(motion.q - corners[1], axis=1))
    assert np.linalg.norm(motion.qd[at_corner]) > 0.3
    stopping = sum(len(retime(corners[i : i + 2], LIMITS)) for i in (0, 1))
    assert len(motion) < stopping


def test_reversal_turns_round_inside_the_corridor() -> None:
    corners = np.zeros((3, 6))
    corners[1, 0] = 1.0
    motion = retime(corners, LIMITS)
    assert_legal(motion)
    assert 0.94 < motion.q[:, 0].max() <= 1.0


def test_repeated_points_are_no_obstacle() -> None:
    points = np.repeat(np.array([np.zeros(6), np.full(6, 0.5), np.eye(6)[0]]), 3, axis=0)
    motion = retime(points, LIMITS)
    assert_legal(motion)
    np.testing.assert_array_equal(motion.q[-1], points[-1])
    for still in (points[:1], points[:3]):
        motion = retime(still, LIMITS)
        assert len(motion) == 1
        np.testing.assert_array_equal(motion.q, still[-1:])
        assert (motion.qd == 0).all()


def test_tool_line_stays_straight_when_timed(right, pose_above_table) -> None:
    goal = pose_above_table(np.array([0.2, -0.1, 0.78]), 1.9)
    q = right.solve_near(goal.moved((0, 0, 0.1)), BENT, stream(2, "test"))
    motion = retime(right.line(q, goal), LIMITS)
    assert_legal(motion)
    tools = np.array([right.ee_matrix(q)[:3, 3] for q in motion.q])
    assert np.abs(tools[:, :2] - goal.p[:2]).max() < 5e-4
    assert (np.diff(tools[:, 2]) < 1e-6).all()
    np.testing.assert_allclose(tools[-1], goal.p, atol=1e-4)


def test_slower_limits_take_proportionally_longer() -> None:
    points = np.array([np.zeros(6), np.ones(6), np.eye(6)[1]])
    fast, slow = retime(points, LIMITS), retime(points, LIMITS.scaled(0.25))
    assert len(slow) / len(fast) == pytest.approx(4, rel=0.02)


def test_same_input_same_bits() -> None:
    points = np.random.default_rng(1).uniform(-1, 1, (5, 12))
    limits = JointLimits(np.full(12, 2.0), np.full(12, 6.0))
    first, second = retime(points, limits), retime(points.copy(), limits)
    assert first.q.tobytes() == second.q.tobytes()


def test_impossible_limits_and_points_are_refused(monkeypatch) -> None:
    with pytest.raises(BadValue, match="velocity"):
        JointLimits(np.array([1.0, 0.0]), np.ones(2))
    with pytest.raises(ValueError, match="finite"):
        retime(np.array([[0.0], [np.nan]]), JointLimits(np.ones(1), np.ones(1)))
    monkeypatch.setattr("rtphys.plan.path.fastest", lambda path, grid, limits: None)
    with pytest.raises(Infeasible) as caught:
        retime(np.eye(6)[:3], LIMITS)
    assert caught.value.reason == "retime_failed"


def test_blended_path_is_smooth() -> None:
    path = BlendedPath.through(np.random.default_rng(0).uniform(-1, 1, (6, 6)))
    before, after = path.breaks[1:-1] - 1e-9, path.breaks[1:-1] + 1e-9
    np.testing.assert_allclose(path(before), path(after), atol=1e-8)
    np.testing.assert_allclose(path(before, 1), path(after, 1), atol=1e-6)
    assert BlendedPath.through(np.zeros((3, 6))) is None


def crooked(seed: int, joints: int) -> tuple[SplineInterpolator, np.ndarray]:
    """A path of some joints through random postures, and a grid on it."""
    points = np.random.default_rng(seed).uniform(-1, 1, (6, joints))
    grid = np.sort(np.unique(np.r_[np.linspace(0, 1, 40), np.linspace(0.3, 0.4, 25)]))
    return SplineInterpolator(np.linspace(0, 1, 6), points), grid


@pytest.mark.parametrize("joints", [1, 6, 12])
def test_speeds_are_those_of_toppra_bit_for_bit(joints) -> None:
    for seed in range(5):
        path, grid = crooked(seed, joints)
        v, a = np.linspace(1, 2, joints), np.linspace(8, 12, joints)
        limits = [
            JointVelocityConstraint(np.stack([-v, v], 1)),
            JointAccelerationConstraint(np.stack([-a, a], 1)),
        ]
        whole = TOPPRA(limits, path, gridpoints=grid, solver_wrapper="seidel")
        wanted = whole.compute_parameterization(0.0, 0.0)[1]
        found = fastest(path, grid, JointLimits(v, a))
        assert wanted is not None and found is not None
        assert wanted.tobytes() == found.tobytes()
        assert found[0] == found[-1] == 0 < found[1:-1].min()


class Stuck:
    """A solver that finds no way on after some answers."""

    def __init__(self, answers: int) -> None:
        self.left, self.asked = answers, []

    def solve_stagewise_optim(self, i, H, g, x_low, x_high, low, high) -> np.ndarray:
        self.left -= 1
        self.asked.append(x_low)
        answer = [0.1, 1.0 if g[1] < 0 else 0.0]  # acceleration, the largest or least square
        return np.array(answer if self.left >= 0 else [np.nan, np.nan])


@pytest.mark.parametrize("answers", [0, 4, 39, 41])
def test_a_path_without_a_way_on_has_no_speeds(answers, monkeypatch) -> None:
    stuck = Stuck(answers)
    monkeypatch.setattr(timing, "seidelWrapper", lambda *args, **named: stuck)
    path, grid = crooked(0, 3)
    assert fastest(path, grid[:21], JointLimits(np.ones(3), np.ones(3))) is None
    if answers > 40:  # the way back took 40; rounding on the way on is met by slowing down a bit
        tries = stuck.asked[answers:]
        assert len(tries) == 11 and all(b < a for a, b in pairwise(tries))
