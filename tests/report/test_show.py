"""`rtphys show`: what it says of an episode, and the pictures it writes."""

import re
import xml.etree.ElementTree as ElementTree
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import synthetic
from collected import FRAMES, collect, keep, labelled, write
from typer import Typer
from typer.testing import CliRunner

from rtphys.cli.show import show
from rtphys.data.dataset import Dataset
from rtphys.report.pictures import CAPTION, GAP, contact_sheet, joint_plot, panels

SVG = "{http://www.w3.org/2000/svg}"


STRAIN = "largest force on a link 12.3 N (fl_link6 and bell)"


@pytest.fixture(scope="module")
def dataset(tmp_path_factory: pytest.TempPathFactory) -> Dataset:
    out = tmp_path_factory.mktemp("dataset")
    collect(out, 2)
    return Dataset(out)


def run(*arguments: str):
    app = Typer()
    app.command()(show)
    return CliRunner().invoke(app, arguments)


def test_says_what_is_in_the_episode(dataset: Dataset, tmp_path: Path) -> None:
    result = run(str(dataset[1].paths.video), "--out", str(tmp_path))
    assert result.exit_code == 0, result.output
    for words in (
        "click_bell, seed 1",
        "ring the bell",
        "friction",
        "reach",
        "press",
        "4, 0.18 s",
        STRAIN,
    ):
        assert words in result.output
    stem = "click_bell_phys_random_aloha_agilex_episode_1"
    assert (tmp_path / f"{stem}.png").read_bytes().startswith(b"\x89PNG")
    assert (tmp_path / f"{stem}_joints.svg").stat().st_size > 3000


def test_marks_what_could_not_act_what_did_not_and_what_nobody_measured(tmp_path: Path) -> None:
    made = labelled(
        restitution={"acted": False, "value": 0.25},
        object_mass={"could_act": False, "acted": False, "value": 2.0},
        arm_joint_damping={"acted": True},
    )
    write(tmp_path, made)
    said = " ".join(run(str(tmp_path)).output.split())
    assert "restitution 0.25, did not act" in said
    assert "object_mass 2, could not act" in said
    *_, unmeasured = re.findall("not measured whether they acted: ([a-z_, ]+)", said)
    assert "friction" in unmeasured
    assert not re.search("restitution|object_mass|arm_joint_damping", unmeasured)


def test_says_how_a_kept_failure_failed(dataset: Dataset, tmp_path: Path) -> None:
    keep(tmp_path, attempts=3)
    failure = Dataset(tmp_path).failures()[0]
    shown = " ".join(run(str(failure.paths.video)).output.split())
    assert "slipped: bell left the left hand; slip of bell at frame 2, 0.12 s" in shown
    assert '"event": "slip"' in run(str(failure.paths.video), "--json").output
    assert "failure" not in run(str(dataset[0].paths.video)).output


def test_by_number(dataset: Dataset) -> None:
    assert "seed 1" in run(str(dataset.path), "--episode", "1").output
    assert "seed 1" in run(str(dataset.path), "--seed", "1").output
    result = run(str(dataset.path), "--episode", "7")
    assert "episodes 0 to 1" in str(result.exception)


def test_sheet_has_a_row_per_camera(dataset: Dataset) -> None:
    sheet = contact_sheet(dataset[0])
    height, width, _ = dataset[0].image("head_camera", 0).shape
    assert sheet.shape == (3 * (CAPTION + height + GAP), FRAMES * (width + GAP), 3)
    shown = sheet[CAPTION : CAPTION + height, :width]
    np.testing.assert_array_equal(shown, dataset[0].image("head_camera", 0))


def test_plot_draws_target_and_measured_of_every_joint(dataset: Dataset) -> None:
    root = ElementTree.fromstring(joint_plot(dataset[0]))
    groups = {group.attrib.get("id", ""): group for group in root.iter(f"{SVG}g")}
    for panel in panels(dataset[0].frames):
        for label in ("commanded", "measured"):
            (path,) = groups[f"{label} {panel.title}"].iter(f"{SVG}path")
            assert len(re.findall(r"[ML] ", path.attrib["d"])) == FRAMES
    words = {text.text or "" for text in root.iter(f"{SVG}text")}
    (stages,) = (text for text in words if "reach" in text)
    assert "press" in stages and {"1", "2", "commanded", "measured"} <= words
    assert joint_plot(dataset[0]) == joint_plot(dataset[0])


@pytest.mark.parametrize("joints", [(7, 6), (6, 7)])
def test_arms_of_a_pair_may_have_different_numbers_of_joints(
    tmp_path: Path, joints: tuple[int, int]
) -> None:
    """Grippers share the last row."""
    pair, frames = synthetic.header(embodiment="franka-panda,piper,0.8"), synthetic.frames_of
    made = synthetic.episode(0, spec=pair.spec.episode)
    (episode,) = write(tmp_path, replace(made, frames=frames(0, joints=joints)), what=pair)
    root = ElementTree.fromstring(joint_plot(episode))
    drawn = {group.attrib.get("id", "") for group in root.iter(f"{SVG}g")}
    assert {f"commanded {panel.title}" for panel in panels(episode.frames)} <= drawn
    assert len(panels(episode.frames)) == sum(joints) + 2


def test_a_panel_pairs_command_and_joint_by_name(dataset: Dataset) -> None:
    frames = dataset[0].frames
    right = panels(frames)[7 + 3]
    np.testing.assert_array_equal(right.target, frames.right_arm[:, 3])
    assert right.measured is not None
    column = frames.joint_names.index("fr_joint4")
    np.testing.assert_array_equal(right.measured, frames.qpos[:, column])
