"""The robot that scripts command: its motions, what it tries first, and its one second try."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
import pytest

from rtphys.assets.pack import default_pack
from rtphys.core.errors import Infeasible
from rtphys.core.poses import Array
from rtphys.episode.generate import Attempt, attempt
from rtphys.expert.hands import STROKE_TIME
from rtphys.expert.planner import ArmGoal
from rtphys.expert.robot import ExpertRobot
from rtphys.plan.trajectory import JERK, TIME_STEP, Trajectory
from rtphys.spec.collection import CollectionSpec
from rtphys.spec.episode import EpisodeSpec
from rtphys.spec.stored import differences, stored
from rtphys.studies.collect import header_of
from rtphys.task import Robot, lifted
from rtphys.task.spec import Task, load_task

pytestmark = pytest.mark.sim


@dataclass
class Watched:
    """Commands of both arms at every step, and the motions that were planned for them."""

    postures: list[Array] = field(default_factory=list)
    openings: list[list[float]] = field(default_factory=list)
    motions: list[tuple[int, Trajectory]] = field(default_factory=list)  # first step, motion

    def watch(self, robot: Robot) -> None:
        assert isinstance(robot, ExpertRobot)
        tick, plan = robot.rollout.tick, robot.planner.motion

        def ticked() -> bool:
            arms = robot.world.robot.arms
            self.postures.append(np.concatenate([arm.target for arm in arms]))
            self.openings.append([arm.gripper for arm in arms])
            return tick()

        def planned(start: dict[str, Array], goals: dict[str, ArmGoal], pace: float) -> Trajectory:
            motion = plan(start, goals, pace)
            self.motions.append((len(self.postures), motion))
            return motion

        robot.rollout.tick, robot.planner.motion = ticked, planned

    def straight_jerks(self, least: float = 0.0) -> list[float]:
        """Largest jerk of each point-to-point motion of `least` [rad] or more [rad/s^3]."""
        jerks = []
        for first, motion in self.motions:
            commands = np.array(self.postures[first : first + len(motion)])
            if len(motion) < 2 or not is_straight(motion.q):
                continue
            if np.abs(motion.q[-1] - motion.q[0]).max() < least:
                continue
            np.testing.assert_array_equal(commands, motion.q)
            whole = np.concatenate([*[commands[:1]] * 3, commands, *[commands[-1:]] * 3])
            jerks.append(float(np.abs(np.diff(whole, 3, axis=0)).max()) / TIME_STEP**3)
        return jerks


def is_straight(q: Array) -> bool:
    change = q[-1] - q[0]
    done = (q - q[0]) @ change / (change @ change)
    return bool(np.abs(q - q[0] - done[:, None] * change).max() < 1e-12)


@pytest.fixture(scope="module")
def attempts() -> list[Watched]:
    """Successful attempts of four tasks."""
    found = []
    for name in ("place_empty_cup", "click_bell", "beat_block_hammer", "shake_bottle"):
        watched, task = Watched(), load_task(name)

        def script(robot: Robot, watched: Watched = watched, task: Task = task) -> None:
            watched.watch(robot)
            task.script(robot)

        done = attempt(
            EpisodeSpec(name, "clean").at(0), replace(task, script=script), default_pack()
        )
        assert done.accepted, (name, done.reason, done.detail)
        found.append(watched)
    return found


def test_most_point_to_point_motions_keep_the_limit_of_jerk(attempts: list[Watched]) -> None:
    jerks = [jerk for watched in attempts for jerk in watched.straight_jerks()]
    assert len(jerks) >= 8
    assert np.median(jerks) <= JERK * (1 + 1e-6)
    # Without a limit, braking from 10 rad/s^2 within a step would be 2,500: so much has none,
    # however short it is. One of less than a milliradian takes eight steps: 1,320.
    assert max(jerks) < 1500
    assert max(jerk for watched in attempts for jerk in watched.straight_jerks(0.001)) < 1000


def test_strokes_speed_up_and_slow_down_gradually(attempts: list[Watched]) -> None:
    fastest = 1 / STROKE_TIME
    for watched in attempts:
        rates = np.diff(np.array(watched.openings), axis=0) / TIME_STEP  # [1/s]
        assert 0.9 * fastest < np.abs(rates).max() <= fastest * (1 + 1e-6)
        # At constant speed, it would begin and end with all of it in one step.
        assert np.abs(np.diff(rates, axis=0)).max() < 0.3 * fastest


def scripted(script: Callable[[Robot], None]) -> Attempt:
    task = replace(load_task("click_bell"), script=script)
    return attempt(EpisodeSpec("click_bell", "clean").at(0), task, default_pack())


def test_the_first_height_in_reach_is_taken() -> None:
    asked: list[float] = []
    taken: list[float | None] = []

    def script(robot: Robot) -> None:
        def rise(height: float) -> None:
            asked.append(height)
            robot.do(robot.left.shift(z=height))

        taken.append(robot.first_feasible((3.0, 2.0, 0.02, 0.01), rise))
        taken.append(robot.first_feasible((3.0, 2.0), rise))
        taken.append(robot.first_feasible((), rise))

    scripted(script)
    assert taken == [0.02, None, None]
    assert asked == [3.0, 2.0, 0.02, 3.0, 2.0]


def test_an_option_that_fails_on_the_way_ends_the_attempt() -> None:
    asked: list[float] = []

    def script(robot: Robot) -> None:
        def rise_twice(height: float) -> None:
            asked.append(height)
            robot.do(robot.left.shift(z=0.02))
            robot.do(robot.left.shift(z=height))

        robot.first_feasible((3.0, 0.01), rise_twice)

    assert scripted(script).reason == "unreachable"
    assert asked == [3.0]


def test_only_planning_is_passed_over() -> None:
    def script(robot: Robot) -> None:
        def slip(_: int) -> None:
            raise Infeasible("slipped", "at once")

        robot.first_feasible((1, 2), slip)

    assert scripted(script).reason == "slipped"


def clumsy(robot: Robot, losses: int) -> None:
    """Lifts the red block, and opens the hand behind the expert's back the first few times."""
    assert isinstance(robot, ExpertRobot)
    arm = robot.nearest("red")
    left = losses

    def take() -> None:
        nonlocal left
        robot.do(arm.grasp("red", pre=0.08))
        if left:
            left -= 1
            robot.world.robot.arm(arm.side).grip(1.0)
        robot.do(arm.lift(0.08))

    robot.retake(take)


def tried(losses: int, recovery: bool = True) -> Attempt:
    task = load_task("stack_blocks_two")
    up = lifted("red", 0.05)
    scripted = replace(task, script=lambda robot: clumsy(robot, losses), success=up)
    return attempt(
        EpisodeSpec("stack_blocks_two", "clean", recovery=recovery).at(3), scripted, default_pack()
    )


def test_a_lost_load_is_taken_again_in_stages_of_its_own() -> None:
    found = tried(losses=1)
    assert found.accepted, (found.reason, found.detail)
    assert found.recording is not None
    assert found.recording.recovered
    told = [stage.startswith("recover ") for stage in found.recording.stages]
    first = told.index(True)
    assert all(told[first : told.index(False, first)])
    assert any("grasp red" in stage for stage in found.recording.stages[first:])


def test_a_load_that_is_never_lost_leaves_no_trace() -> None:
    found = tried(losses=0, recovery=False)
    assert found.accepted
    assert found.recording is not None
    assert not found.recording.recovered


@pytest.mark.parametrize(
    ("losses", "recovery", "reason"), [(2, True, "slipped"), (1, False, "recovered")]
)
def test_there_is_one_second_try_unless_the_recipe_excludes_it(
    losses: int, recovery: bool, reason: str
) -> None:
    found = tried(losses, recovery)
    assert found.reason == reason
    assert found.recording is not None
    assert found.recording.recovered == recovery


def test_what_no_second_try_cures_is_raised_at_once() -> None:
    def fail() -> None:
        raise Infeasible("stalled", "a door")

    found = scripted(lambda robot: robot.retake(fail))
    assert found.reason == "stalled"
    assert found.recording is not None and not found.recording.recovered


def test_collections_with_and_without_it_do_not_mix() -> None:
    task, pack = load_task("click_bell"), default_pack()
    kept, without = (
        stored(
            header_of(
                CollectionSpec(EpisodeSpec("click_bell", "clean", recovery=recovery)), task, pack
            )
        )
        for recovery in (True, False)
    )
    assert EpisodeSpec("click_bell", "clean").recovery, "kept unless it is said otherwise"
    (clause,) = differences(kept, without)
    assert clause == "spec.episode.recovery was True, now False"
