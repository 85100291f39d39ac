"""A plug-in written to the letter of RoboTwin's contract, as a launcher would find it."""

import sys
import textwrap
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from rtphys.core.errors import BadFile, RtphysError
from rtphys.episode import PolicyEpisode
from rtphys.policies import PolicySetup
from rtphys.policies.robotwin_plugin import open_robotwin

pytestmark = pytest.mark.sim

Episodes = Callable[[], PolicyEpisode]

STUB = """
    import numpy as np

    class Model:
        def __init__(self, usr_args):
            self.args = usr_args
            self.rows = np.load(usr_args["recording"])
            self.resets = 0
            self.seen = []

    def encode_obs(observation):
        cameras = observation["observation"]
        pictures = [cameras[c + "_camera"]["rgb"] for c in ("head", "left", "right")]
        ends = observation["endpose"]
        poses = ends["left_endpose"] + [ends["left_gripper"]] + ends["right_endpose"]
        return pictures, observation["joint_action"]["vector"], poses

    def get_model(usr_args):
        return Model(usr_args)

    def eval(TASK_ENV, model, observation):
        instruction = TASK_ENV.get_instruction()
        model.seen.append((encode_obs(observation), instruction, TASK_ENV.take_action_cnt))
        n = TASK_ENV.take_action_cnt
        for action in model.rows[n : n + 6]:
            TASK_ENV.take_action(action)
            observation = TASK_ENV.get_obs()
            if TASK_ENV.eval_success:
                break

    def reset_model(model):
        model.resets += 1
"""


@pytest.fixture
def robotwin_root(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A RoboTwin root with one policy; whatever it imports is forgotten afterwards."""
    known = set(sys.modules)
    monkeypatch.setattr(sys, "path", [*sys.path])
    (tmp_path / "policy").mkdir()
    yield tmp_path
    for name in set(sys.modules) - known:
        if name.startswith("Stub"):
            del sys.modules[name]


def write_stub(root: Path, name: str, source: str, yml: str = "", init: bool = True) -> Path:
    folder = root / "policy" / name
    folder.mkdir()
    (folder / "deploy_policy.py").write_text(textwrap.dedent(source))
    if init:
        (folder / "__init__.py").write_text("from .deploy_policy import *\n")
    if yml:
        (folder / "deploy_policy.yml").write_text(yml)
    return folder / "deploy_policy.py"


def model_of(file: Path | str, setup: PolicySetup | None = None) -> Any:
    """What the plug-in's `get_model` made."""
    return open_robotwin(str(file), setup or PolicySetup("click_bell")).model


def test_a_plugin_rings_the_bell(
    robotwin_root: Path, new_episode: Episodes, expert_actions: np.ndarray
) -> None:
    # Named relative to the root, which is where plug-ins expect to run.
    np.save(robotwin_root / "rows.npy", expert_actions)
    yml = "recording: ./rows.npy\ntask_name: null\nckpt_setting: best\nseed: 3\nchunk: 50\n"
    file = write_stub(robotwin_root, "StubRings", STUB, yml)
    setup = PolicySetup("click_bell", "phys_random", options={"chunk": "[6, 7]"})
    policy = open_robotwin(f"{file}?left=1e-3&note=a+b", setup)
    before = Path.cwd()
    for _ in range(2):
        episode = new_episode()
        policy.play(episode)
        assert episode.success
    assert Path.cwd() == before
    model: Any = policy.model
    assert {**model.args, "recording": ""} == {
        "task_name": "click_bell", "task_config": "phys_random", "policy_name": "StubRings",
        "ckpt_setting": "best", "seed": 3, "instruction_type": "unseen", "left_arm_dim": 6,
        "right_arm_dim": 6, "recording": "", "chunk": [6, 7], "left": 1e-3, "note": "a+b",
    }  # fmt: skip
    assert model.resets == 2
    assert (policy.env.test_num, policy.env.suc) == (2, 2)
    (pictures, vector, poses), instruction, count = model.seen[0]
    assert (instruction, count) == (episode.instruction, 0)
    assert [p[0, 0].tolist() for p in pictures] == [[s, 0, 255] for s in (10, 20, 30)]
    assert all(p.dtype == np.uint8 and p.shape == (240, 320, 3) for p in pictures)
    assert vector.dtype == np.float64 and vector.shape == (14,)
    assert len(poses) == 15 and all(type(x) is float for x in poses)


BODY = "def eval(e, m, o): pass\ndef reset_model(m): pass\n"
TELLS = "def get_model(args): return args\n" + BODY


def test_a_plugin_is_told_how_many_joints_each_arm_has(robotwin_root: Path) -> None:
    file = write_stub(robotwin_root, "StubTold", TELLS)
    setup = PolicySetup("click_bell", embodiment="piper,franka-panda,0.7", arm_joints=(6, 7))
    given = model_of(file, setup)
    assert (given["left_arm_dim"], given["right_arm_dim"]) == (6, 7)


SKIPPING = """
    class Model:
        seen = []
        def should_request_observation(self):
            return not len(self.seen) % 2
    def get_model(usr_args): return Model()
    def reset_model(model): pass
    def eval(TASK_ENV, model, observation):
        model.seen.append(observation)
        TASK_ENV.take_action(TASK_ENV.robot.get_left_arm_jointState() * 2)
        TASK_ENV.step_lim = 4
"""


@pytest.mark.parametrize("skip", [True, False])
def test_a_plugin_may_decline_observations(
    robotwin_root: Path, episode: PolicyEpisode, skip: bool
) -> None:
    file = write_stub(robotwin_root, f"StubSkips{skip}", SKIPPING)
    policy = open_robotwin(f"{file}?skip_get_obs_within_replan={skip}", PolicySetup("click_bell"))
    policy.play(episode)
    model: Any = policy.model
    assert [o is None for o in model.seen] == ([False, True] * 2 if skip else [False] * 4)


def test_a_folder_without_init_and_a_dotted_name(robotwin_root: Path) -> None:
    bare = write_stub(robotwin_root, "StubBare", TELLS, init=False)
    assert model_of(bare)["policy_name"] == "StubBare"
    deep = robotwin_root / "StubEvaluation" / "robotwin"
    deep.mkdir(parents=True)
    (deep / "interface.py").write_text(TELLS)
    dotted = f"{deep}/interface.py?policy_name=StubEvaluation.robotwin.interface&port=18093"
    given = model_of(dotted)
    assert given["policy_name"] == "StubEvaluation.robotwin.interface"
    assert given["port"] == 18093


def test_a_linked_folder_belongs_to_the_root_that_holds_the_link(
    robotwin_root: Path, tmp_path: Path
) -> None:
    elsewhere = tmp_path / "elsewhere" / "theirs"
    elsewhere.mkdir(parents=True)
    source = "import os\ndef get_model(a): return os.getcwd()\n" + BODY
    (elsewhere / "deploy_policy.py").write_text(source)
    link = robotwin_root / "policy" / "StubLinked"
    link.symlink_to(elsewhere)
    assert Path(model_of(link / "deploy_policy.py")) == robotwin_root


@pytest.mark.parametrize(
    ("name", "source", "problem"),
    [
        ("StubHalf", "def get_model(a): pass\n", "has no eval, reset_model"),
        ("StubBroken", "import no_such_module\n", "no_such_module"),
        ("StubBad", "def get_model(a): 1 / 0\n" + BODY, "get_model: ZeroDivisionError: division"),
        ("json", "def get_model(a): pass\n" + BODY, "rename the plug-in's folder"),
    ],
)
def test_what_is_wrong_with_a_plugin_is_said(
    robotwin_root: Path, name: str, source: str, problem: str
) -> None:
    file = write_stub(robotwin_root, name, source)
    with pytest.raises(RtphysError, match=problem):
        open_robotwin(str(file), PolicySetup())
    with pytest.raises(BadFile, match=r"policy_name 'a\.b' does not lead"):
        open_robotwin(f"{file}?policy_name=a.b", PolicySetup())
    with pytest.raises(BadFile, match="deploy_policy"):
        open_robotwin(str(robotwin_root / "nothing.py"), PolicySetup())


def test_a_plugin_that_does_not_act_is_stuck(robotwin_root: Path, episode: PolicyEpisode) -> None:
    lazy = write_stub(robotwin_root, "StubLazy", "def get_model(a): pass\n" + BODY)
    policy = open_robotwin(str(lazy), PolicySetup("click_bell"))
    policy.env.data_type["rgb"] = False
    with pytest.raises(RtphysError, match="without an action"):
        policy.play(episode)
