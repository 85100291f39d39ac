"""An audit finds false labels, and says in words how feasibility changed a distribution."""

import json

import numpy as np
import pytest
from typer.testing import CliRunner

from rtphys.cli.authoring import TEMPLATE
from rtphys.cli.physics import physics as command
from rtphys.core.errors import BadFile, BadValue
from rtphys.data.dataset import Dataset
from rtphys.data.faults import CannotWrite
from rtphys.data.staging import stage_episode
from rtphys.data.writer import DatasetWriter, Rejection
from rtphys.laws.audit.selection import Selection, selections, selections_by_task_dataset
from rtphys.task.spec import load_task

N = 400
MU = np.random.default_rng(1).uniform(0.01, 1.25, N)
MASS = np.random.default_rng(2).uniform(0.125, 4, N)


def attempts(accepted):
    return [
        ({"friction": mu, "object_mass": m, "center_of_mass": [0.01 * m, 0.0, 0.0]}, kept)
        for mu, m, kept in zip(MU.tolist(), MASS.tolist(), accepted, strict=True)
    ]


def test_a_cut_is_found_where_it_is_and_nowhere_else():
    found = {s.key: s for s in selections(attempts(MU > 0.25))}
    assert found.keys() == {"friction", "object_mass", "center_of_mass.x"}  # y, z do not vary
    assert found["friction"].p < 1e-10
    assert found["friction"].sentence.startswith("low values were cut: of 0.0")
    assert found["object_mass"].sentence == "no cut that shows"
    edges, rates = found["friction"].rates
    assert rates[0] < 0.1
    assert np.all(rates[1:] == 1)
    assert abs(edges[1] - 0.258) < 0.05


def test_a_cut_at_the_other_end_and_in_the_middle():
    def sentence(accepted):
        return selections(attempts(accepted))[1].sentence

    assert sentence(MU < 1.0).startswith("high values were cut")
    assert sentence(abs(MU - 0.63) > 0.1).startswith("middle values were cut")


def test_blind_acceptance_shows_no_cut():
    kept = np.random.default_rng(3).random(N) < 0.7
    for one in selections(attempts(kept)):
        assert one.sentence == "no cut that shows"
        assert one.distance < 0.1


def test_few_rejections_few_acceptances_and_none():
    few = Selection("k", "1", MU, np.arange(N) > 2)
    assert (few.sentence, few.p) == ("too few rejections to tell", 1.0)
    rare = Selection("k", "1", MU, np.arange(N) < 3)
    assert (rare.sentence, rare.p) == ("too few acceptances to tell", 1.0)
    none = Selection("k", "1", MU, np.zeros(N, bool))
    assert (none.sentence, none.distance) == ("nothing was accepted", 1.0)


def test_a_distance_is_that_of_the_textbook():
    # Of uniform values the upper half is kept: the two distributions are 0.5 apart.
    values = np.linspace(0, 1, 1001)
    assert abs(Selection("k", "1", values, values > 0.5).distance - 0.5) < 2e-3


@pytest.fixture(scope="module")
def slippery_rejected(tmp_path_factory):
    """A dataset of 25 small episodes, from which every friction below 0.5 was refused."""
    import synthetic
    from collected import wanting

    out = tmp_path_factory.mktemp("audited")
    with DatasetWriter(out) as dataset:
        task, seed = dataset.task(wanting(25)), 0
        while not task.done:
            labels = synthetic.phys_meta(seed)["attributes"]
            values = {key: label["value"] for key, label in labels.items()}
            if values["friction"] < 0.5:
                task.record(Rejection(seed, "grip_slip", "too slippery", values))
            else:
                task.record(stage_episode(task.staging(seed), synthetic.episode(seed, 2), "native"))
            seed += 1
    return out


def test_a_dataset_tells_which_attempts_were_refused(slippery_rejected):
    (found,) = selections_by_task_dataset(Dataset(slippery_rejected)).values()
    by_key = {one.key: one for one in found}
    assert by_key["friction"].accepted.sum() == 25
    assert by_key["friction"].attempted.min() < 0.5
    assert by_key["friction"].sentence.startswith("low values were cut")
    assert by_key["restitution"].sentence == "no cut that shows"
    assert {"center_of_mass.x", "center_of_mass.y", "center_of_mass.z"} <= by_key.keys()


def test_attempts_that_are_newer_than_the_manifest_do_not_count(tmp_path):
    from collected import run_ahead

    run_ahead(tmp_path)
    (found,) = selections_by_task_dataset(Dataset(tmp_path)).values()
    assert {len(one.attempted) for one in found} == {2}


def test_the_command_prints_and_draws_it(slippery_rejected, tmp_path):
    arguments = ["audit", str(slippery_rejected), "--no-labels", "--out", str(tmp_path)]
    result = CliRunner().invoke(command, arguments)
    assert result.exit_code == 0, result.output
    line = next(li for li in result.output.splitlines() if li.strip().startswith("friction"))
    assert "25 of " in line
    assert "low values were cut" in line
    (figure,) = tmp_path.glob("*.png")
    assert figure.stat().st_size > 20_000
    result = CliRunner().invoke(command, [*arguments, "--repeat", "1"])
    assert isinstance(result.exception, BadValue), "it would be ignored"


def test_where_no_figure_can_go_is_told_before_any_work(slippery_rejected, tmp_path, monkeypatch):
    monkeypatch.setattr("rtphys.cli.physics._labels", lambda *_: pytest.fail("it worked"))
    (tmp_path / "file").touch()
    arguments = ["audit", str(slippery_rejected), "--out", str(tmp_path / "file")]
    result = CliRunner().invoke(command, arguments)
    assert isinstance(result.exception, CannotWrite), result.exception


@pytest.mark.sim
def test_the_command_finds_labels_that_no_world_has(slippery_rejected):
    # By these labels the head camera hangs elsewhere than any of its draws puts it.
    result = CliRunner().invoke(command, ["audit", str(slippery_rejected)])
    assert result.exit_code == 1
    assert "camera_distance at head_camera, label: label " in result.output
    assert "0 of 25 episodes" in result.output


@pytest.mark.sim
def test_the_command_says_the_same_as_json(slippery_rejected):
    result = CliRunner().invoke(command, ["audit", str(slippery_rejected), "--json"])
    assert result.exit_code == 1
    printed = json.loads(result.stdout)
    assert (printed["episodes"], printed["sound"], len(printed["labels"])) == (25, 0, 25)
    deviations = printed["labels"][0]["deviations"]
    assert "head_camera, label" in {one["place"] for one in deviations}
    # The bell's surface and the table do have the labelled friction, drawn from the same seeds.
    assert printed["worst"]["friction"]["deviation"] <= printed["worst"]["friction"]["tolerance"]
    idle = {row["attribute"]: row["why"] for row in printed["unmeasured"]}
    assert "nothing here has it" in idle["object_mass"]
    (selections,) = printed["selection"].values()
    assert "low values were cut" in {s["attribute"]: s for s in selections}["friction"]["sentence"]


def test_what_the_code_of_a_task_raises_is_named(slippery_rejected, tmp_path, monkeypatch):
    file = tmp_path / "tasks" / "broken.py"
    file.parent.mkdir()
    text = TEMPLATE.replace("    pad = draw", "    1 / 0\n    pad = draw", 1)
    file.write_text(text)
    monkeypatch.setenv("RTPHYS_LIBRARY", str(tmp_path))
    for module in ("rtphys.cli.physics", "rtphys.episode.audit"):
        monkeypatch.setattr(f"{module}.load_task", lambda _, load=load_task: load("broken"))
    result = CliRunner().invoke(command, ["audit", str(slippery_rejected)])
    assert isinstance(result.exception, BadFile), result.exception
    line = text.splitlines().index("    1 / 0") + 1
    assert str(result.exception) == (
        f"{file}: raises ZeroDivisionError: division by zero (line {line})"
    )
