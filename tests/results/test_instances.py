"""Certified lists in memory: counts, first episodes, fingerprint."""

from rtphys.results.instances import FIRST_SEED, Fingerprint, InstanceList, Slot

SLOTS = (
    Slot(100000, "", "0123456789012345", True),
    Slot(100001, "unreachable"),
    Slot(100002, "", "0e12345678901234", False),
    Slot(100003, "slipped"),
    Slot(100004, "unreachable"),
)
LIST = InstanceList("click_bell", "phys_random", {}, SLOTS)


def test_the_first_episodes_keep_the_attempts_they_took() -> None:
    part = LIST.first(2)
    assert [slot.seed for slot in part.slots] == [100000, 100001, 100002]
    assert (part.attempts, len(part.feasible)) == (3, 2)
    assert LIST.first(9).slots == SLOTS


def test_counts() -> None:
    assert LIST.rejected == {"unreachable": 2, "slipped": 1}
    assert LIST.first_seed == 100000
    assert InstanceList("click_bell", "clean", {}, ()).first_seed == FIRST_SEED


def test_a_fingerprint_is_nested_and_sorted() -> None:
    fingerprint = Fingerprint("global", "d" * 64, "", "a" * 64, {"task": "1", "dataset": "1.0"})
    data = fingerprint.to_json()
    assert data["domain"] == {"name": "global", "digest": "d" * 64}
    assert list(data) == ["domain", "look", "assets", "versions"]
    assert list(data["versions"]) == ["dataset", "task"]  # type: ignore[arg-type]
