"""What a policy sees, and what its actions do."""

from types import SimpleNamespace
from typing import cast, get_args

import numpy as np
import pytest

from rtphys.assets.pack import default_pack
from rtphys.core.errors import BadValue, UnknownName
from rtphys.core.poses import Array, Pose, axis_angle
from rtphys.episode import Observation, PolicyEpisode, begin
from rtphys.episode.assemble import describer
from rtphys.episode.control import LOST_STEPS
from rtphys.episode.generate import attempt
from rtphys.policies import Stepwise, open_policy
from rtphys.policies.robotwin_env import official
from rtphys.sim.engine import TIME_STEP
from rtphys.sim.recorder import FRAME_STEPS
from rtphys.sim.rollout import Keep
from rtphys.spec.episode import EpisodeSpec
from rtphys.spec.recording import RecordingSpec
from rtphys.task.instructions import instructions
from rtphys.task.spec import load_task

pytestmark = pytest.mark.sim
TASK, PACK = "click_bell", default_pack()


def begun(seed: int = 0, protocol: str = "clean", **given: object) -> PolicyEpisode:
    recipe = EpisodeSpec(TASK, protocol, split="unseen").at(seed)
    return begin(recipe, load_task(TASK), PACK, **given)  # type: ignore[arg-type]


@pytest.fixture
def episode() -> PolicyEpisode:
    return begun()


def test_an_observation_is_what_the_official_one_is(episode: PolicyEpisode) -> None:
    seen = episode.observe()
    assert seen.vector.shape == seen.measured.shape == (14,)
    assert seen.grippers == (1.0, 1.0)
    np.testing.assert_allclose(seen.measured, seen.vector, atol=0.02)
    for side, commanded in zip(("left", "right"), episode._control.commanded_ee(), strict=True):
        np.testing.assert_allclose(seen.endposes[side][:3], commanded.p, atol=2e-3)
    assert seen.time == 0.0 and episode.taken == 0 and not episode.over
    said = instructions(load_task(TASK), episode.seed, describer(PACK))
    assert episode.instruction == said["unseen"][0]
    heard = PolicyEpisode(episode.instance, PACK, episode.recording_spec, "nothing", "seen")
    assert heard.instruction == said["seen"][0] != episode.instruction


def test_the_same_seed_gives_the_same_observations() -> None:
    first, second = begun(3, "phys_random"), begun(3, "phys_random")
    for _ in range(3):
        for episode in (first, second):
            episode.act(episode.observe().vector + 0.05)
        a, b = first.observe(), second.observe()
        np.testing.assert_array_equal(a.measured, b.measured)
    assert first.rollout.recorder.recording.hash == second.rollout.recorder.recording.hash


def test_an_ee_action_brings_the_hand_there(episode: PolicyEpisode) -> None:
    left, right = episode._control.commanded_ee()
    goal = Pose(left.p + np.array([0.02, 0.03, 0.05]), left.q)
    action = np.concatenate([goal.p, goal.q, [0.5], right.p, right.q, [1.0]])
    for _ in range(3):
        episode.act(action, "ee")
    reached, still = episode._control.commanded_ee()
    np.testing.assert_allclose(reached.p, goal.p, atol=2e-4)
    np.testing.assert_allclose(still.p, right.p, atol=2e-4)
    np.testing.assert_allclose(episode.observe().endposes["left"][:3], goal.p, atol=5e-3)
    assert episode.unreachable == 0 and episode.observe().grippers == (0.5, 1.0)


def test_a_delta_moves_from_the_commanded_pose(episode: PolicyEpisode) -> None:
    before, _ = episode._control.commanded_ee()
    turn = axis_angle([0, 0, 1], 0.2)
    action = np.concatenate([[0.0, 0.0, 0.04], turn, [1.0], [0, 0, 0], [1, 0, 0, 0], [1.0]])
    episode.act(action, "delta_ee")
    episode.act(action, "delta_ee")
    after, _ = episode._control.commanded_ee()
    np.testing.assert_allclose(after.p, before.p + np.array([0, 0, 0.08]), atol=5e-4)
    assert after.angle_to(before) == pytest.approx(0.4, abs=5e-3)


def test_tracked_actions_take_a_frame_each_and_do_not_stop_between(episode: PolicyEpisode) -> None:
    rest = episode.observe().vector
    goal = rest.copy()
    goal[0] += 0.5
    goal[13] = 0.0
    commanded = []
    for _ in range(20):
        began = episode.rollout.steps
        episode.act(goal, "tracked_qpos")
        assert episode.rollout.steps == began + FRAME_STEPS
        commanded.append(episode.observe().vector)
    speed = np.diff([rest[0], *(row[0] for row in commanded)]) / (FRAME_STEPS * TIME_STEP)
    top = int(speed.argmax())
    assert speed[top] > 1.0  # [rad/s]; from rest to rest a frame averages 0.15
    assert (np.diff(speed[: top + 1]) > 0).all() and (np.diff(speed[top:]) < 1e-9).all()
    np.testing.assert_allclose(commanded[-1], goal, atol=1e-9)
    assert episode.taken == 20 and episode.unreachable == 0


def test_a_tracked_motion_bends_towards_a_new_target(episode: PolicyEpisode) -> None:
    goal = episode.observe().vector
    first = goal[0]
    for _ in range(3):
        goal[0] = first + 0.5
        episode.act(goal, "tracked_qpos")
    turned = episode.observe().vector[0]
    goal[0] = first
    episode.act(goal, "tracked_qpos")
    # It brakes before it turns back: no drive target jumps.
    assert episode.observe().vector[0] > turned
    while episode.observe().vector[0] != pytest.approx(first, abs=1e-9):
        assert not episode.over
        episode.act(goal, "tracked_qpos")


def test_an_arm_that_cannot_get_there_keeps_still_and_is_counted(episode: PolicyEpisode) -> None:
    before = episode.observe().vector
    far = np.array([0.0, 0.0, 5.0, 1, 0, 0, 0, 1.0])
    episode.act(np.concatenate([far, far]), "ee")
    assert episode.unreachable == 2 and episode.taken == 1
    assert episode.rollout.steps == LOST_STEPS
    np.testing.assert_array_equal(episode.observe().vector, before)


@pytest.mark.parametrize(
    ("action", "kind"),
    [
        (np.zeros(13), "qpos"),
        (np.full(14, np.nan), "qpos"),
        (np.zeros(14), "ee"),
        (np.zeros(16), "ee"),  # its quaternions have no direction
        (np.full(14, np.inf), "tracked_qpos"),
    ],
)
def test_what_no_robot_can_be_given_is_refused(
    episode: PolicyEpisode, action: Array, kind: str
) -> None:
    what = r"it is 14 finite numbers: left arm 6" if "qpos" in kind else "action"
    with pytest.raises(BadValue, match=what):
        episode.act(action, kind)  # type: ignore[arg-type]
    assert episode.taken == 0


def test_an_unknown_kind_of_action_is_named(episode: PolicyEpisode) -> None:
    with pytest.raises(UnknownName, match="delta_ee"):
        episode.act(np.zeros(14), "delta_e")  # type: ignore[arg-type]


def test_after_the_last_action_nothing_moves(episode: PolicyEpisode) -> None:
    episode.step_limit = 2
    for _ in range(5):
        episode.act(episode.observe().vector)
    steps = episode.rollout.steps
    assert (episode.taken, episode.over, episode.reason) == (2, True, "step_limit")
    assert not episode.act(np.zeros(14)) and episode.rollout.steps == steps


def test_to_stop_early_is_to_give_up(episode: PolicyEpisode) -> None:
    episode.act(episode.observe().vector)
    first = episode.finish()
    assert (episode.reason, episode.over, first.held) == ("gave_up", True, False)
    assert episode.finish() is first


def test_the_expert_does_what_its_demonstration_did() -> None:
    tried = attempt(EpisodeSpec(TASK, "phys_random").at(0), load_task(TASK), PACK)
    assert tried.accepted and tried.recording is not None
    episode = begun(0, "phys_random")
    open_policy("expert").play(episode)
    assert episode.success and episode.finish().held
    assert episode.rollout.recorder.recording.hash == tried.recording.hash


@pytest.mark.parametrize("protocol", ["clean", "phys_random_all"])
def test_what_is_kept_of_an_episode_moves_no_bit_of_it(protocol: str) -> None:
    ends: dict[Keep, tuple[bytes, str, int]] = {}
    for keep in get_args(Keep):
        episode = begun(0, protocol, keep=keep)
        episode.step_limit = 8
        open_policy("jitter").play(episode)
        recording = episode.rollout.recorder.recording
        ends[keep] = episode.rollout.world.state().tobytes(), recording.hash, len(recording.rows)
    state, hashed, rows = ends["rows"]
    assert rows > 8
    assert ends == {
        "rows": (state, hashed, rows),
        "hash": (state, hashed, 1),
        "nothing": (state, ends["nothing"][1], 1),
    }


def test_a_stepwise_policy_acts_out_its_chunks(episode: PolicyEpisode) -> None:
    class Chunks(Stepwise):
        seen = 0

        def act(self, observation: Observation) -> Array:
            self.seen += 1
            return np.tile(observation.vector, (4, 1))

    episode.step_limit = 10
    policy = Chunks()
    policy.play(episode)
    assert episode.taken == 10 and policy.seen == 3


def test_a_stepwise_policy_that_returns_none_gives_up(episode: PolicyEpisode) -> None:
    class Twice(Stepwise):
        seen = 0

        def act(self, observation: Observation) -> Array | None:
            self.seen += 1
            return observation.vector if self.seen <= 2 else None

    Twice().play(episode)
    outcome = episode.finish()
    assert (episode.taken, episode.reason) == (2, "gave_up")
    assert outcome.detail.startswith("not true: ")


def test_a_chunk_without_actions_is_an_error_of_the_policy() -> None:
    """It hung until the time limit of an episode."""

    class Empty(Stepwise):
        seen = 0

        def act(self, observation: Observation) -> Array:
            self.seen += 1
            assert self.seen == 1
            return np.empty((0, 14))

    waiting = cast(PolicyEpisode, SimpleNamespace(over=False, observe=lambda: None))
    with pytest.raises(ValueError, match="act returned no action"):
        Empty().play(waiting)


def test_a_stepwise_policy_names_the_kind_of_its_actions(episode: PolicyEpisode) -> None:
    class Shifts(Stepwise):
        kind = "delta_ee"

        def act(self, observation: Observation) -> Array:
            return np.tile([0.0, 0.0, 0.01, 1.0, 0.0, 0.0, 0.0, 1.0], 2)

    episode.step_limit = 1
    before = episode.observe().endposes["left"][2]
    Shifts().play(episode)
    assert episode.observe().endposes["left"][2] - before == pytest.approx(0.01, abs=1e-3)


@pytest.mark.render
def test_pictures_show_the_instant_they_were_observed_at(episode: PolicyEpisode) -> None:
    early = episode.observe()
    for _ in range(4):
        episode.act(early.vector + np.array([0.3, 0.8, 0.5, 0, 0, 0, 0] * 2))
    late = episode.observe()
    assert set(late.images) == {"head", "left", "right"}
    assert late.images["head"].shape == (240, 320, 3) and late.images["head"].dtype == np.uint8
    fresh = begun().observe()
    for camera in late.images:
        np.testing.assert_array_equal(early.images[camera], fresh.images[camera])
        assert (early.images[camera] != late.images[camera]).any(), camera
    assert late.cameras["left"].cam2world_gl.shape == (4, 4)


@pytest.mark.render
def test_senses_are_observed_on_request() -> None:
    senses = ("depth", "segmentation", "pointcloud")
    now = begun(recording_spec=RecordingSpec(("head",), senses)).observe()
    head = now.cameras["head"]
    assert head.depth is not None and head.depth.shape == (240, 320)
    shown = official(now)
    camera = shown["observation"]["head_camera"]  # type: ignore[index]
    assert camera["depth"].dtype == np.float64
    assert np.allclose(camera["depth"], head.depth * 1000.0)
    assert camera["actor_segmentation"].shape == (240, 320, 3)
    assert shown["pointcloud"].shape == (1024, 6)  # type: ignore[attr-defined]
    plain = begun(recording_spec=RecordingSpec(("head",))).observe()
    assert np.array_equal(plain.images["head"], head.rgb)
    assert plain.cloud is None and official(plain)["pointcloud"] == []
