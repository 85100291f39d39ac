"""A root's files do for launchers what RoboTwin's own would."""

import json
import os
import shutil
import subprocess
import sys
import textwrap
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from evaluations import FINGERPRINT, instances

import rtphys
from rtphys.assets.pack import default_pack
from rtphys.core.errors import BadValue, Infeasible, RtphysError, UnknownName
from rtphys.core.library import bundled, read_yaml
from rtphys.data import files
from rtphys.policies.robotwin_plugin import user_args
from rtphys.robotwin_root import (
    ArmTag,
    Base_Task,
    UnStableError,
    base_task,
    drive,
    get_face_prod,
    write_root,
)
from rtphys.robotwin_root.base_task import generate_episode_descriptions
from rtphys.robotwin_root.drive import Run, evaluate, pairs, parse_args_and_config
from rtphys.robotwin_root.write import NotOurs
from rtphys.task.spec import load_task, task_names

pytestmark = pytest.mark.sim

SOURCE = str(Path(rtphys.__file__).parents[1])
REPLAY = """
    import numpy as np

    usr = {}

    def get_model(usr_args):
        print("usr_args", usr_args["note"], usr_args["port"] + 1)
        usr.update(usr_args)
        return {"rows": np.load(usr_args["recording"]), "played": 0}

    def reset_model(model):
        model["played"] += 1

    def eval(TASK_ENV, model, observation):
        assert observation["joint_action"]["vector"].shape == (14,)
        if model["played"] == usr.get("raises"):
            raise RuntimeError("the server is gone")
        for action in model["rows"]:
            TASK_ENV.take_action(action)
        TASK_ENV.step_lim = TASK_ENV.take_action_cnt
"""


class click_bell(Base_Task):
    """As a root's `envs/click_bell.py` has it."""


@pytest.fixture
def root(tmp_path: Path) -> Path:
    write_root(tmp_path, default_pack())
    return tmp_path


def test_everything_is_where_launchers_look(root: Path) -> None:
    for name in ("script", "scripts"):
        text = (root / name / "eval_policy.py").read_text()
        assert text.count("    test_num = 100\n") == 1
    assert {p.stem for p in (root / "envs").glob("[a-z]*.py")} == set(task_names())
    for place in ("task_config", "env_cfg/task_config"):
        limits = read_yaml(root / place / "_eval_step_limit.yml")
        assert limits == {name: load_task(name).step_limit for name in task_names()}
        for config in ("demo_clean", "demo_randomized", "phys_random", "phys_random_all"):
            args: Any = read_yaml(root / place / f"{config}.yml")
            assert args["data_type"]["rgb"] is True
            assert "random_head_camera_dis" in args["domain_randomization"]
    embodiments: Any = read_yaml(root / "task_config" / "_embodiment_config.yml")
    assert Path(embodiments["aloha-agilex"]["file_path"], "config.yml").is_file()


def test_a_launcher_that_greps_finds_every_task(root: Path) -> None:
    """FACT's sweep over all tasks; a file in JSON would be YAML too, and it would find none."""
    for place in ("task_config", "env_cfg/task_config"):
        file = root / place / "_eval_step_limit.yml"
        grep = ["grep", "-oE", "^[a-z0-9_]+:", file]
        found = subprocess.run(grep, capture_output=True, text=True)
        assert {line.rstrip(":") for line in found.stdout.split()} == set(task_names())
    written = [*root.rglob("*.yml")]
    assert len(written) > 20
    flow = subprocess.run(["grep", "-lE", '[{}]|^ *"', *written], capture_output=True, text=True)
    assert flow.stdout == ""


def test_the_files_that_xpolicylab_reads_name_the_robot(root: Path) -> None:
    config: Any = read_yaml(root / "env_cfg" / "aloha_agilex.yml")
    assert read_yaml(root / "env_cfg" / "sim" / f"{config['config']['sim']}.yml")["dt"] == 0.004
    robots = json.loads((root / "env_cfg" / "robot" / "_robot_info.json").read_text())
    assert robots[config["config"]["robot"]] == {"arm_dim": [6, 6], "ee_dim": [1, 1]}
    assert robots["franka_panda"]["arm_dim"] == [7, 7]


def test_a_robot_that_no_episode_can_use_is_left_out(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """RoboTwin's pack has some: their configs lack `hand`."""
    mine = tmp_path / "lab" / "robots" / "ur5"
    shutil.copytree(default_pack().embodiment_folder("piper"), mine)
    monkeypatch.setenv("RTPHYS_LIBRARY", str(tmp_path / "lab"))
    write_root(tmp_path / "root", default_pack())
    robots = json.loads((tmp_path / "root/env_cfg/robot/_robot_info.json").read_text())
    assert sorted(robots) == ["aloha_agilex", "franka_panda", "piper"]
    assert not (tmp_path / "root/env_cfg/ur5.yml").exists()


def test_what_newer_drivers_import_is_there(root: Path) -> None:
    code = """
        from envs.robot.robot import Robot
        from envs.utils import ArmTag, get_face_prod
        from envs.utils.create_actor import UnStableError
        import envs.open_laptop as module, envs
        Robot.set_planner = lambda self, scene=None: None
        assert module.ArmTag is ArmTag and module.get_face_prod is get_face_prod
        assert issubclass(module.open_laptop, envs._base_task.Base_Task)
    """
    environment = {**os.environ, "PYTHONPATH": f"{SOURCE}:{root}"}
    run = [sys.executable, "-c", textwrap.dedent(code)]
    subprocess.run(run, cwd=root, env=environment, check=True)


def test_arms_and_axes() -> None:
    assert ArmTag("left") == "left" and ArmTag("left").opposite == "right"
    with pytest.raises(ValueError, match="neither"):
        ArmTag("both")
    quarter = [0.5**0.5, 0, 0, 0.5**0.5]  # about z
    assert get_face_prod(quarter, [1, 0, 0], [0, 1, 0]) == pytest.approx(1)
    assert get_face_prod(quarter, [1, 0, 0], [1, 0, 0]) == pytest.approx(0)


class blocks_ranking_size(Base_Task): ...


class open_laptop(Base_Task): ...


class place_object_scale(Base_Task): ...


LISTED = (100_000, 100_002)  # the seed between them is infeasible
BLIND: dict[str, Any] = {"task_config": "demo_clean", "data_type": {"rgb": False}}  # draws nothing


def test_objects_of_the_scene_have_poses_under_robotwins_names() -> None:
    """LeRobot's own environment asks for the three blocks, vla-eval for the laptop and `object`."""
    env = blocks_ranking_size()
    assert not hasattr(env, "block1"), "no episode yet"
    env.setup_demo(seed=0, **BLIND)
    objects = env.episode.rollout.world.objects
    for name, ours in (("block1", "large"), ("block2", "medium"), ("block3", "small")):
        np.testing.assert_array_equal(getattr(env, name).get_pose().p, objects[ours].pose.p)
    assert not hasattr(env, "block4")
    other = open_laptop()
    other.setup_demo(seed=0, **BLIND)
    assert other.laptop.get_pose().p[2] > 0.7
    scale = place_object_scale()
    scale.setup_demo(seed=0, **BLIND)
    assert scale.object.get_pose().p[2] > 0.7


def test_a_driver_may_make_up_what_a_sentence_says() -> None:
    info = {"{A}": "red block", "{B}": "green block", "{C}": "blue block"}
    arms = {"{a}": "left", "{b}": "right", "{c}": "right"}
    (said,) = generate_episode_descriptions("blocks_ranking_rgb", [info | arms], 1000)
    line_up = "Line up the red block, the green block and the blue block from left to right."
    assert line_up in said["seen"]
    assert any("the left arm" in line for line in said["seen"]) and said["unseen"]
    bell = {"{A}": "050_bell/base0", "{a}": "left"}
    (said,) = generate_episode_descriptions("click_bell", [bell])
    assert "Ring the bell." in said["seen"]


def test_a_root_can_be_written_again_and_others_are_left_alone(root: Path, tmp_path: Path) -> None:
    (root / "policy" / "mine").mkdir()
    write_root(root, default_pack())
    assert (root / "policy" / "mine").is_dir()
    other = tmp_path / "other"
    other.mkdir()
    (other / "thesis.tex").write_text("")
    with pytest.raises(NotOurs, match="choose a new folder"):
        write_root(other, default_pack())


def test_a_task_whose_name_no_class_can_have_is_left_out(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    tasks = tmp_path / "library" / "tasks"
    tasks.mkdir(parents=True)
    for name in ("my-task", "import"):
        shutil.copy(bundled() / "tasks" / "click_bell.py", tasks / f"{name}.py")
    monkeypatch.setenv("RTPHYS_LIBRARY", str(tasks.parent))
    files = {path.name for path in write_root(tmp_path / "root", default_pack())}
    assert "my-task" in task_names()
    assert "click_bell.py" in files and not files & {"my-task.py", "import.py"}


@pytest.mark.parametrize("written", [0, 1, 7])
def test_a_root_that_was_cut_off_is_completed(
    written: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Killed after so many files; the next one has begun, under its temporary name."""
    move, left = files.move, iter(range(written))

    def killed(source: Path, target: Path) -> None:
        if next(left, None) is None:
            os._exit(9)
        move(source, target)

    child = os.fork()
    if not child:
        monkeypatch.setattr(files, "move", killed)
        try:
            write_root(tmp_path / "root", default_pack())
        finally:
            os._exit(0)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 9
    expected = write_root(tmp_path / "root", default_pack())
    assert all((tmp_path / "root" / name).is_file() for name in expected)
    assert not [*(tmp_path / "root").rglob("*.part")]


def test_a_configuration_names_the_robot() -> None:
    env = click_bell()
    for named, numbers in (["franka-panda"], 16), (["piper", "franka-panda", 0.7], 15):
        env.setup_demo(seed=0, embodiment=named, **BLIND)
        seen: Any = env.get_obs()["joint_action"]
        assert seen["vector"].shape == (numbers,)
        assert len(seen["right_arm"]) == 7
        env.take_action(seen["vector"])
        assert env.take_action_cnt == 1
        with pytest.raises(BadValue, match=f"it is {numbers} finite numbers"):
            env.take_action(np.zeros(14))


def test_a_driver_of_ones_own(expert_actions: np.ndarray) -> None:
    """The order in which RoboTwin's evaluation and its descendants call."""
    env = click_bell()
    assert (env.suc, env.test_num, env.take_action_cnt) == (0, 0, 0)
    args = {**BLIND, "render_freq": 0, "eval_mode": True}
    env.setup_demo(now_ep_num=0, seed=0, is_test=True, **args)
    told = env.play_once()
    env.close_env()
    assert env.plan_success and env.check_success()
    env.setup_demo(now_ep_num=0, seed=0, is_test=True, **args)
    assert not env.check_success()
    info: Any = told["info"]
    (said,) = generate_episode_descriptions("click_bell", [info], 3)
    sentences: Any = said["unseen"]
    assert len(sentences) <= 3
    env.set_instruction(instruction=sentences[0])
    assert env.get_instruction() == sentences[0]
    assert env.eval_video_path is None
    while env.take_action_cnt < env.step_lim and not env.eval_success:
        assert env.get_obs()["observation"] == {}
        env.take_action(expert_actions[env.take_action_cnt])
    assert env.check_success()
    env.close_env(clear_cache=True)
    with pytest.raises(RuntimeError, match="setup_demo"):
        env.play_once()


def test_methods_may_be_replaced_on_the_class(monkeypatch: pytest.MonkeyPatch) -> None:
    looks = []
    monkeypatch.setattr(Base_Task, "_update_render", lambda self: looks.append(1))
    env = click_bell()
    env.setup_demo(seed=0, **BLIND)
    env.get_obs()
    assert len(looks) == 1


def test_an_adapter_learns_the_seed_from_what_setup_demo_calls(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """FACT's adapter replaces RoboTwin's `_init_task_env_` and reads `seed` from its keywords."""
    original = Base_Task._init_task_env_  # pyright: ignore[reportPrivateUsage]

    def with_seed(self: Any, *args: Any, **kwargs: Any) -> None:
        self.current_seed = kwargs["seed"]
        original(self, *args, **kwargs)

    monkeypatch.setattr(Base_Task, "_init_task_env_", with_seed)
    env: Any = click_bell()
    env.setup_demo(seed=3, **BLIND)
    assert env.current_seed == env.episode.seed == 3


def test_what_is_wrong_is_said() -> None:
    env = click_bell()
    with pytest.raises(UnknownName, match="demo_clean"):
        env.setup_demo(seed=0, task_config="demo_cleen")
    with pytest.raises(BadValue, match=r"placeholders of click_bell are \{A\}, \{a\}"):
        generate_episode_descriptions("click_bell", [{"{B}": "050_bell/base0"}])
    with pytest.raises(SystemExit):
        parse_args_and_config(["--overrides", "--task_name", "click_bell"])


def test_a_world_that_never_rests_is_unstable(monkeypatch: pytest.MonkeyPatch) -> None:
    def never(*_: object) -> None:
        raise Infeasible("unsettled", "the bell still moved after 3 s")

    monkeypatch.setattr(base_task, "begin", never)
    with pytest.raises(UnStableError, match="bell still moved"):
        click_bell().setup_demo(seed=0, task_config="clean")


def test_as_many_episodes_are_played_as_a_launcher_counts_on(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """It multiplies the rate by that number; behind the list the expert searches on."""
    monkeypatch.setattr(drive, "read_list", lambda *_: instances("click_bell", "clean", *LISTED))
    monkeypatch.setattr(drive, "fingerprint_of", lambda *_: FINGERPRINT)
    env, solves = click_bell(), [True]
    for name in ("setup_demo", "play_once"):
        monkeypatch.setattr(env, name, lambda *_, **__: None)
    monkeypatch.setattr(env, "check_success", lambda: solves[0])
    plugin: Any = None
    run = Run({"seed": 0}, {"task_config": "clean"}, env, plugin, None)
    seeds = run.seeds()
    assert [next(seeds) for _ in range(3)] == [*LISTED, LISTED[-1] + 1]
    assert run.tried == 4
    solves[0] = False
    with pytest.raises(RtphysError, match="solves none of the 200 seeds up to 100203"):
        next(seeds)


def test_a_list_of_another_robot_or_pack_is_not_run(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The expert has not solved these seeds: it searches, as for any other protocol."""
    env, plugin, demonstrated = click_bell(), None, list[bool]()
    monkeypatch.setattr(env, "setup_demo", lambda *_, **__: None)
    monkeypatch.setattr(env, "play_once", lambda: demonstrated.append(True))
    monkeypatch.setattr(env, "check_success", lambda: True)
    args: dict[str, Any] = {"task_config": "clean", "embodiment": ["franka-panda"]}
    run = Run({"seed": 0}, args, env, plugin, None)  # type: ignore[arg-type]
    seeds = run.seeds()
    assert [next(seeds) for _ in range(3)] == [100_000, 100_001, 100_002]
    assert len(demonstrated) == run.tried == 3
    assert "embodiment was 'aloha-agilex', now 'franka-panda'" in capsys.readouterr().out


def launched(root: Path, actions: np.ndarray, more: str = "") -> subprocess.CompletedProcess[str]:
    """A launcher's run: patches the number of episodes as text, runs the sibling script."""
    np.save(root / "rows.npy", actions)
    policy = root / "policy" / "StubReplays"
    policy.mkdir()
    (policy / "__init__.py").write_text("from .deploy_policy import *\n")
    (policy / "deploy_policy.py").write_text(textwrap.dedent(REPLAY))
    config = policy / "deploy_policy.yml"
    config.write_text("task_name: null\nrecording: ./rows.npy\nnote: null\nport: null\n")
    for place in ("task_config", "env_cfg/task_config"):  # nothing to draw
        file = root / place / "phys_random.yml"
        file.write_text(file.read_text().replace("rgb: true", "rgb: false"))
    script = (root / "script" / "eval_policy.py").read_text()
    patched = root / "script" / "eval_policy_two.py"
    patched.write_text(script.replace("    test_num = 100\n", "    test_num = 2\n"))
    overrides = "--task_name click_bell --task_config phys_random --ckpt_setting /best --seed 7"
    overrides += f" --policy_name StubReplays --port 18093 --note a.b {more}"
    run = [sys.executable, patched, "--config", config, "--overrides", *overrides.split()]
    environment = {**os.environ, "PYTHONPATH": SOURCE}
    return subprocess.run(run, cwd=root, env=environment, capture_output=True, text=True)


@pytest.mark.slow
def test_a_launchers_run(root: Path, expert_actions: np.ndarray) -> None:
    """The rate is successes over episodes, in the newest result of either place."""
    done = launched(root, expert_actions, "--eval_output_dir own/place")
    assert done.returncode == 0, done.stderr
    assert "usr_args a.b 18094" in done.stdout
    found = [*(root / "eval_result" / "click_bell" / "StubReplays").rglob("_result*.txt")]
    assert {path.name for path in found} == {"_result.txt", "_result_random.txt"}
    assert len({path.parent for path in found}) == 1
    assert "phys_random/best" in str(found[0])
    texts = {path.read_text() for path in (*found, root / "own/place/_result.txt")}
    assert len(texts) == 1
    successes = round(2 * float(texts.pop().splitlines()[-1]))
    assert f"Success rate: {successes}/2" in done.stdout
    counts = json.loads((found[0].parent / "rtphys_counts.json").read_text())
    assert counts["tried"] >= counts["rollouts"] == 2 and counts["successes"] == successes


@pytest.mark.slow
def test_a_policy_that_raises_ends_a_launchers_run(root: Path, expert_actions: np.ndarray) -> None:
    """A dead server is no policy that never succeeds; RoboTwin's own script does not go on."""
    done = launched(root, expert_actions, "--raises 2")
    assert done.returncode != 0 and "the server is gone" in done.stderr
    assert not [*root.rglob("_result*.txt")]


@pytest.mark.parametrize("kind", ["seen", "unseen"])
def test_textures_are_unseen_whatever_the_sentences_are(
    root: Path, monkeypatch: pytest.MonkeyPatch, kind: str
) -> None:
    """As RoboTwin's: its evaluation draws training textures in no case."""
    began: list[tuple[str, str]] = []

    class Stub:
        name = "stub"

        def play(self, model: object, env: Base_Task, skip: bool) -> None:
            began.append((env.episode.recipe.spec.split, env.get_instruction()))

    env = click_bell()
    env.data_type["rgb"] = False
    usr_args = {"instruction_type": kind, "task_config": "demo_randomized"}
    args: dict[str, object] = {**BLIND, "task_config": "demo_randomized"}
    Run(usr_args, args, env, Stub(), None).roll_out(3)  # type: ignore[arg-type]
    (said,) = generate_episode_descriptions("click_bell", [{"rtphys_seed": 3}], 1)
    assert began == [("unseen", said[kind][0])]
    with pytest.raises(UnknownName, match="instruction type"):
        evaluate({**usr_args, "instruction_type": "sen"}, 1)
    for missing in ("task_name", "policy_name"):
        named = {"task_name": "click_bell", "policy_name": "P", missing: None}
        with pytest.raises(BadValue, match=f"{missing}.*--overrides --{missing} NAME"):
            evaluate({**usr_args, **named}, 1)


class Asked(Exception):
    """Ends a run once its model is asked for."""


def test_a_model_is_told_how_many_joints_the_robot_has(
    root: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of the configuration's robot, as RoboTwin tells it."""
    config = root / "task_config" / "clean.yml"
    text = config.read_text()
    config.write_text(text.replace("- aloha-agilex", "- piper\n- franka-panda\n- 0.7"))
    sizes = list[object]()

    def get_model(usr_args: dict[str, object]) -> None:
        sizes.extend(usr_args[key] for key in ("left_arm_dim", "right_arm_dim"))
        raise Asked

    stub = SimpleNamespace(get_model=get_model)
    monkeypatch.setattr(drive, "plugin_named", lambda *_: stub)
    monkeypatch.setattr(drive.importlib, "import_module", lambda _: sys.modules[__name__])
    monkeypatch.chdir(root)
    usr_args = {"instruction_type": "seen", "task_name": "click_bell", "task_config": "clean"}
    with pytest.raises(Asked):
        evaluate({**usr_args, "policy_name": "asks"}, 1)
    assert sizes == [6, 7]


def test_overrides_are_literals_or_text() -> None:
    words = ["--port", "18093", "--name", "a.b", "--list", "[1, 2]", "--evil", "__import__('os')"]
    given = {"port": 18093, "name": "a.b", "list": [1, 2], "evil": "__import__('os')"}
    assert pairs(words) == given
    assert user_args(None, {"seed": 0}, {"seed": 5})["seed"] == 5
