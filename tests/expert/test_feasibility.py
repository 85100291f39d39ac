"""Planning questions: asking changes no later answer, and the other arm's intent is told."""

from itertools import islice

import numpy as np
import pytest

from rtphys.assets.pack import default_pack
from rtphys.core.errors import Infeasible
from rtphys.core.poses import Pose
from rtphys.core.seeds import stream
from rtphys.episode.generate import prepare, settle, start
from rtphys.expert.arm import ExpertArm
from rtphys.expert.feasibility import Feasibility, Intent
from rtphys.expert.grasp import STRAIGHT_DOWN, candidates
from rtphys.expert.hands import Hands
from rtphys.expert.planner import DualArmPlanner
from rtphys.plan.collision import Obstacle
from rtphys.sim.rollout import Rollout
from rtphys.spec.episode import EpisodeSpec
from rtphys.task.arm import Aim, Placing
from rtphys.task.props import TABLE_TOP
from rtphys.task.spec import load_task

pytestmark = pytest.mark.sim


@pytest.fixture(scope="module")
def rollout() -> Rollout:
    task, pack = load_task("stack_blocks_two"), default_pack()
    instance = prepare(EpisodeSpec(task.name, "clean").at(3), task, pack)
    settle(instance)
    return start(instance)


def asked_afresh(rollout: Rollout) -> Feasibility:
    planner = DualArmPlanner(rollout.world.robot.embodiment, stream(3, "test"))
    feasibility = Feasibility(rollout, planner, Hands(rollout, planner))
    feasibility.refresh()
    return feasibility


def side_of(rollout: Rollout, prop: str) -> str:
    return "left" if rollout.scene.pose(prop).p[0] < 0 else "right"


def grasps_of(rollout: Rollout, prop: str, side: str, most: int = 6) -> list[tuple[Pose, Pose]]:
    """Poses before and at the first few candidates."""
    hand = rollout.world.robot.arm(side).limb.hand
    points = [(i, rollout.scene.contact(prop, i)) for i in range(4)]
    found = candidates(points, side, TABLE_TOP, hand)
    return [(grasp.backed_off(0.08), grasp.ee) for grasp in islice(found, most)]


def answers(feasibility: Feasibility, rollout: Rollout) -> list[object]:
    side = side_of(rollout, "red")
    told = []
    for poses in grasps_of(rollout, "red", side):
        path = feasibility.grasp(side, "red", poses, other=None)
        told.append(None if path is None else (path.start.tobytes(), path.end.tobytes()))
    return told


def test_the_same_questions_get_the_same_answers_again(rollout: Rollout) -> None:
    feasibility = asked_afresh(rollout)
    first = answers(feasibility, rollout)
    assert any(first), "no grasp of the block is feasible: nothing is tested"
    other = "right" if side_of(rollout, "red") == "left" else "left"
    for ask in (
        lambda: feasibility.grasp(other, "red", grasps_of(rollout, "red", other)[0], None),
        lambda: feasibility.path(other, [feasibility.commanded_ee(other)] * 2, None),
        lambda: feasibility.clear(other, np.zeros(6), None, "green"),
        lambda: answers(feasibility, rollout),
    ):
        ask()
    assert answers(feasibility, rollout) == first


def test_asking_moves_nothing(rollout: Rollout) -> None:
    before, steps = rollout.world.state().tobytes(), rollout.steps
    answers(asked_afresh(rollout), rollout)
    assert rollout.world.state().tobytes() == before
    assert rollout.steps == steps


def test_an_arm_that_will_stand_there_is_in_the_way(rollout: Rollout) -> None:
    """Both arms are asked about one place: only the other's intent makes it unclear."""
    feasibility = asked_afresh(rollout)
    middle = Pose((0.0, -0.15, 0.95), STRAIGHT_DOWN)
    left, right = (feasibility.posture(side, middle) for side in ("left", "right"))
    assert left is not None and right is not None
    assert feasibility.clear("left", left, other=None)
    assert not feasibility.clear("left", left, other=Intent(right))
    assert feasibility.clear("left", left, other=None)


def test_a_hand_may_touch_what_it_will_be_around(rollout: Rollout) -> None:
    feasibility = asked_afresh(rollout)
    side = side_of(rollout, "red")
    opposite = "right" if side == "left" else "left"
    home = rollout.world.robot.arm(opposite).limb.home
    path = next(
        path
        for poses in grasps_of(rollout, "red", side)
        if (path := feasibility.grasp(side, "red", poses, None)) is not None
    )
    # Off the middle, a finger overlaps the block: fine only for a hand that is around it.
    ee = feasibility.planner.kinematics[side].ee_pose(path.end)
    inside = feasibility.planner.posture(side, ee.moved(0.03 * ee.R[:, 1]), path.end)
    assert inside is not None
    assert not feasibility.clear(opposite, home, Intent(inside))
    assert feasibility.clear(opposite, home, Intent(inside, around="red"))


def test_on_a_line_fingers_may_touch_and_the_palm_may_not(rollout: Rollout) -> None:
    feasibility = asked_afresh(rollout)
    side = side_of(rollout, "red")
    hand, block = rollout.world.robot.arm(side).limb.hand, rollout.scene.pose("red").p
    top = block + np.array([0.0, 0.0, 0.025])

    def ee(height: float) -> Pose:
        """The fingertips of a hand that looks straight down, above the block's top."""
        return Pose(top + np.array([0.0, 0.0, hand.tip + height]), STRAIGHT_DOWN)

    palm = hand.palm + hand.fingertip  # from the fingertips up
    assert feasibility.path(side, (ee(0.1), ee(-0.02)), None) is not None
    assert feasibility.path(side, (ee(0.1), ee(-palm - 0.01)), None) is None


def test_nothing_else_is_between_the_fingers_of_a_grasp(rollout: Rollout) -> None:
    feasibility = asked_afresh(rollout)
    side = side_of(rollout, "red")
    found = (
        (poses, feasibility.grasp(side, "red", poses, None))
        for poses in grasps_of(rollout, "red", side)
    )
    poses, _ = next((poses, path) for poses, path in found if path is not None)
    at, hand = rollout.world.X_WT @ poses[1], rollout.world.robot.arm(side).limb.hand
    plate = np.array([0.004, 0.002, 0.004])
    for aside, free in ((0.033, False), (0.2, True)):
        place = at @ Pose((hand.tcp, aside, 0.0))
        feasibility.planner.checker.set_obstacles([Obstacle("plate", plate, place)])
        assert (feasibility.grasp(side, "red", poses, None) is not None) is free


def test_verbs_state_their_intent_and_what_an_aim_asks_is_none(rollout: Rollout) -> None:
    feasibility, intents = asked_afresh(rollout), {}
    side = side_of(rollout, "red")
    arm = ExpertArm(side, feasibility, intents)
    arm.grasp("red", pre=0.08)
    plain = intents[side]
    assert (set(intents), plain.around) == ({side}, "red")

    again: dict[str, Intent] = {}
    aimed = ExpertArm(side, asked_afresh(rollout), again)
    target = Pose(rollout.scene.pose("red").p + np.array([0.0, -0.05, 0.05]))
    aimed.grasp("red", pre=0.08, aim=Aim(target, None, Placing(mode="free")))
    assert (set(again), again[side].around) == ({side}, "red")
    ends = [candidate for _, candidate in grasps_of(rollout, "red", side, most=80)]
    reached = feasibility.planner.kinematics[side].ee_pose(again[side].posture)
    task = rollout.world.to_task(reached)
    assert min(np.linalg.norm(task.p - end.p) for end in ends) < 1e-3, "the grasp, not its aim"


def test_a_grasp_that_allows_no_aim_is_the_first_and_the_intent(
    rollout: Rollout, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("rtphys.expert.arm.MAX_AIMED", 3)
    side, plain, aimed = side_of(rollout, "red"), dict[str, Intent](), dict[str, Intent]()
    ExpertArm(side, asked_afresh(rollout), plain).grasp("red", pre=0.08)
    nowhere = Aim(Pose((0.0, 5.0, 1.0)), None, Placing(mode="free"))
    ExpertArm(side, asked_afresh(rollout), aimed).grasp("red", pre=0.08, aim=nowhere)
    np.testing.assert_array_equal(aimed[side].posture, plain[side].posture)


def test_placing_looks_where_things_are_now(
    rollout: Rollout, monkeypatch: pytest.MonkeyPatch
) -> None:
    feasibility = asked_afresh(rollout)
    told: list[object] = []
    monkeypatch.setattr(feasibility.planner.checker, "set_obstacles", told.append)
    side, red = side_of(rollout, "red"), rollout.scene.pose("red")
    arm = ExpertArm(side, feasibility, {})
    rollout.tick()
    with pytest.raises(Infeasible, match="cannot place red there"):  # it has looked all the same
        arm.place("red", red.moved((0, 5, 0)))
    assert len(told) == 1
