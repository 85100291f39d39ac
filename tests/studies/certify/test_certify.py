"""Certification: the same lists whatever the number of workers and however often it is killed."""

import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import pytest
from rtphys.studies.certify.ledger import CertifiedOtherwise
from typer.testing import CliRunner

from rtphys.assets.pack import Pack, default_pack
from rtphys.cli.main import app
from rtphys.core.errors import BadValue, UnknownName
from rtphys.episode.generate import attempt
from rtphys.results.instance_file import instance_file, read_instances
from rtphys.results.instances import FIRST_SEED, Slot
from rtphys.setting.setting import Setting
from rtphys.studies.certify import CertifyPlan, Order, certify
from rtphys.task.spec import load_task

GROUND = {"domain": {"name": "nominal", "digest": "0"}, "look": "", "assets": "", "versions": {}}


@pytest.fixture(scope="module")
def pack() -> Pack:
    return default_pack()


def plan(out: Path, **changes) -> CertifyPlan:
    return replace(CertifyPlan(("click_bell",), ("clean",), out, 3), **changes)


def order(out: Path, **changes) -> Order:
    return Order(plan(out, **changes), "click_bell", "clean", dict(GROUND))


def good(seed: int) -> Slot:
    return Slot(FIRST_SEED + seed, "", f"{seed:016x}", True)


def bad(seed: int) -> Slot:
    return Slot(FIRST_SEED + seed, "unreachable")


def test_results_are_kept_in_the_order_of_seeds(tmp_path: Path) -> None:
    made = order(tmp_path, workers=4)
    for slot in (good(3), bad(0), good(2), good(1), good(4)):
        made.take(slot)
    made.close()
    kept = read_instances(instance_file(tmp_path, "clean", "click_bell"))
    # The third feasible seed ends the list: what was begun to be on the safe side is dropped.
    assert kept.slots == (bad(0), good(1), good(2), good(3))
    assert not list(tmp_path.rglob("*.journal"))


def test_it_goes_on_after_the_last_seed_that_was_written(tmp_path: Path) -> None:
    first = order(tmp_path)
    for slot in (good(0), bad(1), good(3)):  # seed 2 was under way when it was killed
        first.take(slot)
    second = order(tmp_path)
    assert second.slots == [good(0), bad(1)] and second.begin().recipe.seed == FIRST_SEED + 2
    second.take(good(2))
    second.take(good(3))
    second.close()
    whole = order(tmp_path)
    assert whole.complete and not whole.wants


def test_a_torn_line_is_forgotten(tmp_path: Path) -> None:
    order(tmp_path).take(good(0))
    (journal,) = tmp_path.rglob("*.journal")
    journal.write_bytes(journal.read_bytes()[:-7])
    assert order(tmp_path).slots == []


def test_a_finished_list_can_be_made_longer(tmp_path: Path) -> None:
    short = order(tmp_path, feasible=1)
    short.take(good(0))
    short.close()
    longer = order(tmp_path, feasible=2)
    assert longer.begin().recipe.seed == FIRST_SEED + 1
    longer.take(good(1))
    longer.close()
    kept = read_instances(instance_file(tmp_path, "clean", "click_bell"))
    assert kept.slots == (good(0), good(1))


def test_a_crash_between_the_list_and_its_journal_repeats_no_seed(tmp_path: Path) -> None:
    made = order(tmp_path, feasible=1)
    made.take(good(0))
    (journal,) = tmp_path.rglob("*.journal")
    left = journal.read_bytes()
    made.close()
    journal.write_bytes(left)
    assert order(tmp_path, feasible=2).slots == [good(0)]


@pytest.mark.parametrize("closed", [True, False])
def test_other_ground_is_refused(tmp_path: Path, closed: bool) -> None:
    made = order(tmp_path, feasible=1)
    made.take(good(0))
    if closed:
        made.close()
    with pytest.raises(CertifiedOtherwise, match="first_seed was 100000, now 7"):
        order(tmp_path, first_seed=7)
    made = plan(tmp_path)
    with pytest.raises(CertifiedOtherwise, match="assets was '', now 'else'"):
        Order(made, "click_bell", "clean", {**GROUND, "assets": "else"})


def test_it_gives_up_and_says_why(tmp_path: Path) -> None:
    made = order(tmp_path, most_attempts=2)
    made.take(bad(0))
    made.take(bad(1))
    made.close()
    assert "2 seeds were tried" in made.stopped and made.path.is_file()
    assert read_instances(made.path).rejected == {"unreachable": 2}


def test_what_cannot_be_is_refused_before_any_work(tmp_path: Path) -> None:
    with pytest.raises(UnknownName, match="did you mean 'twin'"):
        plan(tmp_path, baselines=("twim",)).check()
    with pytest.raises(UnknownName, match="did you mean 'clean'"):
        plan(tmp_path, protocols=("clear",)).check()
    with pytest.raises(BadValue, match="--feasible"):
        plan(tmp_path, feasible=0).check()


@pytest.mark.sim
def test_lists_do_not_depend_on_workers_or_wishes_and_say_what_the_expert_does(
    tmp_path: Path, pack: Pack
) -> None:
    at_once = plan(tmp_path / "at once", protocols=("phys_random",), feasible=2)
    certify(at_once, pack)
    grown = replace(at_once, out=tmp_path / "grown", workers=2)
    certify(replace(grown, feasible=1, baselines=("twin",)), pack)
    certify(replace(grown, baselines=("replay",)), pack)
    place = instance_file(at_once.out, "phys_random", "click_bell")
    other = instance_file(grown.out, "phys_random", "click_bell")
    assert place.read_bytes() == other.read_bytes()
    for slot in read_instances(place).feasible:
        tried = attempt(
            Setting("click_bell", "phys_random").at(slot.seed), load_task("click_bell"), pack
        )
        assert tried.accepted and tried.recording is not None
        assert tried.recording.hash.startswith(slot.state)
        assert slot.replay is not None and slot.twin is not None


@pytest.mark.sim
def test_pictures_on_the_table_do_not_decide_what_is_feasible(pack: Pack) -> None:
    task = load_task("click_bell")
    seen, unseen = (
        attempt(Setting("click_bell", "official_random", split=split).at(FIRST_SEED), task, pack)
        for split in ("seen", "unseen")
    )
    assert seen.recording is not None and unseen.recording is not None
    assert seen.recording.hash == unseen.recording.hash


@pytest.mark.sim
@pytest.mark.slow
def test_a_killed_run_ends_up_with_the_same_lists(tmp_path: Path, pack: Pack) -> None:
    whole, killed = tmp_path / "whole", tmp_path / "killed"
    options = ["--task", "click_bell", "--protocol", "clean", "--feasible", "8", "--workers", "1"]
    command = [sys.executable, "-m", "rtphys.cli.main", "certify", *options, "--out"]
    subprocess.run([*command, str(whole)], check=True, capture_output=True)
    process = subprocess.Popen([*command, str(killed)], stderr=subprocess.DEVNULL)
    journal = killed / "clean" / ".click_bell.journal"
    while not (journal.is_file() and journal.read_bytes().count(b"\n") > 2):
        assert process.poll() is None, "it ended before it could be killed"
        time.sleep(0.05)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    assert not instance_file(killed, "clean", "click_bell").exists()
    subprocess.run([*command, str(killed)], check=True, capture_output=True)
    one, other = (instance_file(out, "clean", "click_bell") for out in (whole, killed))
    assert one.read_bytes() == other.read_bytes()


@pytest.mark.sim
def test_the_command(tmp_path: Path) -> None:
    options = ["--task", "click_bell", "--protocol", "clean", "--feasible", "1"]
    done = CliRunner().invoke(app, ["certify", *options, "--out", str(tmp_path), "--workers", "1"])
    assert done.exit_code == 0, done.output
    assert "1 / 1" in done.output  # replay
    assert len(read_instances(instance_file(tmp_path, "clean", "click_bell")).feasible) == 1
