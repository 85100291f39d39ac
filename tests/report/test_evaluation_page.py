"""The page of an evaluation: rates, failures, and the videos that are there."""

from pathlib import Path

from evaluations import instances, record, write_results
from typer.testing import CliRunner

from rtphys.cli.main import app
from rtphys.results.evaluation import EvaluationSpec, video_file


def test_a_page_has_every_failure_and_its_video(tmp_path: Path) -> None:
    records = [
        record(1, physics={"friction": 0.5}),
        record(2, False, physics={"friction": 0.05, "table_tilt": 1.0}, inert=("table_tilt",)),
        record(3, False, detail="<b>bell</b>", physics={"friction": 0.4, "table_tilt": 2.0}),
    ]
    listed = instances("click_bell", "clean", 1, 2, 3)
    write_results(tmp_path, EvaluationSpec("idle"), listed, records)
    video = video_file(tmp_path, "clean", "click_bell", 2, success=False)
    video.parent.mkdir(parents=True)
    video.write_bytes(b"mp4")
    done = CliRunner().invoke(app, ["report", str(tmp_path)])
    assert done.exit_code == 0, done.output
    page = (tmp_path / "report.html").read_text()
    assert "1/3" in page and "click_bell, clean: 2 of 3" in page
    assert page.count("<video") == 1 and 'src="video/clean/click_bell/2_failure.mp4"' in page
    assert "seed 1," not in page and "seed 2," in page and "seed 3," in page
    assert "&lt;b&gt;bell" in page and "<b>" not in page
    first = page[page.index("seed 2,") : page.index("seed 3,")]
    assert "0.05" in first and "table_tilt" not in first, "what could not act is left out"
