"""What presses on a robot's links and how hard its motors work, and when that ends an attempt."""

import numpy as np
import pytest

from rtphys.assets.pack import default_pack
from rtphys.core.errors import Infeasible
from rtphys.core.poses import Array, Pose
from rtphys.core.seeds import stream
from rtphys.episode.generate import prepare, settle, start
from rtphys.expert.grasp import STRAIGHT_DOWN
from rtphys.plan.kinematics import arm_kinematics
from rtphys.sim.rollout import Rollout, RolloutOptions
from rtphys.sim.strain import MAX_FORCE, MAX_SECONDS, Strain
from rtphys.spec.episode import EpisodeSpec
from rtphys.task.spec import load_task

pytestmark = pytest.mark.sim


def rollout(gentle: bool) -> Rollout:
    instance = prepare(
        EpisodeSpec("click_bell", "clean").at(1), load_task("click_bell"), default_pack()
    )
    settle(instance)
    return start(instance, RolloutOptions(gentle=gentle))


def lower(run: Rollout, height: float) -> None:
    """Bring the left hand, its fingers down, over the table and then to the ee's height [m]."""
    arm = run.world.robot.left
    kinematics = arm_kinematics(run.world.robot.embodiment)["left"]
    for z in (0.95, height):
        goal = Pose((-0.25, -0.1, z), STRAIGHT_DOWN)
        q = kinematics.solve_near(goal, arm.limb.bent, stream(0, "test"))
        assert q is not None
        drive(run, q)


def drive(run: Rollout, q: Array) -> None:
    run.world.robot.left.drive(q.tolist(), [0.0] * len(q))
    for _ in range(250):
        run.tick()


WRIST_DOWN = np.array([-0.14, 2.7, 0.76, 0.0, -0.82, 0.0])  # [rad] 0.8 rad into the table


def test_an_arm_that_moves_freely_feels_nothing() -> None:
    run = rollout(gentle=True)
    lower(run, 0.93)
    assert run.strain.force == 0.0
    assert run.strain.problem is None


def test_a_wrist_on_the_table_is_a_collision_and_names_the_pair() -> None:
    run = rollout(gentle=False)
    drive(run, WRIST_DOWN)
    strain = run.strain
    assert strain.force > MAX_FORCE
    assert strain.force_seconds > MAX_SECONDS
    assert strain.pair.endswith(" and table")
    assert strain.pair.startswith("fl_link")
    arm = run.world.robot.left
    pressing = np.abs(run.world.robot.effort()[arm.index])
    assert pressing.max() == pytest.approx(arm.limb.effort[1], rel=0.01)  # all its motor has
    with pytest.raises(Infeasible) as ended:
        drive(rollout(gentle=True), WRIST_DOWN)
    assert ended.value.reason in ("collision", "overloaded")


def test_fingers_may_press() -> None:
    run = rollout(gentle=True)
    tip = run.world.robot.left.limb.hand.tip
    lower(run, 0.74 + tip - 0.01)
    assert run.strain.force == 0.0
    assert run.strain.torque > 0.01


@pytest.mark.parametrize(
    ("strain", "reason"),
    [
        (Strain(force=500.0, force_seconds=MAX_SECONDS), None),
        (Strain(force=31.0, pair="a and b", force_seconds=0.12), "collision"),
        (Strain(torque=1.2, joint="j", torque_seconds=0.12), "overloaded"),
    ],
)
def test_a_blow_may_be_hard_but_not_last(strain: Strain, reason: str | None) -> None:
    assert (strain.problem and strain.problem[0]) == reason
