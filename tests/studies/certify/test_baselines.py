"""Baselines that are asked for later: the same list, whoever asked for what, and when."""

from dataclasses import replace
from pathlib import Path

import pytest
from quick_bench import QuickCrew, verdict

from rtphys.assets.pack import Pack, default_pack
from rtphys.core.errors import UnknownName
from rtphys.results.instance_file import read_instances
from rtphys.results.instances import FIRST_SEED
from rtphys.studies.certify import CertifyPlan, Order, certify

TASK, PROTOCOL = "click_bell", "phys_random"
BOTH = ("replay", "twin")
GROUND = {"domain": {"name": "global", "digest": "0"}, "look": "", "assets": "", "versions": {}}


@pytest.fixture(scope="module")
def pack() -> Pack:
    return default_pack()


def order(out: Path, baselines: tuple[str, ...], feasible: int = 3, protocol=PROTOCOL) -> Order:
    plan = CertifyPlan((TASK,), (protocol,), out, feasible, baselines=baselines)
    return Order(plan, TASK, protocol, dict(GROUND))


def work(made: Order, most: int = 1000) -> list[tuple[int, tuple[str, ...]]]:
    """What a worker had to do: seed, baselines."""
    done = []
    while made.wants and len(done) < most:
        job = made.begin()
        done.append((job.recipe.seed - FIRST_SEED, job.baselines))
        made.take(verdict(job.recipe.seed, job.baselines))
    made.close()
    return done


@pytest.fixture
def whole(tmp_path: Path) -> bytes:
    made = order(tmp_path / "whole", BOTH)
    work(made)
    return made.path.read_bytes()


@pytest.mark.parametrize(
    "wishes",
    [
        [("replay",), ("twin",)],
        [("twin",), ("replay",)],
        [(), BOTH],
        [("twin", "replay")],
        [BOTH, (), ("replay",)],
    ],
)
@pytest.mark.parametrize("workers", [1, 3])
def test_the_order_of_wishes_does_not_matter(
    tmp_path: Path,
    pack: Pack,
    monkeypatch: pytest.MonkeyPatch,
    wishes: list[tuple[str, ...]],
    workers: int,
) -> None:
    monkeypatch.setattr("rtphys.studies.certify.run.Crew", QuickCrew)
    plan = CertifyPlan((TASK,), (PROTOCOL, "clean"), tmp_path, 4, workers=workers)
    at_once = certify(replace(plan, out=tmp_path / "whole", baselines=BOTH), pack)
    for number, wish in enumerate(wishes):
        grown = replace(plan, out=tmp_path / "grown", baselines=wish, feasible=3 + (number > 0))
        certify(grown if len(wishes) > 1 else replace(grown, feasible=4), pack)
    for made in at_once:
        other = tmp_path / "grown" / made.path.relative_to(tmp_path / "whole")
        assert other.read_bytes() == made.path.read_bytes()
    assert not list(tmp_path.rglob("*.journal"))


def test_only_what_lacks_is_measured(tmp_path: Path, whole: bytes) -> None:
    # Seeds 0, 1, 3 and 4 after 100000 are three feasible ones and an infeasible one, 2.
    assert work(order(tmp_path, ("replay",))) == [(n, ("replay",)) for n in range(4)]
    assert work(order(tmp_path, ("twin",))) == [(n, ("twin",)) for n in (0, 1, 3)]
    assert order(tmp_path, ()).path.read_bytes() == whole
    for known in ((), ("twin",), BOTH):
        assert work(order(tmp_path, known)) == []
    # A list that grows measures by all that it has, whatever is asked for now.
    assert work(order(tmp_path, ("twin",), 4)) == [(4, BOTH)]


def test_a_killed_run_goes_on_where_it_was(tmp_path: Path, whole: bytes) -> None:
    work(order(tmp_path, ("replay",)))
    before = read_instances(order(tmp_path, ("replay",)).path)
    assert work(order(tmp_path, ("twin",)), most=2) == [(0, ("twin",)), (1, ("twin",))]
    assert read_instances(order(tmp_path, ("twin",)).path) == before, "a list is replaced whole"
    assert work(order(tmp_path, ("twin",))) == [(3, ("twin",))]
    assert order(tmp_path, ()).path.read_bytes() == whole


def test_what_was_asked_for_before_a_kill_is_still_owed(tmp_path: Path, whole: bytes) -> None:
    assert work(order(tmp_path, ("twin",)), most=2) == [(0, ("twin",)), (1, ("twin",))]
    assert work(order(tmp_path, ("replay",))) == [
        (0, ("replay",)),
        (1, ("replay",)),
        (2, BOTH),
        (3, BOTH),
    ]
    assert order(tmp_path, ()).path.read_bytes() == whole


def test_a_crash_between_the_list_and_its_journal_changes_nothing(
    tmp_path: Path, whole: bytes
) -> None:
    made = order(tmp_path, ("twin",))
    work(made, most=2)
    (journal,) = tmp_path.rglob(".*.journal")
    early = journal.read_bytes()
    work(order(tmp_path, BOTH))
    for left in (early, early[:-9]):  # older than the list
        journal.write_bytes(left)
        after = order(tmp_path, BOTH)
        assert work(after) == [] and not journal.exists()
        assert after.path.read_bytes() == whole


def test_without_physics_there_is_no_twin_to_measure(tmp_path: Path) -> None:
    assert work(order(tmp_path, ("replay",), protocol="clean"))
    assert work(order(tmp_path, ("twin",), protocol="clean")) == []
    grown = read_instances(order(tmp_path, (), protocol="clean").path)
    assert grown.baselines == BOTH and {slot.twin for slot in grown.slots} == {None}


@pytest.mark.parametrize("now", [{"reason": "slipped", "state": ""}, {"state": "0123456789abcdef"}])
def test_rows_that_come_out_otherwise_are_not_added_to(tmp_path: Path, now: dict) -> None:
    made = order(tmp_path, ("replay",))
    work(made)
    before = made.path.read_bytes()
    again = order(tmp_path, ("twin",))
    job = again.begin()
    again.take(replace(verdict(job.recipe.seed, job.baselines), **now))
    again.close()
    assert again.over and "came out otherwise than in the list" in again.halted
    assert f"seed {job.recipe.seed}" in again.halted and str(made.path) in again.halted
    assert made.path.read_bytes() == before


def test_a_list_with_a_baseline_from_elsewhere_is_refused(tmp_path: Path) -> None:
    made = order(tmp_path, BOTH)
    work(made)
    text = made.path.read_text().replace('baselines: ["replay", "twin"]', 'baselines: ["twim"]')
    made.path.write_text(text)
    with pytest.raises(UnknownName, match=r"click_bell.yaml: unknown baseline 'twim'"):
        order(tmp_path, BOTH)
