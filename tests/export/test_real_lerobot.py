"""What lerobot itself does with an export: read, train, split, delete, merge.

In an environment of its own, which `RTPHYS_LEROBOT_PYTHON` names: lerobot brings torch.
"""

import json
import os
import subprocess
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
import sensing

from rtphys.data.dataset import Dataset

pytest.importorskip("pyarrow", reason="the extra rtphys[lerobot] is not installed")

from rtphys.export.lerobot import ExportSpec, export_lerobot

PYTHON = Path(os.environ.get("RTPHYS_LEROBOT_PYTHON", ""))
EPISODES, FRAMES = 4, 40
SENSES = ("depth", "touch")
FEATURES = ("physics", "environment_state", "contact", "touch", "depth")
READ = """
import sys, numpy as np
from lerobot.datasets.lerobot_dataset import LeRobotDataset
name, out = sys.argv[1:]
data = LeRobotDataset(name, video_backend="pyav")
rows = [data[n] for n in range(len(data))]
stats = {f"stats/{k}": s["mean"] for k, s in data.meta.stats.items()}
np.savez(out, **stats, **{k: np.stack([np.asarray(r[k]) for r in rows]) for k in rows[0]})
"""
WEIGHTS = """
import sys
from safetensors.numpy import load_file
first, last = (load_file(f"{sys.argv[1]}/checkpoints/{n}/pretrained_model/model.safetensors")
               ["model.encoder_env_state_input_proj.weight"] for n in ("000001", "000003"))
print(first.shape[1], int((first != last).any(axis=0).sum()))
"""

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        not PYTHON.is_file(), reason="set RTPHYS_LEROBOT_PYTHON to a Python that has lerobot"
    ),
]


@pytest.fixture(scope="module")
def dataset(tmp_path_factory: pytest.TempPathFactory) -> Dataset:
    return sensing.collect(tmp_path_factory.mktemp("dataset"), EPISODES, FRAMES, SENSES)


@pytest.fixture(scope="module")
def home(dataset: Dataset, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """LeRobot's folder of datasets, with ours as `rtphys/four`."""
    folder = tmp_path_factory.mktemp("home")
    export_lerobot(dataset, folder / "rtphys/four", ExportSpec(features=FEATURES))
    return folder


def lerobot(home: Path, command: str, *options: str) -> str:
    kept = {k: v for k, v in os.environ.items() if not k.startswith("PYTHON")}
    more = {"HF_HUB_OFFLINE": "1", "HF_LEROBOT_HOME": str(home), "OMP_NUM_THREADS": "1"}
    whole = [str(PYTHON.parent / command), *options]
    done = subprocess.run(whole, capture_output=True, text=True, env=kept | more, cwd=home)
    # Its encoder's threads sometimes abort the interpreter when all is done and written.
    late = done.stderr.rstrip().endswith("terminate called without an active exception")
    assert done.returncode == 0 or late, done.stderr[-3000:]
    return done.stdout


def edit(home: Path, name: str, kind: str, *options: str) -> None:
    operation = f"--operation.type={kind}"
    lerobot(home, "lerobot-edit-dataset", f"--repo_id=rtphys/{name}", operation, *options)


def read(home: Path, name: str) -> dict[str, np.ndarray]:
    out = home / f"{name}.npz"
    lerobot(home, PYTHON.name, "-c", READ, f"rtphys/{name}", str(out))
    with np.load(out) as stored:
        return dict(stored)


def test_it_reads_every_feature(home: Path, dataset: Dataset) -> None:
    rows = read(home, "four")
    vectors = [e.frames.vector.astype(np.float32) for e in dataset]
    assert np.array_equal(rows["observation.state"], np.concatenate([v[:-1] for v in vectors]))
    assert np.array_equal(rows["action"], np.concatenate([v[1:] for v in vectors]))
    assert np.array_equal(rows["observation.physics"], rows["observation.environment_state"])
    normal = np.concatenate([e.senses.touch().normal[:-1] for e in dataset])
    assert np.array_equal(rows["observation.touch"].reshape(-1, 4, 4)[..., 0], normal)
    depth = np.stack([e.senses.depth("head_camera", t) for e in dataset for t in range(FRAMES - 1)])
    assert np.abs(rows["observation.images.cam_high_depth"][:, 0] - 1000 * depth).max() <= 0.5001
    truth = np.concatenate([e.images("head_camera")[:-1] for e in dataset]) / 255
    shown = rows["observation.images.cam_high"].transpose(0, 2, 3, 1)
    assert np.abs(shown - truth).mean() < 12 / 255
    assert set(rows["task"]) == {"ring the bell"}


def same(found: dict[str, np.ndarray], whole: dict[str, np.ndarray], order: Sequence[int]) -> None:
    """Those episodes in that order: every number, statistics, and pictures but for their codec."""
    rows = np.concatenate([np.flatnonzero(whole["episode_index"] == n) for n in order])
    assert set(found) == set(whole)
    for key, values in found.items():
        if key.startswith("observation.images") and key.endswith("_depth"):
            assert np.array_equal(values, whole[key][rows]), key
        elif key.startswith("observation.images"):
            assert np.abs(values - whole[key][rows]).mean(axis=(1, 2, 3)).max() < 0.05, key
        elif key.startswith("stats/"):
            feature = key.removeprefix("stats/")
            if feature.startswith(("observation.", "action")) and "images" not in feature:
                assert values == pytest.approx(found[feature].mean(axis=0), rel=1e-4, abs=1e-4), key
        elif key not in ("index", "episode_index"):
            assert np.array_equal(values, whole[key][rows]), key


def test_its_tools_lose_nothing(home: Path) -> None:
    """A rate of 50/3 Hz fails here: they show the pictures of other frames."""
    whole = read(home, "four")
    edit(home, "four", "split", "--operation.splits", json.dumps({"a": [0, 2], "b": [1, 3]}))
    same(read(home, "four_a"), whole, [0, 2])
    same(read(home, "four_b"), whole, [1, 3])
    fewer = ("--new_repo_id=rtphys/fewer", "--operation.episode_indices", "[0, 2]")
    edit(home, "four", "delete_episodes", *fewer)
    same(read(home, "fewer"), whole, [1, 3])
    both = "['rtphys/four_a', 'rtphys/four_b']"
    edit(home, "merged", "merge", "--new_repo_id=rtphys/merged", "--operation.repo_ids", both)
    same(read(home, "merged"), whole, [0, 2, 1, 3])


def test_it_trains_a_policy_on_the_physics(home: Path, dataset: Dataset) -> None:
    """Every attribute has weights in the trained network, and the varied ones have moved."""
    colours = ExportSpec(features=FEATURES[:-1])  # ACT takes no picture with one channel
    export_lerobot(dataset, home / "rtphys/colours", colours)
    modes = dict.fromkeys(("VISUAL", "STATE", "ENV", "ACTION"), "MEAN_STD")
    small = {"dim_model": 32, "n_heads": 2, "dim_feedforward": 32, "chunk_size": 4}
    policy = {"type": "act", "device": "cpu", "push_to_hub": "false", **small}
    policy |= {"n_action_steps": 4, "pretrained_backbone_weights": "null"}
    policy["normalization_mapping"] = json.dumps(modes)
    options = {f"policy.{key}": value for key, value in policy.items()}
    options |= {"dataset.repo_id": "rtphys/colours", "dataset.video_backend": "pyav"}
    options |= {"steps": 3, "save_freq": 1, "batch_size": 4, "num_workers": 0}
    options["output_dir"] = str(home / "trained")
    lerobot(home, "lerobot-train", *(f"--{key}={value}" for key, value in options.items()))
    numbers, moved = map(int, lerobot(home, PYTHON.name, "-c", WEIGHTS, "trained").split())
    assert numbers == 15, "13 attributes, and the centre of mass has three numbers"
    physics = [tuple(np.ravel(v.value)) for v in dataset[0].meta.attributes.values() if v.varied]
    assert moved >= sum(map(len, physics)) > 10
