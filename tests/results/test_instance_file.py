"""Certified lists on disk: what is written is what is read, and damage is named."""

from dataclasses import replace
from pathlib import Path

import pytest

from rtphys.core.errors import BadFile
from rtphys.data.schema_model import SchemaError
from rtphys.results.instance_file import read_instances, write_instances
from rtphys.results.instances import InstanceList, Slot

FINGERPRINT = {
    "domain": {"name": "global", "digest": "0" * 64},
    "look": "",
    "assets": "1" * 64,
    "versions": {"rtphys": "0.1.0", "task": "2" * 16},
}
SLOTS = (
    Slot(100000, "", "0123456789012345", True, None),  # digits alone: no number when read again
    Slot(100001, "unreachable"),
    Slot(100002, "", "0e12345678901234", False, True),
    Slot(100003, "slipped"),
    Slot(100004, "unreachable"),
)
LIST = InstanceList("click_bell", "phys_random", FINGERPRINT, SLOTS, ("replay",))


def test_what_is_written_is_what_is_read(tmp_path: Path) -> None:
    path = tmp_path / "phys_random" / "click_bell.yaml"
    write_instances(path, LIST)
    assert read_instances(path) == LIST
    first = path.read_bytes()
    write_instances(path, read_instances(path))
    assert path.read_bytes() == first


@pytest.mark.parametrize("slots", [SLOTS[:1], SLOTS[1:2], ()])
def test_a_list_may_hold_one_kind_alone_or_nothing(tmp_path: Path, slots) -> None:
    path = tmp_path / "list.yaml"
    write_instances(path, replace(LIST, slots=slots))
    assert read_instances(path).slots == slots


def test_a_hundred_instances_are_compact(tmp_path: Path) -> None:
    good = [Slot(100000 + i, "", f"{i:016x}", True, False) for i in range(100)]
    bad = [Slot(100100 + i, "grasp_missed") for i in range(40)]
    path = tmp_path / "list.yaml"
    write_instances(path, replace(LIST, slots=(*good, *bad)))
    assert path.stat().st_size < 6000
    assert len(read_instances(path).slots) == 140


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("format: 1", "format: 9", "format 1"),
        ("100002,", "100009,", "a seed is missing"),
        ("attempts: 5", "attempts: 6", r"\(6, 2\), but it holds \(5, 2\)"),
    ],
)
def test_damage_is_named(tmp_path: Path, old: str, new: str, told: str) -> None:
    path = tmp_path / "list.yaml"
    write_instances(path, LIST)
    path.write_text(path.read_text().replace(old, new, 1))
    with pytest.raises(BadFile, match=told):
        read_instances(path)


@pytest.mark.parametrize(
    ("old", "new", "problem"),
    [
        ("true, null", "1, null", r"instances\.0\.2: input should be a valid boolean"),
        ("assets:", "asset:", "assets: field required"),
        ("- [100000", "- [true", r"instances\.0\.0: input should be a valid integer"),
        ("100003]", "three]", r"infeasible\..*: input should be a valid integer"),
    ],
)
def test_a_wrong_value_is_named_with_its_key(
    tmp_path: Path, old: str, new: str, problem: str
) -> None:
    path = tmp_path / "list.yaml"
    write_instances(path, LIST)
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(SchemaError, match=problem):
        read_instances(path)
