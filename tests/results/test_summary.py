"""The summary of an evaluation, from its records and certified lists."""

from dataclasses import replace
from pathlib import Path

import pytest
from evaluations import FINGERPRINT, instances, record

from rtphys.results import summarise
from rtphys.results.instances import BenchmarkInstance, read_list, write_lists
from rtphys.results.statistics import Rate


def test_a_summary_tells_both_denominators_and_pairs_seeds() -> None:
    played = {
        ("clean", "a"): {1: True, 2: True, 3: True},
        ("clean", "b"): {1: False, 2: True},
        ("phys_random", "a"): {1: False, 3: True},
        ("phys_random", "b"): {},
    }
    records = {
        (protocol, task): [record(*one, task=task, protocol=protocol) for one in seeds.items()]
        for (protocol, task), seeds in played.items()
    }
    lists = {key: instances(key[1], key[0], *(seeds or (5, 6))) for key, seeds in played.items()}
    found = summarise(records, lists)
    row = next(row for row in found.tasks if row.protocol == "phys_random" and row.task == "a")
    assert row.counts.of_feasible.value == 0.5 and row.reasons == {"step_limit": 1}
    assert row.counts.of_tried is not None
    assert row.counts.of_tried.value == pytest.approx(1 / 3)  # seed 2 was infeasible
    clean, physical = found.overall
    assert clean.mean_of_tasks == pytest.approx((1 + 0.5) / 2)
    assert clean.counts.of_feasible.value == pytest.approx(4 / 5)
    assert not physical.counts.complete and physical.counts.of_tried is None
    (pair,) = found.pairs
    assert (pair.outcome.trials, pair.outcome.only_first, pair.outcome.both) == (2, 1, 1)
    assert found.to_json()["attributes"] == {"clean": [], "phys_random": []}


def test_seeds_that_nobody_tried_under_a_protocol_have_no_second_denominator(
    tmp_path: Path,
) -> None:
    """The rejects of a dataset's protocol say nothing of another's; a file keeps that."""
    own = replace(instances("a", "clean", 1, 3), instances=())
    rows = (BenchmarkInstance(1), BenchmarkInstance(2, "slipped"), BenchmarkInstance(3))
    lists = {
        ("clean", "a"): replace(own, instances=rows),
        ("phys_random", "a"): replace(
            own, protocol="phys_random", instances=rows, tried_under="clean"
        ),
    }
    for (protocol, task), one in lists.items():
        write_lists(tmp_path / f"{protocol}.jsonl", [one])
        assert read_list(tmp_path / f"{protocol}.jsonl", task) == one
    records = {key: [record(seed, task="a", protocol=key[0]) for seed in (1, 3)] for key in lists}
    clean, physical = (row.counts for row in summarise(records, lists).tasks)
    assert (clean.tried, clean.infeasible, clean.of_tried) == (3, 1, Rate(2, 3))
    assert (physical.tried, physical.infeasible, physical.of_tried) == (None, None, None)
    assert physical.complete and physical.of_feasible == Rate(2, 2)
    assert physical.to_json()["of_tried"] is physical.to_json()["tried"] is None


def test_the_order_of_records_does_not_matter() -> None:
    records = [record(seed, seed % 2 == 0, steps=seed) for seed in range(1, 6)]
    lists = {("clean", "click_bell"): instances("click_bell", "clean", 1, 2, 3, 4, 5)}
    first, second = (
        summarise({("clean", "click_bell"): order}, lists) for order in (records, records[::-1])
    )
    assert first.to_json() == second.to_json()
    assert first.tasks[0].steps == 3.0  # mean of 2 and 4: failures do not count


def test_loads_are_those_of_successes_and_rough_ones_are_counted() -> None:
    records = [
        record(1, force=10.0, torque=0.2),
        record(2, force=50.0, torque=1.0, rough=True),
        record(3, force=20.0, torque=0.4),
        record(4, False, force=900.0, torque=1.0, rough=True),
    ]
    lists = {("clean", "click_bell"): instances("click_bell", "clean", 1, 2, 3, 4)}
    found = summarise({("clean", "click_bell"): records}, lists)
    assert found.tasks[0].loads == found.overall[0].loads
    assert found.tasks[0].loads.rough == 1
    (row,) = found.to_json()["tasks"]
    assert row["force"] == {"median": 20.0, "p90": pytest.approx(44.0), "max": 50.0}
    assert (row["torque"]["max"], row["rough"]) == (1.0, 1)
    none = summarise({("clean", "click_bell"): records[3:]}, lists)
    assert none.to_json()["overall"][0]["force"] is None


def test_stale_lists_mark_the_summary_and_others_leave_none() -> None:
    keys = [("clean", "click_bell"), ("clean", "lift_pot")]
    lists = {key: instances(key[1], key[0], 1, 2) for key in keys}
    records = {key: [record(1, task=key[1]), record(2, task=key[1])] for key in keys}
    same = summarise(records, lists, dict.fromkeys(keys, FINGERPRINT))
    assert same.stale == "" and "changed_since_certified" not in same.to_json()
    edited = FINGERPRINT.model_copy(update={"versions": {"code": "new"}})
    found = summarise(records, lists, {keys[0]: FINGERPRINT, keys[1]: edited})
    clause = "versions.code was None, now 'new'"
    assert found.to_json()["changed_since_certified"] == [
        {"protocol": "clean", "task": "lift_pot", "clauses": [clause]}
    ]
    assert found.stale == (
        "1 of 2 lists had another certification fingerprint when they were run: " + clause
    )


def test_seeds_of_a_dataset_are_not_called_certified() -> None:
    key, listed = ("clean", "click_bell"), instances("click_bell", "clean", 1, 2)
    seeds = replace(listed, instances=tuple(one._replace(state="") for one in listed.instances))
    for given, certified in ((listed, True), (seeds, False)):
        found = summarise({key: [record(1)]}, {key: given})
        assert found.certified == found.to_json()["certified"] == certified


@pytest.mark.parametrize(
    ("first", "second", "differ"),
    [
        ("only_friction", "severity_50", True),
        ("clean", "phys_random_all", True),
        ("phys_random", "official_random", True),
        ("clean", "phys_random", False),  # physics alone
        ("clean", "official_random", False),  # looks alone, as their names say
        ("severity_25", "severity_100", False),
        ("official_random", "phys_random_all", False),  # the table's height is then the physics
        ("severity_50", "known_elsewhere", False),
    ],
)
def test_a_pair_of_protocols_that_differ_in_looks_too_says_so(
    first: str, second: str, differ: bool
) -> None:
    keys = [(first, "a"), (second, "a")]
    records = {key: [record(1, task="a", protocol=key[0])] for key in keys}
    (pair,) = summarise(records, {key: instances("a", key[0], 1) for key in keys}).pairs
    assert pair.looks_differ == differ
    said = f"{first}, {second}: they differ in looks too, not in physics alone"
    assert pair.caution == (said if differ else "")
