"""Result folders: their paths, their ledgers, and reading them again."""

from pathlib import Path

import pytest
from evaluations import FINGERPRINT, instances, record, write_results

from rtphys.core.errors import BadFile
from rtphys.data.ledger import Ledger
from rtphys.results import read_results
from rtphys.results.evaluation import (
    EpisodeRecord,
    EvaluationHeader,
    EvaluationSpec,
    headers,
    ledger_file,
    short_name,
    video_file,
)
from rtphys.results.instances import list_file, write_lists

LISTED = instances("click_bell", "clean", 1, 2)


def test_a_folder_of_results_is_read_again(tmp_path: Path) -> None:
    known = [
        record(1, first_touch=1.5, physics={"friction": None, "center_of_mass": [0.1, 0, 0]}),
        record(2, success=False, detail='Traceback:\n  "x"'),
    ]
    write_results(tmp_path, EvaluationSpec("idle"), LISTED, known)
    begun = instances("click_bell", "phys_random", 1, 2)
    write_lists(list_file(tmp_path / "instances", "phys_random"), [begun])
    found = read_results(tmp_path)
    assert found.policy == "idle"
    assert found.records["clean", "click_bell"] == known
    assert found.records["phys_random", "click_bell"] == []
    assert [one.seed for one in found.lists["clean", "click_bell"].feasible] == [1, 2]


def test_an_actor_is_named_with_its_options() -> None:
    spec = EvaluationSpec("python:mine.py:make", options={"b": "x/y", "a": "0.9"})
    assert spec.actor == "python:mine.py:make a=0.9 b=x/y"
    assert spec.short_actor == f"{short_name(spec.policy)}.a=0.9.b=x_y"
    assert EvaluationSpec("idle").short_actor == EvaluationSpec("idle").actor == "idle"
    long = EvaluationSpec("idle", options={"path": "é" * 300})
    assert len(long.short_actor.encode()) <= 255


def test_a_torn_last_line_is_passed_over(tmp_path: Path) -> None:
    write_results(tmp_path, EvaluationSpec("idle"), LISTED, [record(1), record(2)])
    path = ledger_file(tmp_path, "clean", "click_bell")
    path.write_bytes(path.read_bytes()[:-40])
    assert read_results(tmp_path).records["clean", "click_bell"] == [record(1)]


@pytest.mark.parametrize("length", [0, 1, 200])
def test_a_ledger_that_was_cut_short_in_its_first_line_has_not_begun(
    tmp_path: Path, length: int
) -> None:
    write_results(tmp_path, EvaluationSpec("idle"), LISTED, [record(1)])
    whole = ledger_file(tmp_path, "clean", "click_bell")
    cut = ledger_file(tmp_path, "phys_random", "click_bell")
    cut.parent.mkdir()
    cut.write_bytes(whole.read_bytes()[:length])
    assert headers(tmp_path).keys() == {whole}
    assert read_results(tmp_path).records == {("clean", "click_bell"): [record(1)]}


def test_what_is_no_folder_of_results(tmp_path: Path) -> None:
    with pytest.raises(BadFile, match="rtphys evaluate"):
        read_results(tmp_path)
    (tmp_path / "run.json").touch()
    with pytest.raises(BadFile, match="an earlier version"):
        read_results(tmp_path)
    (tmp_path / "run.json").unlink()
    write_results(tmp_path, EvaluationSpec("idle"), LISTED, [record(1)])
    list_file(tmp_path / "instances", "clean").unlink()
    with pytest.raises(BadFile, match="has no list of click_bell, clean"):
        read_results(tmp_path)


@pytest.mark.parametrize(
    "row",
    [
        *('{"seed": 3}', "[]", '{"task": "t", "protocol": "clean", "seed": true}'),
        '{"task": "t", "protocol": "clean", "seed": 1, "success": true, "mood": "good"}',
        '{"task": "t", "protocol": "clean", "seed": 1, "success": true, "time": NaN}',
    ],
)
def test_a_line_that_is_no_record_is_named(tmp_path: Path, row: str) -> None:
    path = ledger_file(tmp_path, "clean", "click_bell")
    ledger = Ledger(path, EvaluationHeader(EvaluationSpec("idle"), FINGERPRINT), EpisodeRecord)
    ledger.start()
    ledger._write(row.encode(), durable=False)
    with pytest.raises(BadFile, match="line 2"):
        read_results(tmp_path)


def test_paths_within_a_folder() -> None:
    assert ledger_file(Path("a"), "clean", "t") == Path("a/clean/t.ledger")
    folder = Path("a/video/clean/t")
    assert video_file(Path("a"), "clean", "t", 3, success=True) == folder / "3_success.mp4"
    assert video_file(Path("a"), "clean", "t", 3, success=False) == folder / "3_failure.mp4"


def test_a_policy_has_a_short_name() -> None:
    assert short_name("robotwin:/x/policy/pi0/deploy_policy.py?port=9") == "pi0"
    assert short_name("replay:runs/clean") == "replay_clean"
    assert short_name("openpi:localhost:8000") == "openpi_localhost_8000"
    assert short_name("idle") == "idle"
    assert len(short_name("expert:" + "+".join(["friction=0.5"] * 40))) < 200, "it names a folder"
