"""What a container may use, by both versions of control groups; what a process has used."""

import os
import time
from pathlib import Path

import pytest

from rtphys.campaign import machine
from rtphys.campaign.machine import Usage, cores, free_memory, memory, resident_bytes

HERE = "1:name=systemd:/\n"


def group(root: Path, own: str, files: dict[str, str], monkeypatch: pytest.MonkeyPatch) -> None:
    """This process in a group: `own` is /proc/self/cgroup, `files` lie in /sys/fs/cgroup."""
    (root / "own").write_text(own)
    for name, text in files.items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(text + "\n")
    monkeypatch.setattr(machine, "CGROUPS", root)
    monkeypatch.setattr(machine, "OWN_CGROUP", root / "own")
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: set(range(128)))


@pytest.mark.parametrize(
    ("own", "files", "count"),
    [
        ("0::/\n", {"cpu.max": "400000 100000"}, 4),  # docker --cpus=4
        ("0::/\n", {"cpu.max": "50000 100000"}, 1),
        ("0::/\n", {"cpu.max": "150000 100000"}, 2),
        ("0::/\n", {"cpu.max": "max 100000"}, 128),
        ("0::/a/b\n", {"a/b/cpu.max": "max 100000", "a/cpu.max": "300000 100000"}, 3),
        # The host's path, seen from in a container.
        ("0::/docker/12ab\n", {"cpu.max": "200000 100000"}, 2),
        (
            "4:cpu,cpuacct:/job\n",
            {"cpu/job/cpu.cfs_quota_us": "600000", "cpu/job/cpu.cfs_period_us": "100000"},
            6,
        ),
        (
            "4:cpu:/\n",
            {"cpu/cpu.cfs_quota_us": "-1", "cpu/cpu.cfs_period_us": "100000"},
            128,
        ),
        (HERE, {}, 128),
        ("0::/\n", {"cpu.max": "nonsense"}, 128),
    ],
)
def test_cores_are_those_of_the_quota(
    own: str, files: dict[str, str], count: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    group(tmp_path, own, files, monkeypatch)
    assert cores() == count


@pytest.mark.parametrize(
    ("own", "name"),
    [("0::/\n", "memory.max"), ("5:memory:/j\n", "memory/j/memory.limit_in_bytes")],
)
def test_memory_is_that_of_the_container(
    own: str, name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    group(tmp_path, own, {name: "50000000"}, monkeypatch)
    assert memory() == 50e6
    assert 0 < free_memory() <= 50e6


def test_without_control_groups_all_is_the_machines(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(machine, "OWN_CGROUP", tmp_path / "none")
    assert memory() == os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")


def test_a_process_that_computes_uses_time_and_one_that_sleeps_does_not() -> None:
    before = Usage.of(os.getpid())
    end = time.process_time() + 0.1
    while time.process_time() < end:
        pass
    after = Usage.of(os.getpid())
    assert after.cpu - before.cpu >= 0.08 and after.starved >= before.starved
    assert Usage.of(0) == Usage(0.0, 0.0) and resident_bytes(0) == 0
    assert resident_bytes(os.getpid()) > 1e6
