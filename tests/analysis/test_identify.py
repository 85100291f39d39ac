"""`identify` from plan to result, without a simulator: the same file whoever did the work."""

import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from quick_pool import J, QuickPool, R

from pages import ran
from rtphys.analysis import features, identify
from rtphys.analysis.features import FeaturesSpec, TaskEpisodes, sense
from rtphys.analysis.identify import (
    IdentifyPlan,
    Result,
    ScoringTask,
    TaskResult,
    range_of,
    read_result,
    read_samples,
    write_result,
)
from rtphys.analysis.scoring import STATISTICS, Beyond, Sample, Score, Table, score
from rtphys.assets.pack import default_pack
from rtphys.campaign import local
from rtphys.campaign.pool import WorkerFailure
from rtphys.campaign.series import FRUITLESS, Listener
from rtphys.core.errors import BadFile, BadValue, UnknownName
from rtphys.core.seeds import stream
from rtphys.data.faults import DatasetMismatch
from rtphys.spec.episode import EpisodeSpec, Recipe

TASKS = ("click_bell", "lift_pot")
ESTIMATORS = """
import numpy as np

class Line:
    def fit(self, X, y):
        self.w = np.linalg.lstsq(np.column_stack([X, np.ones(len(X))]), y, rcond=None)[0]
    def predict(self, X):
        return np.column_stack([X, np.ones(len(X))]) @ self.w

class Moody(Line):
    "Raises on labels of friction, which are below 1.25, and forgets numbers of table heights."
    def fit(self, X, y):
        if 0.9 < y.max() < 1.25:
            raise RuntimeError("no friction in caf\\udce9")
        super().fit(X, y)
        self.w = self.w * np.nan if y.max() <= 0 else self.w

class Leaving(Moody):
    "Ends as a script does."
    def fit(self, X, y):
        try:
            super().fit(X, y)
        except RuntimeError:
            raise SystemExit("no licence")
"""


def sensed(recipe: Recipe) -> Sample:
    """Every seventh seed fails; else two signals tell mass and friction, nothing the height."""
    if recipe.seed % 7 == 3:
        return Sample(recipe.seed, reason="slipped")
    rng = stream(recipe.seed, recipe.task)
    mass, friction, height, noise = rng.uniform((0.125, 0.01, -0.08, 0), (4, 1.25, 0, 1))
    values: dict[str, float | list[float]] = {"lift/duration": float(noise)}
    for name, value in (("force_z", mass), ("force_x", friction)):
        values[f"lift/hand/effort/{name}"] = [float(value)] * len(STATISTICS)
    labels = {"object_mass": mass, "friction": friction, "table_height": height}
    return Sample(recipe.seed, values, {key: float(value) for key, value in labels.items()})


def plan(out: Path, estimator: str = "Line", episodes: int = 30, workers: int = 1) -> IdentifyPlan:
    file = out.parent / "estimators.py"
    file.write_text(ESTIMATORS)
    spec = f"python:{file}:{estimator}"
    return IdentifyPlan(TASKS, episodes=episodes, out=out, estimator=spec, workers=workers)


class Impatient(Listener):
    """Interrupts the run after some ticks."""

    def __init__(self, ticks: int) -> None:
        self.left = ticks

    def ticked(self) -> None:
        self.left -= 1
        if not self.left:
            raise KeyboardInterrupt


class DyingPool(QuickPool[J, R]):
    """Loses the worker that scores mass in the second task."""

    def loss(self, job: J) -> str:
        dies = isinstance(job, ScoringTask) and job.key == "object_mass"
        return "worker_crash" if dies and TASKS[1] in job.features.name else ""


@pytest.fixture(autouse=True)
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(features, "SenseWorker", lambda pack: lambda: sensed)
    monkeypatch.setattr(local, "LocalPool", QuickPool)


def made(wanted: IdentifyPlan) -> Result:
    sense(wanted, default_pack())
    return identify.judge(wanted)


def test_what_the_signals_tell_is_found_and_what_they_do_not_is_not(tmp_path: Path) -> None:
    result = made(plan(tmp_path / "out"))
    for task in TASKS:
        found = result.tasks[task]
        assert found.scores["object_mass"].r2 > 0.99
        assert found.scores["friction"].r2 > 0.99
        assert found.scores["table_height"].r2 < 0.2
        assert found.scores["object_mass"].importance["effort"] > 0.5
        assert found.scores["object_mass"].shuffled <= 0.02
        assert (found.episodes, found.attempts) == (30, 35)
        assert found.left_out["arm_joint_damping"] == "does not act"
    assert read_result(tmp_path / "out" / "Line.json").tasks.keys() == {*TASKS}


@pytest.mark.processes
def test_the_file_is_the_same_for_any_number_of_workers_and_after_interruptions(
    tmp_path: Path,
) -> None:
    made(plan(tmp_path / "one"))
    broken = plan(tmp_path / "two", workers=7)
    for ticks in (5, 20):
        with pytest.raises(KeyboardInterrupt):
            sense(broken, default_pack(), Impatient(ticks))
    sense(broken, default_pack())
    with pytest.raises(KeyboardInterrupt):
        identify.judge(broken, Impatient(3))
    identify.judge(broken)
    for name in ("Line.json", f"features/{TASKS[0]}.jsonl", f"features/{TASKS[1]}.jsonl"):
        assert (tmp_path / "one" / name).read_bytes() == (tmp_path / "two" / name).read_bytes()


def test_what_is_known_is_not_scored_again_and_another_estimator_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    wanted = plan(tmp_path / "out")
    first = made(wanted)

    def refuse(*_: object) -> None:
        raise AssertionError("scored again")

    with monkeypatch.context() as scoped:
        scoped.setattr("rtphys.analysis.identify.score", refuse)
        assert identify.judge(wanted) == first
    file, factor = tmp_path / "estimators.py", "return 0 * np.column_stack"
    file.write_text(file.read_text().replace("return np.column_stack", factor))
    assert identify.judge(wanted).tasks[TASKS[0]].scores["object_mass"].r2 < 0.1


def test_an_estimator_that_raises_or_forgets_numbers_is_named_and_the_rest_goes_on(
    tmp_path: Path,
) -> None:
    result = made(plan(tmp_path / "out", "Moody"))
    for task in TASKS:
        found = result.tasks[task]
        assert found.failed["friction"] == r"RuntimeError: no friction in caf\udce9"
        assert "not finite" in found.failed["table_height"]
        assert found.scores["object_mass"].r2 > 0.99
    for found in made(plan(tmp_path / "out", "Leaving")).tasks.values():
        assert found.failed["friction"] == "SystemExit: no licence"
        assert found.scores["object_mass"].r2 > 0.99


def test_scores_are_of_the_features_that_are_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Features that were made anew may be of the same seeds, after an edit of a task."""
    wanted = plan(tmp_path / "out")
    assert made(wanted).tasks[TASKS[0]].scores["friction"].r2 > 0.99

    def numb(recipe: Recipe) -> Sample:
        sample = sensed(recipe)
        return replace(sample, features={k: 0.0 for k in sample.features if "/" not in k[5:]})

    monkeypatch.setattr(features, "SenseWorker", lambda pack: lambda: numb)
    for task in TASKS:
        wanted.features_file(task).unlink()
    assert made(wanted).tasks[TASKS[0]].scores["friction"].r2 < 0.1


def test_what_failed_is_tried_again_and_nothing_else(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """After a longer `--timeout`, or once a package that it imports is there."""
    with monkeypatch.context() as scoped:
        scoped.setattr(local, "LocalPool", DyingPool)
        tasks = made(plan(tmp_path / "out")).tasks
    assert "worker_crash" in tasks[TASKS[1]].failed["object_mass"]
    assert "friction" in tasks[TASKS[1]].scores and "object_mass" in tasks[TASKS[0]].scores
    tried = list[str]()

    def noted(table: Table, key: str, *more: Any) -> Score:
        tried.append(key)
        return score(table, key, *more)

    monkeypatch.setattr("rtphys.analysis.identify.score", noted)
    result = made(plan(tmp_path / "out")).tasks[TASKS[1]]
    assert tried == ["object_mass"] and result.failed == {}
    assert [*result.scores] == [*made(plan(tmp_path / "new")).tasks[TASKS[1]].scores]


def test_ranges_are_those_of_the_domain(tmp_path: Path) -> None:
    domain = plan(tmp_path / "out").specs()[0].domain
    assert range_of(domain, "object_mass") == (0.125, 4)
    assert range_of(domain, "camera_distance") == (0, 0.1)
    assert range_of(domain, "gripper_joint_damping") == (0.5, 3)


def test_a_plan_that_cannot_be_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(BadValue, match="varies no physics"):
        IdentifyPlan(("click_bell",), protocol="clean")
    with pytest.raises(UnknownName, match="phys_random"):
        IdentifyPlan(("click_bell",), protocol="phys_randon")
    with pytest.raises(BadValue, match="estimator"):
        IdentifyPlan(("click_bell",), estimator="forest")
    (tmp_path / "own.py").write_text("class features:\n    fit = predict = print\n")
    with pytest.raises(BadValue, match="the features have this name"):
        IdentifyPlan(("click_bell",), estimator=f"python:{tmp_path / 'own.py'}:features")
    with pytest.raises(BadValue, match="at least 20"):
        IdentifyPlan(("click_bell",), episodes=19)
    monkeypatch.setitem(sys.modules, "sklearn", None)
    monkeypatch.setitem(sys.modules, "sklearn.ensemble", None)
    said = ran(["identify", "--task", "click_bell", "--out", str(tmp_path)], 3)
    assert "rtphys[identify]" in said.output
    assert len(said.output.strip().splitlines()) == 1


SPEC = FeaturesSpec(EpisodeSpec("click_bell", "phys_random"), 0, {"versions": {"code": "0"}}, "")


def opened(out: Path, episodes: int = 20) -> TaskEpisodes:
    return TaskEpisodes(plan(out, episodes=episodes), SPEC)


def work(made: TaskEpisodes) -> None:
    """Does all jobs."""
    while made.wants(4):
        seed = made.begin()
        made.take(seed, sensed(made.job(seed)))


def test_an_estimator_may_be_named_by_a_link(tmp_path: Path) -> None:
    wanted = plan(tmp_path / "out")
    first = made(wanted)
    (tmp_path / "link.py").symlink_to("estimators.py")
    linked = identify.judge(replace(wanted, estimator=f"python:{tmp_path / 'link.py'}:Line"))
    assert linked.tasks == first.tasks


def test_a_task_that_was_given_up_stays_so(tmp_path: Path) -> None:
    made = opened(tmp_path / "a")
    while made.wants(1):
        seed = made.begin()
        made.take(seed, Sample(seed, reason="slipped"))
    assert made.progress.stopped and made.progress.attempts == FRUITLESS
    again = opened(tmp_path / "a")
    assert not again.wants(1) and again.progress.stopped == made.progress.stopped


def test_more_episodes_continue_and_fewer_are_a_part(tmp_path: Path) -> None:
    work(made := opened(tmp_path / "a"))
    before = made.path.read_bytes()
    assert not opened(tmp_path / "a").wants(1)
    work(opened(tmp_path / "a", episodes=24))
    assert made.path.read_bytes().startswith(before)
    rows, _ = read_samples(made.path, 20)
    assert [row.seed for row in rows] == [*range(23)]
    assert [row.seed for row in rows if row.reason] == [3, 10, 17]
    assert rows[0].labels.keys() == {"object_mass", "friction", "table_height"}
    assert rows[0].columns["lift/hand/effort/force_z/mean"] > 0.1


def test_a_seed_whose_worker_dies_is_no_episode_and_the_rest_goes_on(tmp_path: Path) -> None:
    made = opened(tmp_path / "a")
    seed = made.begin()
    made.take(seed, WorkerFailure("worker_crash", "was killed"))
    work(made)
    assert made.progress.rejections["worker_crash"] == 1
    assert [r.reason for r in read_samples(made.path, 20)[0] if r.seed == seed] == ["worker_crash"]


def test_features_made_otherwise_are_refused(tmp_path: Path) -> None:
    work(made := opened(tmp_path / "a"))
    with pytest.raises(DatasetMismatch, match=r"fingerprint\.versions\.code was '0', now '1'"):
        TaskEpisodes(plan(tmp_path / "a"), replace(SPEC, fingerprint={"versions": {"code": "1"}}))
    made.path.write_bytes(made.path.read_bytes().replace(b"slipped", b"slopped"))
    with pytest.raises(BadFile, match="checksum"):
        opened(tmp_path / "a")


SCORE = Score(0.5, (0.25, 0.75), -0.125, {"effort": 0.5}, 60, Beyond(0.25, (0.0, 0.5), 30))
ALONE = Score(0.75, (0.5, 1.0), 0.0, {}, 20, None)
RESULT = Result(
    "trees",
    "phys_random",
    {
        "heft": TaskResult(60, 62, {"object_mass": SCORE}, {"friction": "ValueError: no"}),
        "tap": TaskResult(60, 60, {"object_mass": ALONE}, {}, {"external_force": "does not act"}),
    },
)


def test_a_result_is_read_as_it_was_written(tmp_path: Path) -> None:
    path = tmp_path / "trees.json"
    write_result(path, RESULT)
    assert read_result(path) == RESULT
    first = path.read_bytes()
    write_result(path, read_result(path))
    assert path.read_bytes() == first


def test_means_are_over_the_tasks_that_have_a_score() -> None:
    assert RESULT.mean("object_mass", ["heft", "tap"]) == 0.625
    assert RESULT.mean("object_mass", ["heft", "tap"], beyond=True) == 0.25
    assert RESULT.mean("friction", ["heft", "tap"]) is None


@pytest.mark.parametrize("text", ["{}", '{"format": 2}', '{"format": 1, "tasks": 3}', "[1]"])
def test_what_is_no_result_is_refused(tmp_path: Path, text: str) -> None:
    path = tmp_path / "other.json"
    path.write_text(text)
    with pytest.raises(BadFile, match=r"other\.json"):
        read_result(path)
