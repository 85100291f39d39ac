"""LeRobot checkpoints in a process of their own: the real server, checkpoints made up and real."""

import json
import os
import random
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import synthetic
from collected import collect

from rtphys.assets.pack import default_pack
from rtphys.core.errors import BadFile, BadValue, UnknownName
from rtphys.data.dataset import Dataset
from rtphys.episode import CameraView, PolicyEpisode, View, begin
from rtphys.episode.observation import Mirror
from rtphys.policies import PolicyGone, PolicySetup, ServerFailed, open_policy
from rtphys.policies.lerobot import (
    PHYSICS,
    LeRobot,
    check_vectors,
    observed,
    open_lerobot,
    physics_vector,
)
from rtphys.policies.lerobot_server import STATE, Checkpoint, pack, unpack
from rtphys.spec.episode import EpisodeSpec
from rtphys.task.spec import load_task

HERE = Path(__file__).parent
CAMERAS = {"high": "head", "left_wrist": "left", "right_wrist": "right"}
Episodes = Callable[[], PolicyEpisode]
Opener = Callable[..., LeRobot]


@pytest.fixture
def stub(tmp_path: Path) -> Iterator[Opener]:
    """Opens the checkpoint that `lerobot_stub` makes up for a name."""
    python, opened = tmp_path / "python", list[LeRobot]()
    python.write_text(f'#!/bin/sh\nexec "{sys.executable}" "{HERE}/lerobot_stub.py" "$@"\n')
    python.chmod(0o755)

    def opener(name: str, **given: str) -> LeRobot:
        chosen = {"python": str(python), "reply_s": "60", **given}
        opened.append(open_lerobot(name, PolicySetup("click_bell", options=chosen)))
        return opened[-1]

    yield opener
    for policy in opened:
        policy.close()


class Watched:
    """An episode that notes every action, and what could be seen before it."""

    def __init__(self, episode: PolicyEpisode, cameras: dict[str, str]) -> None:
        self._episode, self._cameras = episode, cameras
        self.seen: list[dict[str, np.ndarray]] = []
        self.actions: list[np.ndarray] = []

    def __getattr__(self, name: str) -> object:
        return getattr(self._episode, name)

    def act(self, action: np.ndarray) -> bool:
        self.seen.append(observed(self._episode.observe(), self._cameras))
        self.actions.append(action)
        return self._episode.act(action)


def test_a_message_survives_the_socket() -> None:
    arrays = {"observation.state": np.arange(14, dtype=np.float32), "x": np.zeros((2, 3), np.uint8)}
    about, found = unpack(pack({"do": "act", "task": "läute"}, arrays))
    assert about == {"do": "act", "task": "läute"} and found.keys() == arrays.keys()
    for name, array in arrays.items():
        np.testing.assert_array_equal(found[name], array, strict=True)


@pytest.mark.sim
def test_all_chance_of_an_episode_follows_from_its_seed() -> None:
    seeds, checkpoint = list[int](), object.__new__(Checkpoint)
    checkpoint.torch = SimpleNamespace(manual_seed=seeds.append)
    checkpoint.policy = checkpoint.before = checkpoint.after = SimpleNamespace(reset=lambda: None)
    drawn = list[tuple[float, float]]()
    for seed in (5, 6, 5):
        checkpoint.reset(seed)
        drawn.append((random.random(), np.random.random()))  # noqa: NPY002
    assert seeds == [5, 6, 5] and drawn[0] == drawn[2] != drawn[1]


def test_a_checkpoint_acts(stub: Opener, episode: PolicyEpisode) -> None:
    episode.step_limit = 4
    start = episode.observe().vector
    stub("repeats").play(episode)
    assert episode.taken == 4
    moved = episode.observe().vector - start
    np.testing.assert_allclose(moved, [0.04, *[0.0] * 13], atol=1e-6)


@pytest.mark.sim
@pytest.mark.parametrize(
    ("given", "observations"),
    [({}, 6), ({"observe": "chunk"}, 2), ({"observe": "chunk", "execute": "1"}, 6)],
)
def test_every_action_has_an_observation_of_its_own_unless_a_chunk_is_to_share_one(
    stub: Opener,
    episode: PolicyEpisode,
    monkeypatch: pytest.MonkeyPatch,
    given: dict[str, str],
    observations: int,
) -> None:
    seen, observe = [], episode.observe
    episode.step_limit = 6
    monkeypatch.setattr(episode, "observe", lambda: seen.append(1) or observe())
    stub("repeats", **given).play(episode)
    assert len(seen) == observations


@pytest.mark.parametrize(
    ("about", "most"),
    [({"chunk_size": 4}, 4), ({"chunk_size": 4, "temporal_ensemble_coeff": 0.01}, 1), ({}, 9)],
)
def test_no_more_of_a_chunk_is_carried_out_than_it_has(
    about: dict[str, float], most: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """lerobot checks this when it reads a file, and not when the number is set afterwards."""

    def config(path: str) -> SimpleNamespace:
        return SimpleNamespace(type="act", device="cpu", n_action_steps=1, **about)

    policy = SimpleNamespace(from_pretrained=lambda path, config: SimpleNamespace(config=config))
    modules = {
        "lerobot.configs.policies": {"PreTrainedConfig": SimpleNamespace(from_pretrained=config)},
        "lerobot.policies.factory": {
            "get_policy_class": lambda kind: policy,
            "make_pre_post_processors": lambda config, **_: (None, None),
        },
        "torch": {},
    }
    for name, content in modules.items():
        monkeypatch.setitem(sys.modules, name, SimpleNamespace(**content))
    assert Checkpoint("act", "", most).config.n_action_steps == most
    if about:
        with pytest.raises(
            ValueError, match=f"execute = {most + 1} is not allowed; at most {most}"
        ):
            Checkpoint("act", "", most + 1)


LEROBOT = """
import sys, types
import numpy as np
sys.modules["stand_in"] = sys.modules[__name__]
for name in ("lerobot", "lerobot.configs", "lerobot.policies", "torch"):
    sys.modules[name] = types.ModuleType(name)
class Tensor(np.ndarray):
    def float(self): return self.astype(np.float32)
    def permute(self, *axes): return self.transpose(axes)
    def contiguous(self): return self
    def to(self, device): return self
    def numpy(self): return np.asarray(self)
torch = sys.modules["torch"]
torch.from_numpy = lambda array: array.view(Tensor)
torch.cat = lambda parts: np.concatenate(parts).view(Tensor)
torch.manual_seed = torch.set_num_threads = lambda n: None
torch.inference_mode = __import__("contextlib").nullcontext
KINDS = {}
class Remembers:
    def __init__(self):
        shape = lambda *n: types.SimpleNamespace(shape=n)
        inputs = {"observation.state": shape(14), "observation.images.cam_high": shape(3, 240, 320)}
        self.config = types.SimpleNamespace(type="remembers", device="cpu", input_features=inputs,
            output_features={"action": shape(14)}, n_obs_steps=1, n_action_steps=4)
    def from_pretrained(self, path, config): return self
    def reset(self): self.cache = []
    def __call__(self, given): return given
    def select_action(self, batch):
        self.cache.append(batch["observation.state"][0])
        action = batch["observation.state"].copy()
        action[0, 0] = 0.01 * len(self.cache)          # how many observations it remembers,
        action[0, 1] = sum(s[0] for s in self.cache)   # and what it saw in them
        return action
configs = sys.modules["lerobot.configs.policies"] = types.ModuleType("configs")
factory = sys.modules["lerobot.policies.factory"] = types.ModuleType("factory")
find = lambda path: KINDS["remembers"]
configs.PreTrainedConfig = types.SimpleNamespace(from_pretrained=lambda path: find(path).config)
factory.get_policy_class = lambda kind: KINDS[kind]
factory.make_pre_post_processors = lambda config, **_: (KINDS[config.type],) * 2
import runpy
del sys.argv[0]
runpy.run_path(sys.argv[0], run_name="__main__")
"""


@pytest.fixture
def of_others(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A Python with a stand-in for lerobot, and a package that brings a policy with a memory."""
    (tmp_path / "stand_in.py").write_text(LEROBOT)
    package = "import stand_in; stand_in.KINDS['remembers'] = stand_in.Remembers()\n"
    (tmp_path / "lerobot_policy_remembers.py").write_text(package)
    (tmp_path / "lerobot_policy_broken.py").write_text("raise ValueError('of another version')\n")
    (tmp_path / "ours").mkdir()
    (tmp_path / "ours" / "numpy.py").write_text("raise ImportError('our numpy, not theirs')\n")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path / "ours"))
    python = tmp_path / "python"
    start = f"""exec env PYTHONPATH="$PYTHONPATH:{tmp_path}" {sys.executable}"""
    python.write_text(f'#!/bin/sh\n{start} "{tmp_path}/stand_in.py" "$@"\n')
    python.chmod(0o755)
    return python


@pytest.mark.sim
def test_a_policy_with_a_memory_sees_what_lerobots_own_loop_shows_it(
    stub: Opener, of_others: Path, episode: PolicyEpisode
) -> None:
    """It comes from a package of others, and its Python does not search our folders."""
    episode.step_limit = 6
    watched = Watched(episode, {"observation.images.cam_high": "head"})
    stub("x", python=str(of_others)).play(watched)  # type: ignore[arg-type]
    states = np.array([one["observation.state"] for one in watched.seen], np.float32)
    actions = np.array(watched.actions)
    np.testing.assert_allclose(actions[:, 0], 0.01 * np.arange(1, 7), rtol=1e-6)
    np.testing.assert_allclose(actions[:, 1], np.cumsum(states[:, 0]), rtol=1e-5)


@pytest.mark.sim
@pytest.mark.parametrize(
    ("name", "given", "problem"),
    [
        ("dies", {}, r"lerobot:dies: .* ended with code 3: out of memory$"),
        ("talks", {}, "lerobot:talks: sent a message of more than 16777216 bytes"),
        ("larger", {}, r"640x480, drawn are 320x240; set size=640x480$"),
        ("knows_physics", {"physics": "true"}, "object_joint_damping is the asset's own here"),
    ],
)
def test_what_can_play_no_episode_stops_the_run(
    stub: Opener, episode: PolicyEpisode, name: str, given: dict[str, str], problem: str
) -> None:
    with pytest.raises(PolicyGone, match=problem):
        stub(name, **given).play(episode)


@pytest.mark.sim
@pytest.mark.parametrize(
    ("name", "problem"),
    [("fails", "RuntimeError: cannot multiply"), ("nan", r"action 0 of 1 is not finite: \[")],
)
def test_an_error_is_the_episodes_and_the_next_one_goes_on(
    stub: Opener, new_episode: Episodes, name: str, problem: str
) -> None:
    policy = stub(name)
    for _ in range(2):
        with pytest.raises(ServerFailed, match=rf"^lerobot:{name}: {problem}"):
            policy.play(new_episode())


@pytest.mark.parametrize(
    ("name", "error", "problem"),
    [
        ("no_lerobot", PolicyGone, r"has lerobot 0\.3\.9 and no lerobot\.policies \(.*\?python="),
        ("damaged", PolicyGone, r"by lerobot 0\.3\.9: ValueError: the header of model[^\n]*$"),
        ("other_robot", BadValue, r"observation\.state.*\[6\].*14 numbers.*another robot"),
        # Without an answer every episode would end in an error, and the rate would read 0 %.
        ("knows_physics", BadValue, r"physics labels; \?physics=true shows them"),
        ("knows_other_physics", BadValue, r"has to read .*_state of \[15\].* is \[13\]"),
        ("repeats", BadValue, r"its shape there is None"),
        ("other_cameras", UnknownName, r"\?cameras=.*unknown camera 'top'"),
    ],
)
def test_a_checkpoint_that_cannot_play_is_refused_before_any_episode(
    stub: Opener, name: str, error: type[Exception], problem: str
) -> None:
    oracle = {"physics": "true"} if name in ("knows_other_physics", "repeats") else {}
    with pytest.raises(error, match=problem):
        stub(name, **oracle)


def test_an_oracle_of_a_task_whose_props_have_physics_of_their_own() -> None:
    """An export has a number for each; only the thirteen attributes were shown."""
    physics = EpisodeSpec("heavy_below", "clean").draw(0)
    shown = physics_vector(physics)
    assert len(shown) > len(physics_vector(EpisodeSpec("click_bell", "clean").draw(0))) == 15
    assert np.float32(physics.scalar("object_mass@first")) in shown
    about = {"inputs": {PHYSICS: [len(shown)], STATE: [14]}, "outputs": {"action": [14]}}
    check_vectors(about, 14, oracle=True, physics=physics)
    with pytest.raises(BadValue, match=rf"has to read .* of \[{len(shown)}\].* is \[15\]"):
        fifteen = {**about, "inputs": {PHYSICS: [15], STATE: [14]}}
        check_vectors(fifteen, 14, oracle=True, physics=physics)


@pytest.mark.sim
def test_an_oracle_is_shown_the_labels(stub: Opener, painted: None) -> None:
    spec = EpisodeSpec("click_bell", "phys_random", overrides={"friction": 0.25})
    episode = begin(spec.at(0), load_task("click_bell"), default_pack())
    episode.step_limit = 1
    start = episode.observe().vector
    stub("knows_physics", physics="true").play(episode)
    assert episode.observe().vector[1] - start[1] == pytest.approx(0.25, abs=1e-6)


def test_cameras_may_have_other_names(stub: Opener) -> None:
    stub("other_cameras", cameras="head=top")


def test_what_is_no_python_is_told(tmp_path: Path) -> None:
    with pytest.raises(PolicyGone, match="python=nowhere does not start: No such file"):
        open_policy("lerobot:act?python=nowhere")
    with pytest.raises(BadFile, match=r"no config\.json"):
        open_policy(f"lerobot:{tmp_path}")


@pytest.mark.slow
@pytest.mark.sim
@pytest.mark.skipif("RTPHYS_LEROBOT_PYTHON" not in os.environ, reason="names a Python with lerobot")
def test_a_real_checkpoint_acts_as_in_lerobots_own_loop(
    tmp_path: Path, episode: PolicyEpisode, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Trained by lerobot on an export; every action is the same to the bit."""
    python = os.environ["RTPHYS_LEROBOT_PYTHON"]
    from rtphys.export.lerobot import export_lerobot  # needs pyarrow

    collect(tmp_path / "data", 2)
    export_lerobot(Dataset(tmp_path / "data"), tmp_path / "lr")
    options = {
        "dataset.repo_id": "rtphys/bell", "dataset.root": tmp_path / "lr",
        "dataset.video_backend": "pyav", "policy.type": "act", "policy.device": "cpu",
        "policy.push_to_hub": "false", "policy.pretrained_backbone_weights": "null",
        "policy.chunk_size": 8, "policy.n_action_steps": 5, "policy.dim_model": 64,
        "policy.dim_feedforward": 128, "policy.n_heads": 4, "batch_size": 2, "steps": 2,
        "num_workers": 0, "output_dir": tmp_path / "run", "wandb.enable": "false",
    }  # fmt: skip
    words = [f"--{key}={value}" for key, value in options.items()]
    environment = {**os.environ, "HF_HUB_OFFLINE": "1", "OMP_NUM_THREADS": "1"}
    train = [python, "-m", "lerobot.scripts.lerobot_train", *words]
    subprocess.run(train, env=environment, check=True)

    def noise(self: Mirror, packed: bytes, frame: int) -> View:
        rng = np.random.default_rng(frame)
        size = (synthetic.HEIGHT, synthetic.WIDTH, 3)
        three = {name: rng.integers(0, 256, size, dtype=np.uint8) for name in CAMERAS.values()}
        eye = np.eye(4, dtype=np.float32)
        return View({n: CameraView(p, eye[:3, :3], eye[:3], eye) for n, p in three.items()})

    monkeypatch.setattr(Mirror, "view", noise)
    policy = open_lerobot(str(tmp_path / "run"), PolicySetup(options={"python": python}))
    names = {f"observation.images.cam_{n}": ours for n, ours in CAMERAS.items()}
    episode.step_limit = 12  # two chunks, and a part of the third
    watched = Watched(episode, names)
    policy.play(watched)  # type: ignore[arg-type]
    policy.close()
    stored = {name: np.array([one[name] for one in watched.seen]) for name in watched.seen[0]}
    np.savez(tmp_path / "seen.npz", **stored)
    (tmp_path / "seen.json").write_text(json.dumps([*stored]))
    inner = tmp_path / "run/checkpoints/last/pretrained_model"
    loop = [HERE / "lerobot_loop.py", inner, tmp_path / "seen.npz", tmp_path / "actions.npy"]
    subprocess.run([python, *map(str, loop)], env=environment, check=True)
    np.testing.assert_array_equal(np.array(watched.actions), np.load(tmp_path / "actions.npy"))
