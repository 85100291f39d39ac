"""Probes are tasks in a library of their own: never among the fifty, and the expert solves them."""

from pathlib import Path

import pytest

from rtphys.assets.pack import default_pack
from rtphys.core import library
from rtphys.episode.generate import attempt
from rtphys.spec.episode import EpisodeSpec
from rtphys.task.spec import load_task, task_names

FOLDER = library.bundled() / "probes"
NAMES = sorted(p.stem for p in (FOLDER / "tasks").glob("*.py") if not p.stem.startswith("_"))


@pytest.fixture
def probes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("RTPHYS_LIBRARY", str(FOLDER))


def test_there_are_probes_and_none_is_among_the_tasks(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("RTPHYS_LIBRARY", raising=False)
    assert {"heft", "push", "tap", "shake", "tilt", "swing"} <= {*NAMES}
    assert not {*NAMES} & {*task_names()}
    assert not [name for name in library.matching("tasks", ["*"]) if name in NAMES]


@pytest.mark.usefixtures("probes")
@pytest.mark.parametrize("name", NAMES)
def test_a_probe_is_an_ordinary_task(name: str) -> None:
    task = load_task(name)
    assert task.doc.partition("\n\n")[2].startswith("Success: ")
    assert task.mechanism == "probe"
    first = [prop.pose.p.tolist() for prop in task.props(0)]
    assert first == [prop.pose.p.tolist() for prop in task.props(0)]
    assert first != [prop.pose.p.tolist() for prop in task.props(1)]


@pytest.mark.sim
@pytest.mark.slow
@pytest.mark.usefixtures("probes")
@pytest.mark.parametrize("name", NAMES)
def test_the_expert_solves_a_probe(name: str) -> None:
    task, pack = load_task(name), default_pack()
    tried = [attempt(EpisodeSpec(name, "clean").at(seed), task, pack) for seed in range(5)]
    assert [one.reason for one in tried] == [""] * 5


@pytest.mark.sim
@pytest.mark.slow
@pytest.mark.usefixtures("probes")
def test_heft_tells_mass_and_the_same_file_comes_of_two_workers(tmp_path: Path) -> None:
    """A few episodes through real workers: the whole way from a seed to a score."""
    from rtphys.analysis.features import sense
    from rtphys.analysis.identify import IdentifyPlan, judge

    (file := tmp_path / "nearest.py").write_text(NEAREST)
    written = []
    for workers in (1, 2):
        out, estimator = tmp_path / str(workers), f"python:{file}:Force"
        plan = IdentifyPlan(("heft",), episodes=20, out=out, estimator=estimator, workers=workers)
        sense(plan, default_pack())
        result = judge(plan)
        written.append((out / "Force.json").read_bytes())
    assert written[0] == written[1]
    assert result.tasks["heft"].scores["object_mass"].importance["effort"] > 0


NEAREST = """
import numpy as np
class Force:
    "Regression on the column that goes best with the labels."
    def fit(self, X, y):
        c = np.array([abs(np.corrcoef(x, y)[0, 1]) for x in X.T])
        self.k = int(np.nanargmax(c))
        self.w = np.polyfit(X[:, self.k], y, 1)
    def predict(self, X):
        return np.polyval(self.w, X[:, self.k])
"""
