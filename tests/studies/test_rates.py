"""Measured rates: from certified lists to the table that users see."""

import importlib.util
import json
from dataclasses import replace
from pathlib import Path

import yaml
from evaluations import FINGERPRINT

from rtphys.results.instances import BenchmarkInstance, InstanceList, list_file, write_lists
from rtphys.spec.collection import CollectionSpec
from rtphys.spec.episode import EpisodeSpec
from rtphys.studies.rates import PROTOCOL, SHARES, Rate, costs, expected, like
from rtphys.task.spec import task_names

SCRIPT = Path(__file__).resolve().parents[2] / "scripts" / "rates.py"


def _script():
    spec = importlib.util.spec_from_file_location("rates_script", SCRIPT)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_a_certified_list_gives_its_attempts_and_those_that_are_feasible(tmp_path: Path) -> None:
    rows = [(7, "", "aa", True), (8, "slipped"), (9, "", "bb", False)]
    instances = tuple(BenchmarkInstance(*row) for row in rows)
    made = InstanceList("click_bell", "clean", FINGERPRINT, instances, ("replay",))
    write_lists(list_file(tmp_path, "clean"), [made])
    [(task, protocol, rate)] = _script().measured(tmp_path)
    assert (task, protocol) == ("click_bell", "clean")
    assert rate == Rate(3, 2)
    assert rate + Rate(5, 5) == Rate(8, 7)


def test_a_file_of_check_gives_the_same_columns(tmp_path: Path) -> None:
    row = {"task": "t", "protocol": "clean", "seeds": 4, "accepted": 3}
    path = tmp_path / "check.json"
    path.write_text(json.dumps([row]))
    script = _script()
    [(task, protocol, rate)] = script.measured(path)
    written = yaml.safe_load(script.text({task: {protocol: rate}}))
    assert written == {"t": {"clean": [4, 3]}}


def test_every_task_has_a_measured_cost() -> None:
    known = costs()
    assert known.keys() >= {*task_names()}
    bell, none = (
        CollectionSpec(EpisodeSpec(task, PROTOCOL), episodes=10) for task in ("click_bell", "none")
    )
    cpu, unknown = expected([bell, none])
    assert unknown == ["none"]
    assert cpu == 10 * known["click_bell"].cpu > 0
    plain, _ = expected([replace(bell, episode=EpisodeSpec("click_bell", "clean"))])
    assert plain < 0.9 * cpu


def test_every_protocol_costs_as_one_that_was_measured() -> None:
    looks = [(False, False), (True, False), (False, True), (True, True)]
    assert [like(*look) for look in looks] == [*SHARES]
