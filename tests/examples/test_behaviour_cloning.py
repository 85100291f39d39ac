"""The example learns, and what it learned plays."""

# pyright: reportMissingImports=false

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import synthetic
import train
from collected import write
from features import CHUNK, features
from mlp import Adam, Mlp

from rtphys.assets.pack import default_pack
from rtphys.core.poses import axis_angle
from rtphys.episode import begin
from rtphys.policies import PolicySetup, open_policy
from rtphys.spec.episode import EpisodeSpec
from rtphys.task.spec import load_task

FOLDER = Path(__file__).parents[2] / "examples" / "behaviour_cloning"


def test_the_gradient_is_that_of_finite_differences() -> None:
    rng = np.random.default_rng(1)
    net = Mlp([3, 5, 2], rng)
    net.weights = [w.astype(float) for w in net.weights]  # type: ignore[misc]
    x, wanted = rng.normal(size=(7, 3)), rng.normal(size=(7, 2))
    net.normalise(x)
    _, gradients = net.gradients(x, wanted)
    parameters, step = [*net.weights, *net.biases], 1e-4
    for parameter, gradient in zip(parameters, gradients, strict=True):
        index = tuple(rng.integers(n) for n in parameter.shape)
        errors = []
        for sign in (1, -1):
            parameter[index] += sign * step
            errors.append(float(((net(x) - wanted) ** 2).mean()))
            parameter[index] -= sign * step
        assert gradient[index] == pytest.approx((errors[0] - errors[1]) / (2 * step), abs=1e-3)


def test_it_learns_a_curve_and_survives_a_file(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    net, steps = Mlp([1, 64, 64, 1], rng), 1500
    adam = Adam([*net.weights, *net.biases], steps)
    for _ in range(steps):
        x = rng.uniform(-2, 2, (64, 1)).astype(np.float32)
        adam.update(net.gradients(x, np.sin(2 * x))[1])
    x = np.linspace(-1.8, 1.8, 50, dtype=np.float32)[:, None]
    assert np.abs(net(x) - np.sin(2 * x)).max() < 0.1
    net.save(tmp_path / "net.npz")
    np.testing.assert_array_equal(Mlp.load(tmp_path / "net.npz")(x), net(x))


def test_features_do_not_know_a_quaternions_sign() -> None:
    q = axis_angle((0.0, 0.0, 1.0), 0.5)
    poses = [{"bell": np.array([[0.1, 0.2, 0.7, *(sign * q)]])} for sign in (1, -1)]
    plus, minus = (features(np.zeros((1, 14)), one) for one in poses)
    np.testing.assert_array_equal(plus, minus)
    np.testing.assert_allclose(plus[0, 17:20], [np.cos(0.5), np.sin(0.5), 0], atol=1e-6)


def test_clutter_is_left_out(tmp_path: Path) -> None:
    """Of `phys_random_all`, which `collect` takes by default: the policy is not shown it."""
    frames = synthetic.frames_of(0)
    poses = {**frames.object_poses, "clutter0": frames.object_poses["bell"]}
    made = replace(synthetic.episode(0), frames=replace(frames, object_poses=poses))
    (episode,) = write(tmp_path, made)
    assert "clutter0" in episode.frames.object_poses
    assert [*train.examples(episode)[1]] == ["bell"]


@pytest.mark.sim
def test_the_clone_plays(tmp_path: Path) -> None:
    net = Mlp([14 + 9, 4, CHUNK * 14], np.random.default_rng(0))
    net.weights[-1] *= 0
    net.biases[-1].reshape(CHUNK, 14)[:, 1:3] = 0.01  # two joints of the left arm move
    net.save(tmp_path / "click_bell.npz")
    setup = PolicySetup("click_bell", options={"weights": str(tmp_path)})
    policy = open_policy(f"python:{FOLDER}/clone.py:open_clone", setup)
    episode = begin(
        EpisodeSpec("click_bell", "clean").at(0), load_task("click_bell"), default_pack()
    )
    episode.step_limit = CHUNK
    before = episode.observe().vector
    policy.play(episode)
    assert episode.over
    moved = episode.observe().vector - before
    np.testing.assert_allclose(moved[1:3], 0.01, atol=1e-6)
    np.testing.assert_array_equal(np.delete(moved, (1, 2)), 0)
