"""Records, folders and official files: what is written can be read by those who look for it."""

from datetime import UTC, datetime
from pathlib import Path

import pytest

from rtphys.core.errors import BadFile
from rtphys.data.json_text import pretty
from rtphys.results import EpisodeRecord, read_results, summarise
from rtphys.results.folder import INSTANCES, RUN, record_file
from rtphys.results.instance_file import instance_file, write_instances
from rtphys.results.instances import InstanceList, Slot
from rtphys.results.official import result_file, result_text
from rtphys.results.record_file import RecordFile, read_records

GROUND = {"domain": {"name": "", "digest": ""}, "look": "", "assets": "", "versions": {}}


def record(seed: int, success: bool = True, **known) -> EpisodeRecord:
    reason = "" if success else "step_limit"
    task, protocol = known.pop("task", "click_bell"), known.pop("protocol", "clean")
    return EpisodeRecord(task, protocol, seed, success, success, reason, **known)


def instances(task: str, protocol: str, *seeds: int) -> InstanceList:
    """The given seeds are feasible, those between them are not."""
    slots = [
        Slot(seed, "" if seed in seeds else "slipped", "0" * 16 if seed in seeds else "")
        for seed in range(seeds[0], seeds[-1] + 1)
    ]
    return InstanceList(task, protocol, GROUND, tuple(slots))


def test_a_record_is_what_was_written(tmp_path: Path) -> None:
    path = tmp_path / "clean" / "click_bell.jsonl"
    told = [record(1, first_touch=1.5, physics={"friction": None, "center_of_mass": [0.1, 0, 0]})]
    told.append(record(2, success=False, detail='Traceback:\n  "x"'))
    file = RecordFile(path)
    for one in told:
        file.append(one)
    assert read_records(path) == told == RecordFile(path).records


def test_a_torn_line_is_cut_off_before_the_next(tmp_path: Path) -> None:
    path = tmp_path / "click_bell.jsonl"
    file = RecordFile(path)
    file.append(record(1))
    whole = path.read_bytes()
    path.write_bytes(whole + whole[:40])
    again = RecordFile(path)
    assert again.records == [record(1)]
    again.append(record(2))
    assert read_records(path) == [record(1), record(2)]


def test_a_line_that_is_no_record_is_named(tmp_path: Path) -> None:
    path = tmp_path / "click_bell.jsonl"
    path.write_text('{"seed": 3}\n')
    with pytest.raises(BadFile, match="line 1: is no record"):
        read_records(path)


def test_the_official_file_gives_the_successes_back(tmp_path: Path) -> None:
    """As a public fork reads it: attempts by their label, the rate on the last line."""
    path = result_file(tmp_path, "click_bell", "pi0", "phys_random_all")
    assert path.name == "_result_random.txt"
    assert result_file(tmp_path, "click_bell", "pi0", "clean").name == "_result_clean.txt"
    text = result_text("unseen", 100, 137, 41, datetime(2026, 1, 2, tzinfo=UTC))
    lines = [line for line in text.splitlines() if line.strip()]
    label = "Attempts (rollouts + expert-infeasible):"
    attempts = int(next(line for line in lines if line.startswith(label)).removeprefix(label))
    assert round(float(lines[-1]) * attempts) == 41
    assert 0 <= float(lines[-1]) <= 1 and attempts == 137


def test_a_summary_tells_both_denominators_and_pairs_seeds() -> None:
    records = {
        ("clean", "a"): [record(1, task="a"), record(2, task="a"), record(3, task="a")],
        ("clean", "b"): [record(1, False, task="b"), record(2, task="b")],
        ("phys_random", "a"): [
            record(1, False, task="a", protocol="phys_random"),
            record(3, task="a", protocol="phys_random"),
        ],
        ("phys_random", "b"): [],
    }
    lists = {
        ("clean", "a"): instances("a", "clean", 1, 2, 3),
        ("clean", "b"): instances("b", "clean", 1, 2),
        ("phys_random", "a"): instances("a", "phys_random", 1, 3),
        ("phys_random", "b"): instances("b", "phys_random", 5, 6),
    }
    found = summarise(records, lists)
    row = next(row for row in found.tasks if row.protocol == "phys_random" and row.task == "a")
    assert row.counts.of_feasible.value == 0.5 and row.reasons == {"step_limit": 1}
    assert row.counts.of_slots is not None
    assert row.counts.of_slots.value == pytest.approx(1 / 3)  # seed 2 was infeasible
    clean, physical = found.overall
    assert clean.mean_of_tasks == pytest.approx((1 + 0.5) / 2)
    assert clean.counts.of_feasible.value == pytest.approx(4 / 5)
    assert not physical.counts.complete and physical.counts.of_slots is None
    (pair,) = found.pairs
    assert (pair.outcome.trials, pair.outcome.only_first, pair.outcome.both) == (2, 1, 1)
    assert found.to_json()["attributes"] == {"clean": [], "phys_random": []}


def test_a_folder_of_results_is_read_again(tmp_path: Path) -> None:
    with pytest.raises(BadFile, match="rtphys evaluate"):
        read_results(tmp_path)
    run = {"policy": "idle", "tasks": ["click_bell"], "protocols": ["clean", "phys_random"]}
    (tmp_path / RUN).write_bytes(pretty(run))
    for protocol in ("clean", "phys_random"):
        place = instance_file(tmp_path / INSTANCES, protocol, "click_bell")
        write_instances(place, instances("click_bell", protocol, 1, 2))
    RecordFile(record_file(tmp_path, "clean", "click_bell")).append(record(1))
    found = read_results(tmp_path)
    assert found.policy == "idle"
    assert found.records["clean", "click_bell"] == [record(1)]
    assert found.records["phys_random", "click_bell"] == []  # not begun
    assert [slot.seed for slot in found.lists["clean", "click_bell"].feasible] == [1, 2]
