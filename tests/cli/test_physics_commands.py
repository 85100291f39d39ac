"""`rtphys physics` and `rtphys domains` from the command line."""

import json

import pytest
from typer.testing import CliRunner

from rtphys.cli.authoring import domains
from rtphys.cli.physics import physics
from rtphys.core.errors import BadValue, UnknownName
from rtphys.laws.lab import Lab
from rtphys.physics import Domain, Physics, load_domain
from rtphys.physics.values import plain_value

RUN = CliRunner()


def output_of(app, *arguments):
    result = RUN.invoke(app, list(arguments))
    assert result.exit_code == 0, result.output
    return result.output


def sampled(*arguments):
    return json.loads(output_of(physics, "sample", "--task", *arguments, "--json"))


def test_sample_as_json_is_what_the_domain_draws():
    rows = sampled("global", "--episodes", "3")
    assert [row["seed"] for row in rows] == [0, 1, 2]
    for row in rows:
        values = {key: plain_value(value) for key, value in row["values"].items()}
        assert Physics(values, row["varied"]) == load_domain("global").sample(row["seed"])


def test_sample_of_a_part_and_of_a_held_value(monkeypatch, tmp_path):
    (tmp_path / "scan_object.yaml").write_text("extends: scan_object\n")
    monkeypatch.chdir(tmp_path)
    held = ("--only", "friction, restitution", "--set", "restitution=0.1")
    (row,) = sampled("scan_object.yaml", *held)
    assert row["varied"] == ["friction", "restitution"]
    assert row["values"]["restitution"] == 0.1


def test_sample_as_a_table_shows_nominal_values_in_brackets():
    text = output_of(physics, "sample", "--task", "global", "--only", "friction")
    assert "(1)" in text and "friction" in text


@pytest.mark.sim
def test_sample_of_a_task_is_what_its_episode_has():
    (row,) = sampled("open_laptop", "--first-seed", "3")
    assert row["values"]["center_of_mass_redraws"] > 0


def test_ranges_and_their_sources_are_shown_and_read_back():
    data = json.loads(output_of(domains, "show", "scan_object", "--json"))
    assert Domain.from_json(data).digest == load_domain("scan_object").digest
    sources = data["sources"]
    assert (sources["camera_distance"], sources["friction"]) == ("scan_object", "global")
    lines = output_of(domains, "show", "turn_switch").splitlines()
    line = next(li for li in lines if "object_joint_damping" in li)
    assert "[0, 1]" in line and "turn_switch" in line


def test_a_user_s_file_is_checked(tmp_path):
    path = tmp_path / "icy.yaml"
    path.write_text("extends: global\nphysics: {friction: {uniform: [0.01, 0.1]}}\n")
    assert "good; it sets friction" in output_of(domains, "check", str(path))
    path.write_text("extends: global\nphysics: {friction: {uniform: [0, 0.1]}}\n")
    result = RUN.invoke(domains, ["check", str(path)])
    assert isinstance(result.exception, BadValue) and "only narrow" in str(result.exception)


@pytest.mark.parametrize(
    ("app", "command", "nearest"),
    [(domains, "show scan_objekt", "scan_object"), (physics, "law-test frictoin", "friction")],
)
def test_unknown_names_are_refused_with_the_nearest(app, command, nearest):
    result = RUN.invoke(app, command.split())
    assert isinstance(result.exception, UnknownName)
    assert f"did you mean '{nearest}'" in str(result.exception)


@pytest.mark.sim
def test_law_test_exits_by_the_outcome(monkeypatch):
    text = output_of(physics, "law-test", "restitution", "camera_angle")
    assert "trials obey the laws of 2 attributes" in text
    real = Lab.world
    monkeypatch.setattr(Lab, "world", lambda lab, props, values: real(lab, props, {}))
    result = RUN.invoke(physics, ["law-test", "restitution", "--json"])
    assert result.exit_code == 1
    assert not all(row["passed"] for row in json.loads(result.stdout))
    assert "FAIL" in RUN.invoke(physics, ["law-test", "restitution"]).output
