"""`rtphys physics` and `rtphys domains` from the command line."""

import json
import re
from pathlib import Path

import pytest
from typer.testing import CliRunner

from rtphys.cli.authoring import domains
from rtphys.cli.main import app
from rtphys.cli.physics import physics, worst
from rtphys.core import library
from rtphys.core.errors import BadValue, UnknownName
from rtphys.laws.lab import Lab
from rtphys.laws.law import Trial
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


@pytest.mark.parametrize("nothing", ["", ","])
def test_only_of_nothing_is_refused_rather_than_to_mean_all(nothing):
    result = RUN.invoke(physics, ["sample", "global", "--only", nothing])
    assert isinstance(result.exception, UnknownName)


def test_sample_as_a_table_shows_nominal_values_in_brackets():
    text = output_of(physics, "sample", "--task", "global", "--only", "friction")
    assert "(1)" in text and "friction" in text


@pytest.mark.sim
def test_sample_of_a_task_is_what_its_episode_has():
    (row,) = sampled("open_laptop", "--first-seed", "3")
    assert row["values"]["center_of_mass_redraws"] > 0


@pytest.mark.parametrize("name", sorted(library.names("domains")))
def test_a_domain_as_yaml_reads_back_as_the_same(name, tmp_path):
    domain = load_domain(name)
    path = tmp_path / f"{name}.yaml"
    path.write_text(output_of(domains, "show", name, "--yaml"))
    copied = load_domain(path)
    assert copied.rules == domain.rules and copied.digest == domain.digest
    assert (copied.name, copied.why) == (domain.name, domain.why)
    assert len(path.read_text().splitlines()) == 2 + len(domain.rules), "a rule is a line"


def test_as_yaml_numbers_stay_numbers(tmp_path):
    path, copy = tmp_path / "tiny.yaml", tmp_path / "copy.yaml"
    path.write_text("why: 'a: \"b\"'\nphysics: {friction: {log_uniform: [1.0e-05, 1.0]}}\n")
    copy.write_text(output_of(domains, "show", str(path), "--yaml"))
    assert load_domain(copy).rules == load_domain(path).rules
    assert load_domain(copy).why == 'a: "b"'


OWN = str(Path(__file__).parents[2] / "examples" / "own_attributes")
CURE = f"`rtphys --library {OWN} domains show global --yaml` prints a file without `extends`"


def test_an_attribute_of_ones_own_that_global_lacks_leads_to_a_file_without_extends(
    tmp_path, monkeypatch
):
    monkeypatch.setenv("RTPHYS_LIBRARY", "")  # set, so that it is put back: the command sets it too
    (file := tmp_path / "air.yaml").write_text(
        "extends: global\nphysics: {linear_drag: {uniform: [0, 3]}}\n"
    )
    said = RUN.invoke(app, ["--library", OWN, "domains", "check", str(file)]).stderr
    assert f"{file}: linear_drag = " in said and CURE in said
    monkeypatch.setenv("RTPHYS_LIBRARY", "")
    only = ["collect", "click_bell", "--only", "linear_drag", "--dry-run"]
    said = RUN.invoke(app, ["--library", OWN, *only, "--out", str(tmp_path / "data")]).stderr
    assert said.startswith("rtphys: domain global has no range for linear_drag; --domain")
    assert CURE in said and "did you mean" not in said


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


def test_a_law_may_allow_no_error_at_all():
    exact, wrong = (Trial("x", 1.0, x, "m", tolerance=0.0, setting="a") for x in (1.0, 1.1))
    assert worst([exact, wrong]) == worst([wrong, exact]) == [wrong]
    near = Trial("y", 1.0, 1.01, "m", setting="a")
    assert worst([exact, near]) == [near]


@pytest.mark.sim
def test_law_test_exits_by_the_outcome(monkeypatch):
    text = output_of(physics, "law-test", "restitution", "camera_angle")
    assert "trials obey the laws of 2 attributes" in text
    stated = re.findall(r"labels state a tolerance of (.*)", text)
    assert stated == ["0.05 at 0.5", "0.01 deg at 10"]
    real = Lab.world
    monkeypatch.setattr(Lab, "world", lambda lab, props, values: real(lab, props, {}))
    result = RUN.invoke(physics, ["law-test", "restitution", "--json"])
    assert result.exit_code == 1
    assert not all(row["passed"] for row in json.loads(result.stdout))
    assert "FAIL" in RUN.invoke(physics, ["law-test", "restitution"]).output
