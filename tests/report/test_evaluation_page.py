"""The page of an evaluation: rates, failures, and the videos that are there."""

import base64
import re
from dataclasses import replace
from pathlib import Path

from evaluations import FINGERPRINT, instances, record, write_results
from typer.testing import CliRunner

from rtphys.cli.main import app
from rtphys.report.figures import draw_breaks
from rtphys.results.evaluation import EvaluationSpec, video_file
from rtphys.results.summary import summarise

KEY = ("clean", "click_bell")


def test_a_page_has_every_failure_and_its_video(tmp_path: Path) -> None:
    records = [
        record(1, physics={"friction": 0.5}),
        record(2, False, physics={"friction": 0.05, "table_tilt": 1.0}, inert=("table_tilt",)),
        record(3, False, detail="<b>bell</b>", physics={"friction": 0.4, "table_tilt": 2.0}),
    ]
    listed = instances("click_bell", "clean", 1, 2, 3)
    spec = EvaluationSpec("python:mine.py:make", options={"low": "0.905"})
    write_results(tmp_path, spec, listed, records)
    video = video_file(tmp_path, "clean", "click_bell", 2, success=False)
    video.parent.mkdir(parents=True)
    video.write_bytes(b"mp4")
    done = CliRunner().invoke(app, ["report", str(tmp_path)])
    assert done.exit_code == 0, done.output
    page = (tmp_path / "report.html").read_text()
    assert "<h1>python:mine.py:make low=0.905</h1>" in page
    assert "<dt>table_tilt</dt><dd>2 deg</dd>" in page
    assert "1/3" in page and "click_bell, clean: 2 of 3" in page
    assert page.count("<video") == 1 and 'src="video/clean/click_bell/2_failure.mp4"' in page
    assert "seed 1," not in page and "seed 2," in page and "seed 3," in page
    assert "&lt;b&gt;bell" in page and "<b>" not in page
    first = page[page.index("seed 2,") : page.index("seed 3,")]
    assert "0.05" in first and "table_tilt" not in first, "what could not act is left out"


def test_the_failure_of_a_single_episode_has_its_physics(tmp_path: Path) -> None:
    """Nothing varies there; what is nominal in all episodes is left out."""
    physics = {"friction": 0.05, "table_tilt": 0.0, "center_of_mass": [0.0, 0.0, 0.0]}
    listed, records = instances("click_bell", "clean", 1), [record(1, False, physics=physics)]
    write_results(tmp_path, EvaluationSpec("idle"), listed, records)
    assert CliRunner().invoke(app, ["report", str(tmp_path)]).exit_code == 0
    (physics,) = re.findall(r"<dl>(.*?)</dl>", (tmp_path / "report.html").read_text())
    assert physics == "<dt>friction</dt><dd>0.05</dd>"


def test_an_unfinished_evaluation_is_called_so_and_nothing_is_ignored(tmp_path: Path) -> None:
    listed = instances("click_bell", "clean", 1, 2, 3)
    write_results(tmp_path, EvaluationSpec("idle"), listed, [record(1), record(2)])
    run, page = CliRunner().invoke, tmp_path / "report.html"
    assert run(app, ["report", str(tmp_path)]).exit_code == 0
    assert "<p>unfinished: 2 of 3 episodes of click_bell, clean</p>" in page.read_text()
    write_results(tmp_path, EvaluationSpec("idle"), listed, [record(n) for n in (1, 2, 3)])
    assert run(app, ["report", str(tmp_path)]).exit_code == 0
    assert "unfinished" not in page.read_text()
    for words in (["--out", "page.html"], ["--task", "click_bell"]):
        done = run(app, ["report", str(tmp_path), *words])
        assert done.exit_code == 2 and f"{words[0]} = " in done.stderr


def test_attributes_stand_in_one_order_which_is_that_of_the_table(tmp_path: Path) -> None:
    """friction decides here; without an effect `arm_joint_damping` would be the first by name."""
    records = [
        record(
            seed,
            seed > 6,
            physics={
                "arm_joint_damping": (seed * 7 % 12) / 10,
                "gripper_joint_damping": (seed * 7 % 12) / 10,
                "friction": seed / 10,
                "gravity": 9.81,
                "center_of_mass": [0.01 * seed, 0.0, 0.0],
                "redraws": seed,
            },
            inert=("center_of_mass",) if seed != 3 else (),
        )
        for seed in range(1, 13)
    ]
    listed = instances("click_bell", "clean", *range(1, 13))
    write_results(tmp_path, EvaluationSpec("idle"), listed, records)
    (tmp_path / "attributes_clean.png").write_bytes(b"of other tasks")
    assert CliRunner().invoke(app, ["report", str(tmp_path)]).exit_code == 0
    page = (tmp_path / "report.html").read_text()
    assert page.count("<img") == 1
    boxes = re.findall(r"<dl>(.*?)</dl>", page)
    orders = [re.findall("<dt>(.*?)</dt>", box) for box in boxes]
    first = ["friction", "arm_joint_damping", "gripper_joint_damping"]
    assert orders == [first, first, [*first, "center_of_mass"], first, first, first]
    assert "<dd>0.03, 0, 0 m</dd>" in page and "<dd>0.6</dd>" in page
    assert "are in the order of the table above" in page
    assert "`rtphys sensitivity` moves one attribute alone" in page
    assert page.count("drawn together: arm_joint_damping, gripper_joint_damping; ") == 1
    (effects,) = summarise({KEY: records}, {KEY: listed}).breaks.values()
    drawn = draw_breaks(effects, "idle under clean")
    assert base64.b64encode(drawn).decode() in page, "not a figure that an earlier command left"


def test_a_page_says_what_its_seeds_are_and_which_lists_were_stale(tmp_path: Path) -> None:
    listed = instances("click_bell", "clean", 1)
    seeds = replace(listed, instances=tuple(one._replace(state="") for one in listed.instances))
    edited = FINGERPRINT.model_copy(update={"assets": "new"})
    for folder, of, now in (("list", listed, FINGERPRINT), ("seeds", seeds, edited)):
        write_results(tmp_path / folder, EvaluationSpec("idle"), of, [record(1)], now)
        assert CliRunner().invoke(app, ["report", str(tmp_path / folder)]).exit_code == 0
    page = (tmp_path / "list" / "report.html").read_text()
    assert "success of benchmark instances" in page and "fingerprint" not in page
    page = (tmp_path / "seeds" / "report.html").read_text()
    assert "success of these seeds" in page and "assets was &#x27;&#x27;, now &#x27;new" in page
