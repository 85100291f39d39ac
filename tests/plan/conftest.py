"""Fixtures of the planning tests; the robot itself is in `b1_arms.py`."""

from pathlib import Path

import numpy as np
import pytest
from b1_arms import LIMITS, aloha_urdf

from rtphys.core.poses import Pose, axis_angle
from rtphys.plan.kinematics import ArmKinematics


@pytest.fixture(scope="session")
def urdf(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("robot") / "dual.urdf"
    path.write_text(aloha_urdf(), encoding="utf-8")
    return path


@pytest.fixture(scope="session")
def X_WB() -> Pose:
    return Pose((0, -0.65, 0), axis_angle((0, 0, 1), np.pi / 2))


@pytest.fixture(scope="session")
def arms(urdf: Path, X_WB: Pose) -> dict[str, ArmKinematics]:
    return {
        side: ArmKinematics.from_urdf(
            urdf, [f"{arm}_joint{i}" for i in range(1, 7)], f"{arm}_link6", X_WB, LIMITS
        )
        for side, arm in (("left", "fl"), ("right", "fr"))
    }


@pytest.fixture
def right(arms: dict[str, ArmKinematics]) -> ArmKinematics:
    return arms["right"]


def top_down(p_tcp, yaw: float) -> Pose:
    """Wanted link6 pose with the tool pointing down and the TCP at p_tcp."""
    x, y = np.array([0, 0, -1.0]), np.array([np.cos(yaw), np.sin(yaw), 0])
    R = np.stack([x, y, np.cross(x, y)], axis=1)
    return Pose.from_matrix(np.block([[R, (p_tcp - 0.12 * x)[:, None]], [np.zeros(3), 1]]))


@pytest.fixture(scope="session")
def pose_above_table():
    return top_down
