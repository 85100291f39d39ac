"""Writes a root folder: small files that import rtphys, at the paths that launchers expect."""

import json
from collections.abc import Mapping
from keyword import iskeyword
from pathlib import Path

from rtphys.assets.embodiment import DEFAULT
from rtphys.assets.pack import Pack
from rtphys.core.errors import RtphysError
from rtphys.core.untrusted import dump_yaml, hidden
from rtphys.data import files
from rtphys.data.layout import embodiment_folder
from rtphys.plan.kinematics import check_robot
from rtphys.robotwin_root.base_task import OFFICIAL, PROTOCOL
from rtphys.spec.protocol import VisualRandomization, load_protocol, protocol_names
from rtphys.spec.recording import KINDS
from rtphys.task.spec import load_task, task_names

MARK = ".rtphys-root"  # marks a folder written by rtphys, which may be overwritten
EMPTY = ("policy", "eval_result", "data", "assets")
CONFIGS = ("task_config", "env_cfg/task_config")  # for older and newer launchers

OFF = ("third_view", "depth", "pointcloud", "observer", "mesh_segmentation", "actor_segmentation")

# Launchers replace the line `    test_num = 100` in this file, spaces and newline included.
EVALUATE = '''"""RoboTwin's evaluation entry point, on rtphys' worlds."""

import sys

sys.path.append("./")
sys.path.append("./policy")
sys.path.append("./description/utils")

from rtphys.robotwin_root.drive import evaluate, parse_args_and_config


def main(usr_args):
    test_num = 100
    return evaluate(usr_args, test_num)


if __name__ == "__main__":
    main(parse_args_and_config())
'''

GLOBALS = '''"""Where things are."""

import os

ROOT_PATH = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "")
ASSETS_PATH = os.path.join(ROOT_PATH, "assets/")
EMBODIMENTS_PATH = os.path.join(ASSETS_PATH, "embodiments/")
CONFIGS_PATH = os.path.join(ROOT_PATH, "task_config/")
SCRIPT_PATH = os.path.join(ROOT_PATH, "script/")
DESCRIPTION_PATH = os.path.join(ROOT_PATH, "description/")
'''

TEST_RENDER = '''"""RoboTwin draws a frame before it begins; rtphys asks `rtphys doctor`."""

from rtphys.doctor import check_renderer


class Sapien_TEST:
    def __init__(self):
        finding = check_renderer()
        if finding.status == "fail":
            raise SystemExit(f"{finding.detail}; cure: {finding.cure}")

    def cleanup(self):
        pass
'''

FILES: dict[str, str] = {
    "script/eval_policy.py": EVALUATE,
    "scripts/eval_policy.py": EVALUATE,
    "script/test_render.py": TEST_RENDER,
    "scripts/test_render.py": TEST_RENDER,
    "envs/__init__.py": "from ._GLOBAL_CONFIGS import *\nfrom .utils import *\n",
    "envs/_GLOBAL_CONFIGS.py": GLOBALS,
    "envs/_base_task.py": "from rtphys.robotwin_root import Base_Task\n",
    "envs/robot/__init__.py": "from .robot import Robot\n",
    "envs/robot/robot.py": "from rtphys.policies.robotwin_env import Robot\n",
    "envs/utils/__init__.py": (
        "from rtphys.robotwin_root import ArmTag, UnStableError, get_face_prod\n"
    ),
    "envs/utils/create_actor.py": "from rtphys.robotwin_root import UnStableError\n",
    "description/utils/generate_episode_instructions.py": (
        "from rtphys.robotwin_root.base_task import generate_episode_descriptions\n"
    ),
}

TASK = (
    "from ._base_task import Base_Task\nfrom .utils import *\n\n\n"
    "class {name}(Base_Task):\n    pass\n"
)


class NotOurs(RtphysError):
    """A folder holds other files and must not be overwritten."""


def write_root(folder: Path, pack: Pack) -> list[Path]:
    """Write or overwrite a root folder; `policy/` and `eval_result/` keep their content.

    It is new, empty, or written by this function, even if that was killed. Returns the files
    written, relative to it. Raises `NotOurs`: it is another folder.
    """
    mark = folder / MARK
    there = {*folder.iterdir()} if folder.is_dir() else set[Path]()
    if not mark.is_file() and there - {hidden(mark, files.TEMPORARY)}:
        raise NotOurs(f"{folder}: is not empty and was not written by rtphys; choose a new folder")
    # A launcher finds a task by the name of its class: one such as `my-task` or `import` has none.
    classes = [name for name in task_names() if name.isidentifier() and not iskeyword(name)]
    tasks = {f"envs/{name}.py": TASK.format(name=name) for name in classes}
    # The mark comes first: the next run completes what a killed one began.
    content = {MARK: "written by rtphys robotwin-root\n", **FILES, **tasks, **_configs(pack)}
    for name, text in content.items():
        files.make_folder((folder / name).parent)
        files.replace_file(folder / name, text.encode())
    for name in EMPTY:
        files.make_folder(folder / name)
    return [Path(name) for name in content]


def _configs(pack: Pack) -> dict[str, str]:
    """Text of the configurations, by their path."""
    shared: dict[str, Mapping[str, object]] = {
        "_eval_step_limit": {name: load_task(name).step_limit for name in task_names()},
        "_camera_config": {
            kind: {"fovy": fovy, "w": width, "h": height}
            for kind, (width, height, fovy) in KINDS.items()
        },
        "_embodiment_config": {
            name: {"file_path": f"{pack.embodiment_folder(name)}/"} for name in pack.embodiments
        },
        **{name: _config(OFFICIAL.get(name, name)) for name in (*protocol_names(), *OFFICIAL)},
    }
    found = {f"{place}/{name}": one for place in CONFIGS for name, one in shared.items()}
    found["env_cfg/sim/sim_config_multi"] = {"dt": 0.004, "decimation": 1, "scene": {"num_envs": 1}}
    numbers: dict[str, object] = {}
    for name in pack.embodiments:  # what XPolicyLab's servers read of a robot
        try:
            arms = check_robot(pack, name).action_layout.per_arm
        except RtphysError:  # no episode can use it, such as official ones whose hand is not known
            continue
        robot = embodiment_folder(name)
        parts = {"sim": "sim_config_multi", "scene": "datagen", "robot": robot, "camera": robot}
        about = {"config_name": robot, "config": parts, "observation": {"collect_freq": 15}}
        found[f"env_cfg/{robot}"] = about
        numbers[robot] = {"arm_dim": list(arms), "ee_dim": [1, 1]}
    return {
        **{f"{path}.yml": dump_yaml(content) for path, content in found.items()},
        "env_cfg/robot/_robot_info.json": json.dumps(numbers, indent=2) + "\n",
    }


def _config(protocol: str) -> dict[str, object]:
    """Task configuration with every key that launchers read; rtphys uses only `rtphys_protocol`."""
    look = load_protocol(protocol).visual or VisualRandomization()
    return {
        PROTOCOL: protocol,
        "render_freq": 0,
        "episode_num": 100,
        "use_seed": False,
        "save_freq": 15,
        "embodiment": [DEFAULT],
        "language_num": 100,
        "eval_instruction": "unseen",
        "domain_randomization": {
            "random_background": look.textures,
            "cluttered_table": look.clutter > 0,
            "clean_background_rate": look.clean_background_rate,
            "random_head_camera_dis": 0,
            "random_table_height": look.table_drop,
            "random_light": look.light_colours,
            "crazy_random_light_rate": look.flicker_rate,
        },
        "camera": {
            "head_camera_type": "D435",
            "wrist_camera_type": "D435",
            "collect_head_camera": True,
            "collect_wrist_camera": True,
        },
        "data_type": {"rgb": True, "endpose": True, "qpos": True, **dict.fromkeys(OFF, False)},
        "pcd_down_sample_num": 1024,
        "pcd_crop": True,
        "save_path": "./data",
        "clear_cache_freq": 5,
        "collect_data": True,
        "eval_video_log": False,
    }
