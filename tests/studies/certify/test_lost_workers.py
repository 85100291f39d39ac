"""A seed that takes its workers with it: no verdict, no list, and the same list in the end."""

from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest
from pool_jobs import Trouble
from quick_bench import LOST, CrashingCrew, HangingCrew, QuickBench, QuickCrew, verdict
from typer.testing import CliRunner

from rtphys.assets.pack import Pack, default_pack
from rtphys.cli.main import app
from rtphys.data.journal import read_journal
from rtphys.results.instance_file import instance_file, write_instances
from rtphys.results.instances import FIRST_SEED, InstanceList, Slot
from rtphys.studies.certify import CertifyPlan, Order, certify

TASK = "click_bell"
GROUND = {"domain": {"name": "nominal", "digest": "0"}, "look": "", "assets": "", "versions": {}}


@pytest.fixture(scope="module")
def pack() -> Pack:
    return default_pack()


def plan(out: Path, **changes) -> CertifyPlan:
    return replace(CertifyPlan((TASK,), ("clean", "phys_random"), out, 6), **changes)


def lists(out: Path) -> dict[str, bytes]:
    return {str(path.relative_to(out)): path.read_bytes() for path in sorted(out.rglob("*.yaml"))}


def run(monkeypatch: pytest.MonkeyPatch, wanted: CertifyPlan, pack: Pack, crew: type[QuickCrew]):
    monkeypatch.setattr("rtphys.studies.certify.run.Crew", crew)
    return {order.protocol: order for order in certify(wanted, pack)}


@pytest.mark.parametrize("workers", [1, 3])
@pytest.mark.parametrize(
    ("crew", "reason"), [(CrashingCrew, "worker_crash"), (HangingCrew, "worker_hang")]
)
def test_a_lost_worker_is_no_verdict(
    tmp_path: Path,
    pack: Pack,
    monkeypatch: pytest.MonkeyPatch,
    crew: type[QuickCrew],
    reason: str,
    workers: int,
) -> None:
    out = tmp_path / "out"
    first = run(monkeypatch, plan(out, workers=workers), pack, crew)
    clean, other = first["clean"], first["phys_random"]
    told = f"seed {LOST}: {reason}: the last worker that tried it was killed by SIGKILL"
    assert told in clean.halted and str(clean.path) in clean.halted
    assert not clean.path.exists() and other.whole and other.path.exists()
    # What was finished before is kept; what is behind the seed without a verdict is not.
    (journal,) = out.rglob(".*.journal")
    entries = [line.entry for line in read_journal(journal).lines]
    assert [entry["seed"] for entry in entries[1:]] == [*range(FIRST_SEED, LOST)]

    second = run(monkeypatch, plan(out), pack, QuickCrew)
    assert second["clean"].whole and not second["clean"].halted
    run(monkeypatch, plan(tmp_path / "calm"), pack, QuickCrew)
    assert lists(out) == lists(tmp_path / "calm") and len(lists(out)) == 2
    assert not list(out.rglob("*.journal"))


def test_the_command_names_the_seed_and_fails(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("rtphys.studies.certify.run.Crew", CrashingCrew)
    options = ["--task", TASK, "--protocol", "clean", "--feasible", "6", "--workers", "1"]
    done = CliRunner().invoke(app, ["certify", *options, "--out", str(tmp_path)])
    told = " ".join(done.output.split())
    assert done.exit_code == 4, told
    assert f"{TASK}, clean: seed {LOST}: worker_crash" in told and "SIGKILL" in told
    assert "the same command tries it again" in told


@pytest.mark.slow
def test_real_workers_that_die_on_a_seed(
    tmp_path: Path, pack: Pack, monkeypatch: pytest.MonkeyPatch
) -> None:
    dying = partial(QuickBench, trouble=Trouble("abort"))
    monkeypatch.setattr("rtphys.studies.certify.run.Bench", dying)
    (made,) = certify(plan(tmp_path, protocols=("clean",)), pack)
    assert f"seed {LOST}: worker_crash" in made.halted and "SIGABRT" in made.halted
    assert [slot.seed for slot in made.slots] == [*range(FIRST_SEED, LOST)]


def order(out: Path, **changes) -> Order:
    made = CertifyPlan((TASK,), ("clean",), out, **changes)
    return Order(made, TASK, "clean", dict(GROUND))


def test_a_lost_seed_past_the_last_one_needed_does_not_matter(tmp_path: Path) -> None:
    made = order(tmp_path, feasible=2, workers=4, baselines=())
    seeds = [made.begin().recipe.seed for _ in range(4)]
    made.lose(seeds[3], "worker_crash", "was killed by SIGKILL")
    assert not made.wants and not made.over, "earlier seeds are still under way"
    for seed in seeds[:3]:
        made.take(verdict(seed, ()))
    made.close()
    assert made.whole and not made.halted and made.path.is_file()


def test_a_seed_that_was_once_called_infeasible_for_its_worker_is_tried_again(
    tmp_path: Path,
) -> None:
    made = [verdict(FIRST_SEED + n, ()) for n in range(6)]
    made[2] = Slot(FIRST_SEED + 2, "worker_crash")
    place = instance_file(tmp_path, "clean", TASK)
    write_instances(place, InstanceList(TASK, "clean", GROUND, tuple(made)))
    again = order(tmp_path, feasible=4, baselines=())
    assert again.slots == made[:2] and again.begin().recipe.seed == FIRST_SEED + 2
    for n in range(2, 6):
        again.take(verdict(FIRST_SEED + n, ()))
    again.close()
    whole = order(tmp_path / "whole", feasible=4, baselines=())
    for n in range(6):
        whole.take(verdict(FIRST_SEED + n, ()))
    whole.close()
    assert place.read_bytes() == whole.path.read_bytes()
