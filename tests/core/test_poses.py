"""Rigid transforms against their matrices."""

from itertools import pairwise

import numpy as np
import pytest

from rtphys.core.poses import (
    Pose,
    axis_angle,
    matrix_to_quat,
    quat_multiply,
    quat_to_matrix,
    rotation_between,
)

RNG = np.random.default_rng(0)
QUATS = RNG.normal(size=(20, 4))
POSES = [Pose(RNG.normal(size=3), q) for q in QUATS]
HALF_TURNS = [Pose(q=axis).R for axis in np.eye(4)]  # identity and half turns about x, y, z


@pytest.mark.parametrize("R", [*(p.R for p in POSES), *HALF_TURNS])
def test_matrix_to_quat_inverts_quat_to_matrix(R: np.ndarray) -> None:
    np.testing.assert_allclose(R @ R.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(R) == pytest.approx(1)
    q = matrix_to_quat(R)
    assert q[0] >= 0 and np.linalg.norm(q) == pytest.approx(1)
    np.testing.assert_allclose(quat_to_matrix(q), R, atol=1e-12)


def test_products_of_quaternions_and_poses_are_products_of_matrices() -> None:
    for A, B in pairwise(POSES):
        np.testing.assert_allclose(quat_to_matrix(quat_multiply(A.q, B.q)), A.R @ B.R, atol=1e-12)
        np.testing.assert_allclose((A @ B).matrix, A.matrix @ B.matrix, atol=1e-12)
        np.testing.assert_allclose((A @ A.inverse()).matrix, np.eye(4), atol=1e-12)
        np.testing.assert_allclose(Pose.from_matrix(A.matrix).matrix, A.matrix, atol=1e-12)


def test_a_pose_maps_one_point_and_many() -> None:
    points = RNG.normal(size=(5, 3))
    X = POSES[0]
    moved = X @ points
    np.testing.assert_allclose(moved, points @ X.R.T + X.p)
    np.testing.assert_allclose(X @ points[2], moved[2])


def test_axis_angle_turns_by_the_right_hand_rule() -> None:
    quarter = quat_to_matrix(axis_angle((0, 0, 5), np.pi / 2))
    np.testing.assert_allclose(quarter @ [1, 0, 0], [0, 1, 0], atol=1e-12)
    assert Pose().angle_to(Pose(q=axis_angle((1, 2, 3), 0.7))) == pytest.approx(0.7)
    assert Pose(q=QUATS[0]).angle_to(Pose(q=-QUATS[0])) == pytest.approx(0, abs=1e-6)


@pytest.mark.parametrize("b", [(0, 3, 0), (1, 0, 0), (-2, 0, 0), (0.3, -0.5, 0.1)])
def test_rotation_between_is_the_smallest_one(b: tuple[float, float, float]) -> None:
    a, to = np.array([1.0, 0, 0]), np.array(b) / np.linalg.norm(b)
    q = rotation_between(a, b)
    np.testing.assert_allclose(quat_to_matrix(q) @ a, to, atol=1e-12)
    assert Pose().angle_to(Pose(q=q)) == pytest.approx(np.arccos(a @ to), abs=1e-7)


def test_a_pose_normalises_its_quaternion_and_cannot_be_written_to() -> None:
    pose = Pose((1, 2, 3), (2, 0, 0, 0))
    assert pose.q.tolist() == [1, 0, 0, 0]
    for array in (pose.p, pose.q, pose.R):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 9
    assert pose.moved((0, 0, 1)).p.tolist() == [1, 2, 4]
