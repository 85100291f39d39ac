"""Certified lists: the same whatever the workers, the wishes and the kills; reproving them."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import pytest
from evaluations import FINGERPRINT
from quick_pool import J, QuickPool, R
from typer.testing import CliRunner

from pages import ran
from rtphys.assets.pack import Pack
from rtphys.campaign import local
from rtphys.cli.main import app
from rtphys.core.errors import BadValue, UnknownName
from rtphys.data.faults import DatasetMismatch
from rtphys.data.ledger import read_rows
from rtphys.episode.fingerprint import fingerprint_of
from rtphys.episode.generate import attempt
from rtphys.results.instances import (
    FIRST_SEED,
    BenchmarkInstance,
    InstanceList,
    list_file,
    read_list,
    write_lists,
)
from rtphys.spec.episode import EpisodeSpec, Recipe
from rtphys.studies import certify as module
from rtphys.studies.certify import (
    CertificationSeries,
    CertificationTask,
    MeasuredInstance,
    certify,
    reprove,
)
from rtphys.studies.requests import CertificationRun, CertificationSpec
from rtphys.task.spec import load_task

TASK, PROTOCOL = "click_bell", "phys_random"
BOTH = ("replay", "twin")
LOST = FIRST_SEED + 4  # the seed whose worker gets into trouble, when clean


Wish = tuple[CertificationSpec, CertificationRun]


def wish(out: Path, **changes) -> Wish:
    own = {key: changes.pop(key) for key in ("first_seed", "feasible", "max_attempts", "replays")
           if key in changes}  # fmt: skip
    spec = replace(CertificationSpec(feasible=3), **own)
    return spec, replace(CertificationRun((TASK,), (PROTOCOL,), out), **changes)


def opened(out: Path, replays: tuple[str, ...] = BOTH, **changes) -> CertificationSeries:
    template, run = wish(out, replays=replays, **changes)
    (spec,) = run.specs(template)
    return CertificationSeries(out, spec, FINGERPRINT)


def listed(out: Path, protocol: str = PROTOCOL) -> InstanceList:
    found = read_list(list_file(out, protocol), TASK)
    assert found is not None
    return found


def verdict(seed: int, replays: tuple[str, ...]) -> BenchmarkInstance:
    """Every third seed is infeasible; the others' columns differ from each other."""
    if seed % 3 == 0:
        return BenchmarkInstance(seed, "slipped")
    replay = seed % 2 == 0 if "replay" in replays else None
    twin = seed % 5 == 0 if "twin" in replays else None
    return BenchmarkInstance(seed, "", f"{seed:016x}", replay, twin)


def work(made: CertificationSeries, most: int = 1000) -> list[tuple[int, tuple[str, ...]]]:
    """Does at most so many jobs; returns what each was: seed after the first, replays."""
    done = []
    while made.wants(1) and len(done) < most:
        job = made.job(made.begin())
        done.append((job.recipe.seed - FIRST_SEED, job.replays))
        made.take(job.recipe.seed, verdict(job.recipe.seed, job.replays))
    made.close_if_over()
    return done


def take(made: CertificationSeries, *rows: BenchmarkInstance) -> None:
    """What comes back from workers, each of them busy."""
    while len(made.running) < len(rows):
        made.begin()
    for one in rows:
        made.take(one.seed, one)
    made.close_if_over()


def good(seed: int) -> BenchmarkInstance:
    return BenchmarkInstance(FIRST_SEED + seed, "", f"{seed:016x}", True, False)


def bad(seed: int) -> BenchmarkInstance:
    return BenchmarkInstance(FIRST_SEED + seed, "unreachable")


# ---- one list in the making ----------------------------------------------------------------------


def test_results_are_kept_in_the_order_of_seeds(tmp_path: Path) -> None:
    take(opened(tmp_path), good(3), bad(0), good(2), good(1), good(4))
    # The third feasible seed ends the list: what was begun to be on the safe side is dropped.
    assert listed(tmp_path).instances == (bad(0), good(1), good(2), good(3))
    assert not list(tmp_path.rglob("*.ledger"))


def test_it_goes_on_after_the_last_seed_that_was_written(tmp_path: Path) -> None:
    take(opened(tmp_path), good(0), bad(1), good(3))  # seed 2 was under way when it was killed
    second = opened(tmp_path)
    assert second.instances.instances == (good(0), bad(1))
    assert second.begin() == FIRST_SEED + 2
    take(second, good(2), good(3))
    whole = opened(tmp_path)
    assert whole.whole and whole.progress.done and not whole.wants(1)


def test_a_finished_list_can_be_made_longer(tmp_path: Path) -> None:
    take(opened(tmp_path, feasible=1), good(0))
    longer = opened(tmp_path, feasible=2)
    assert longer.begin() == FIRST_SEED + 1
    take(longer, good(1))
    assert listed(tmp_path).instances == (good(0), good(1))


@pytest.mark.parametrize("closed", [True, False])
def test_another_fingerprint_is_refused(tmp_path: Path, closed: bool) -> None:
    made = opened(tmp_path, feasible=1)
    made.take(made.begin(), good(0))
    if closed:
        made.close_if_over()
    assert made.path.exists() is closed
    with pytest.raises(DatasetMismatch, match="first_seed was 100000, now 7"):
        opened(tmp_path, first_seed=7)
    other = FINGERPRINT.model_copy(update={"assets": "else"})
    with pytest.raises(DatasetMismatch, match="assets was '', now 'else'"):
        CertificationSeries(tmp_path, made.spec, other)


def test_a_hopeless_list_is_given_up_wherever_it_was_killed(tmp_path: Path) -> None:
    made = opened(tmp_path)
    for _ in range(3):
        made = opened(tmp_path)
        for _ in range(80):
            if made.wants(1):
                seed = made.begin()
                made.take(seed, BenchmarkInstance(seed, "unreachable"))
        made.close_if_over()
    assert "none of the last 200" in made.progress.stopped
    assert listed(tmp_path).attempts == 200


def test_what_cannot_be_is_refused_before_any_work(tmp_path: Path) -> None:
    with pytest.raises(UnknownName, match="did you mean 'twin'"):
        wish(tmp_path, replays=("twim",))
    with pytest.raises(UnknownName, match="did you mean 'clean'"):
        wish(tmp_path, protocols=("clear",))
    with pytest.raises(BadValue, match=r"feasible = 0 .*at least 1"):
        wish(tmp_path, feasible=0)


# ---- replays that are asked for later ----------------------------------------------------------


@pytest.fixture
def whole(tmp_path: Path) -> bytes:
    made = opened(tmp_path / "whole")
    work(made)
    return made.path.read_bytes()


def test_only_what_lacks_is_measured(tmp_path: Path, whole: bytes) -> None:
    # Seeds 0, 1, 3 and 4 after 100000 are three feasible ones and an infeasible one, 2.
    assert work(opened(tmp_path, ("replay",))) == [(n, ("replay",)) for n in range(4)]
    assert work(opened(tmp_path, ("twin",))) == [(n, ("twin",)) for n in (0, 1, 3)]
    assert opened(tmp_path, ()).path.read_bytes() == whole
    for known in ((), ("twin",), BOTH):
        assert work(opened(tmp_path, known)) == []
    # A list that grows measures by all that it has, whatever is asked for now.
    assert work(opened(tmp_path, ("twin",), feasible=4)) == [(4, BOTH)]


def test_a_killed_run_goes_on_where_it_was(tmp_path: Path, whole: bytes) -> None:
    work(opened(tmp_path, ("replay",)))
    before = listed(tmp_path)
    assert work(opened(tmp_path, ("twin",)), most=2) == [(0, ("twin",)), (1, ("twin",))]
    assert listed(tmp_path) == before, "a list is replaced whole"
    assert work(opened(tmp_path, ("twin",))) == [(3, ("twin",))]
    assert list_file(tmp_path, PROTOCOL).read_bytes() == whole


def test_what_was_asked_for_before_a_kill_is_still_owed(tmp_path: Path, whole: bytes) -> None:
    assert work(opened(tmp_path, ("twin",)), most=2) == [(0, ("twin",)), (1, ("twin",))]
    owed = [(0, ("replay",)), (1, ("replay",)), (2, BOTH), (3, BOTH)]
    assert work(opened(tmp_path, ("replay",))) == owed
    assert list_file(tmp_path, PROTOCOL).read_bytes() == whole


def test_a_crash_between_the_list_and_its_journal_changes_nothing(
    tmp_path: Path, whole: bytes
) -> None:
    work(opened(tmp_path, ("twin",)), most=2)
    (journal,) = tmp_path.rglob(".*.ledger")
    early = journal.read_bytes()
    work(opened(tmp_path, BOTH))
    for left in (early, early[:-9]):  # older than the list
        journal.write_bytes(left)
        after = opened(tmp_path, BOTH)
        assert work(after) == [] and not journal.exists()
        assert after.path.read_bytes() == whole


def test_without_physics_there_is_no_twin_to_measure(tmp_path: Path) -> None:
    clean = ("clean",)
    assert work(opened(tmp_path, ("replay",), protocols=clean))
    assert work(opened(tmp_path, ("twin",), protocols=clean)) == []
    grown = listed(tmp_path, "clean")
    assert grown.replays == BOTH and {one.twin for one in grown.instances} == {None}


@pytest.mark.parametrize("now", [{"reason": "slipped", "state": ""}, {"state": "0123456789abcdef"}])
def test_rows_that_come_out_otherwise_are_not_added_to(tmp_path: Path, now: dict) -> None:
    work(opened(tmp_path, ("replay",)))
    before = list_file(tmp_path, PROTOCOL).read_bytes()
    again = opened(tmp_path, ("twin",))
    seed = again.begin()
    again.take(seed, verdict(seed, again.job(seed).replays)._replace(**now))
    again.close_if_over()
    halted = again.halted
    assert again.over and "came out otherwise than in the list" in halted
    assert f"seed {seed}" in halted and str(again.path) in halted
    assert again.path.read_bytes() == before


def test_a_list_with_a_replay_from_elsewhere_is_refused(tmp_path: Path) -> None:
    made = opened(tmp_path, BOTH)
    work(made)
    text = made.path.read_text().replace('["replay", "twin"], "col', '["twim"], "col')
    made.path.write_text(text)
    with pytest.raises(UnknownName, match=r"phys_random.jsonl: unknown open-loop replay 'twim'"):
        opened(tmp_path, BOTH)


# ---- whole runs, whose workers need no simulator -------------------------------------------------


def unlucky(recipe: Recipe) -> bool:
    return (recipe.seed, recipe.spec.protocol) == (LOST, "clean")


@dataclass(frozen=True)
class QuickCertifier:
    """In the place of `CertifyWorker`."""

    pack: Pack

    def __call__(self) -> Callable[[CertificationTask], BenchmarkInstance]:
        return self.do

    def do(self, job: CertificationTask) -> BenchmarkInstance:
        return verdict(job.recipe.seed, job.replays)


class CrashingPool(QuickPool[J, R]):
    reason = "worker_crash"

    def loss(self, job: J) -> str:
        assert isinstance(job, CertificationTask)
        return self.reason if unlucky(job.recipe) else ""


class HangingPool(CrashingPool[J, R]):
    reason = "worker_hang"


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> Callable[[type[QuickPool]], None]:
    """Gives runs a pool without processes, and a worker without a simulator."""

    def use(pool: type[QuickPool]) -> None:
        monkeypatch.setattr(module, "CertifyWorker", QuickCertifier)
        monkeypatch.setattr(local, "LocalPool", pool)

    return use


def lists_in(out: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in sorted(out.glob("*.jsonl"))}


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
    tmp_path: Path, pack: Pack, quick, wishes: list[tuple[str, ...]], workers: int
) -> None:
    quick(QuickPool)
    tasks, protocols = (TASK, "lift_pot"), (PROTOCOL, "clean")
    run = CertificationRun(tasks, protocols, tmp_path / "whole", workers=workers)
    certify(CertificationSpec(feasible=4), run, pack)
    for number, replays in enumerate(wishes):
        feasible = 3 if len(wishes) > 1 and number == 0 else 4
        grown = CertificationSpec(feasible=feasible, replays=replays)
        certify(grown, replace(run, out=tmp_path / "grown"), pack)
    assert lists_in(tmp_path / "grown") == lists_in(tmp_path / "whole")
    assert len(lists_in(tmp_path / "whole")) == 2 and not list(tmp_path.rglob("*.ledger"))


@pytest.mark.parametrize("workers", [1, 3])
@pytest.mark.parametrize("pool", [CrashingPool, HangingPool])
def test_a_lost_worker_is_no_verdict(
    tmp_path: Path, pack: Pack, quick, pool: type[CrashingPool], workers: int
) -> None:
    spec, run = wish(tmp_path / "out", protocols=("clean", PROTOCOL), feasible=6, workers=workers)
    quick(pool)
    clean, other = certify(spec, run, pack)
    cause = f"seed {LOST}: {pool.reason}: the last worker that tried it was killed by SIGKILL"
    assert cause in clean.halted and str(clean.path) in clean.halted
    assert not clean.path.exists() and other.whole and other.path.exists()
    # What was finished before is kept; what is behind the seed without a verdict is not.
    (journal,) = run.out.rglob(".*.ledger")
    rows = read_rows(MeasuredInstance, journal)
    assert [row.instance.seed for row in rows] == [*range(FIRST_SEED, LOST)]

    quick(QuickPool)
    second, _ = certify(spec, run, pack)
    assert second.whole and not second.halted
    certify(spec, replace(run, out=tmp_path / "calm"), pack)
    assert lists_in(run.out) == lists_in(tmp_path / "calm") and len(lists_in(run.out)) == 2
    assert not list(run.out.rglob("*.ledger"))


def test_the_command_names_the_seed_and_fails(tmp_path: Path, quick) -> None:
    quick(CrashingPool)
    options = ["--task", TASK, "--protocol", "clean", "--feasible", "6", "--workers", "1"]
    done = CliRunner().invoke(app, ["certify", *options, "--out", str(tmp_path)])
    said = " ".join(done.output.split())
    assert done.exit_code == 4, said
    assert f"{TASK}, clean: seed {LOST}: worker_crash" in said and "SIGKILL" in said
    assert "the same command tries it again" in said


def test_one_factor_has_lists_where_it_acts(tmp_path: Path) -> None:
    tasks, protocols = (TASK, "open_laptop"), ("only_object_joint_damping", "only_friction")
    template, run = wish(tmp_path, tasks=tasks, protocols=protocols)
    assert [(s.episode.task, s.episode.protocol) for s in run.specs(template)] == [
        ("open_laptop", "only_object_joint_damping"),
        ("click_bell", "only_friction"),
        ("open_laptop", "only_friction"),
    ]
    assert run.left_out() == ["click_bell, only_object_joint_damping"]
    template, run = wish(tmp_path, protocols=("only_camera_angle", "only_camera_distance"))
    assert len([*run.specs(template)]) == 2 and not run.left_out()
    suite = {"tasks": ("heavy_below",), "protocols": ("only_object_mass", "only_friction")}
    _, run = wish(tmp_path, **suite)  # each of its blocks has a mass of its own
    assert run.left_out() == ["heavy_below, only_object_mass"]


# ---- whole runs with the expert ------------------------------------------------------------------


@pytest.mark.processes
@pytest.mark.sim
def test_lists_do_not_depend_on_workers_or_wishes_and_say_what_the_expert_does(
    tmp_path: Path, pack: Pack
) -> None:
    first, other = tmp_path / "first", tmp_path / "other"
    certify(*wish(first, feasible=2, workers=1), pack)
    certify(*wish(other, feasible=1, replays=("twin",), workers=2), pack)
    certify(*wish(other, feasible=2, replays=("replay",), workers=2), pack)
    assert lists_in(first) == lists_in(other)
    for one in listed(first).feasible:
        tried = attempt(EpisodeSpec(TASK, PROTOCOL).at(one.seed), load_task(TASK), pack)
        assert tried.accepted and tried.recording is not None
        assert tried.recording.hash.startswith(one.state)
        assert one.replay is not None and one.twin is not None


@pytest.mark.sim
def test_pictures_on_the_table_do_not_decide_what_is_feasible(pack: Pack) -> None:
    task = load_task(TASK)
    seen, unseen = (
        attempt(EpisodeSpec(TASK, "official_random", split=split).at(FIRST_SEED), task, pack)
        for split in ("seen", "unseen")
    )
    assert seen.recording is not None and unseen.recording is not None
    assert seen.recording.hash == unseen.recording.hash


@pytest.mark.processes
@pytest.mark.sim
@pytest.mark.slow
def test_a_killed_run_ends_up_with_the_same_lists(tmp_path: Path) -> None:
    whole, killed = tmp_path / "whole", tmp_path / "killed"
    options = ["--task", TASK, "--protocol", "clean", "--feasible", "8", "--workers", "1"]
    command = [sys.executable, "-m", "rtphys.cli.main", "certify", *options, "--out"]
    subprocess.run([*command, str(whole)], check=True, capture_output=True)
    process = subprocess.Popen([*command, str(killed)], stderr=subprocess.DEVNULL)
    journal = killed / f".clean.{TASK}.ledger"
    while not (journal.is_file() and journal.read_bytes().count(b"\n") > 2):
        assert process.poll() is None, "it ended before it could be killed"
        time.sleep(0.05)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    assert not lists_in(killed)
    subprocess.run([*command, str(killed)], check=True, capture_output=True)
    assert lists_in(killed) == lists_in(whole)


@pytest.mark.sim
def test_the_command(tmp_path: Path) -> None:
    options = ["--task", TASK, "--protocol", "clean", "--feasible", "1"]
    done = ran(["certify", *options, "--out", str(tmp_path), "--workers", "1"])
    assert "1 / 1" in done.output  # replay
    assert len(listed(tmp_path, "clean").feasible) == 1


# ---- stale lists are proved again ----------------------------------------------------------------


@pytest.fixture(scope="module")
def benchmark(tmp_path_factory: pytest.TempPathFactory, pack: Pack) -> Path:
    out = tmp_path_factory.mktemp("benchmark")
    certify(*stale_wish(out), pack)
    return out


def stale_wish(out: Path, reproofs: int = 0) -> Wish:
    few = {"feasible": 2, "replays": ("none",), "workers": 1}
    return wish(out, protocols=("clean",), reprove=reproofs, **few)


def age(out: Path, state: str = "") -> bytes:
    """Makes a list stale, and its first state another one; returns the bytes of before."""
    path, known = list_file(out, "clean"), listed(out, "clean")
    before = path.read_bytes()
    old = known.fingerprint.model_copy(update={"versions": {"code": "of another day"}})
    first, *rest = known.instances
    rows = (first._replace(state=state or first.state), *rest)
    write_lists(path, [replace(known, fingerprint=old, instances=rows)])
    return before


@pytest.mark.sim
def test_a_stale_list_that_holds_gets_the_present_fingerprint_and_nothing_else(
    benchmark: Path, pack: Pack
) -> None:
    before = age(benchmark)
    (study,) = reprove(*stale_wish(benchmark, 1), pack)
    assert study.stale and study.renewed and study.solved == 1 and not study.differences
    assert list_file(benchmark, "clean").read_bytes() == before
    assert listed(benchmark, "clean").fingerprint == fingerprint_of(load_task(TASK), "clean", pack)


@pytest.mark.sim
def test_a_list_that_differs_stays_stale_and_is_named(benchmark: Path) -> None:
    before = age(benchmark, state="0" * 16)
    path = list_file(benchmark, "clean")
    damaged = path.read_bytes()
    words = ["certify", "--task", TASK, "--protocol", "clean", "--out", str(benchmark)]
    done = ran([*words, "--reprove", "2", "--workers", "1"], 1)
    assert "clean.jsonl: click_bell, seed 100000: now state" in done.stdout
    assert "0 of 1 list hold (2 instances solved again); 0 have a new header, 1 stay stale" in (
        " ".join(done.stdout.split())
    )
    as_json = ran([*words, "--reprove", "2", "--workers", "1", "--json"], 1)
    (row,) = json.loads(as_json.stdout)
    assert (row["task"], row["protocol"], row["solved"], row["stale"]) == (TASK, "clean", 2, True)
    assert len(row["differences"]) == 1 and not row["renewed"]
    assert path.read_bytes() == damaged
    path.write_bytes(before)


def test_no_replay_beside_one_is_refused() -> None:
    with pytest.raises(BadValue, match="none stands alone"):
        CertificationSpec(replays=("none", "replay"))


def test_a_folder_without_lists_is_refused(tmp_path: Path, pack: Pack) -> None:
    with pytest.raises(BadValue, match="lists of these tasks"):
        reprove(*stale_wish(tmp_path, 1), pack)
