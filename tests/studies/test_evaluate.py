"""Evaluation: the same records on every run, whatever the policy and the machine do."""

import json
import os
import signal
import subprocess
import sys
import time
from contextlib import nullcontext
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest
import synthetic
from collected import collect
from counting import Ears
from evaluations import FINGERPRINT, instances, write_results
from still_life import FEW
from typer.testing import CliRunner

from pages import ran
from rtphys.assets.pack import Pack
from rtphys.campaign.pool import WorkerError, WorkerFailure
from rtphys.campaign.series import Listener
from rtphys.cli.main import app
from rtphys.core.errors import BadFile, BadValue, RtphysError, UnknownName
from rtphys.data.dataset import Dataset
from rtphys.data.faults import DatasetMismatch
from rtphys.data.rewrite import subset
from rtphys.data.video import probe
from rtphys.data.writer import DatasetWriter, Rejection
from rtphys.episode.fingerprint import fingerprint_of
from rtphys.physics import load_domain
from rtphys.policies import PolicySetup
from rtphys.results import EpisodeRecord, read_results
from rtphys.results.evaluation import (
    SUMMARY,
    EvaluationHeader,
    EvaluationSpec,
    ledger_file,
)
from rtphys.results.instances import (
    FIRST_SEED,
    BenchmarkInstance,
    InstanceList,
    list_file,
    read_list,
    write_lists,
)
from rtphys.results.statistics import Rate
from rtphys.results.summary import Counts, summarise
from rtphys.spec.episode import EpisodeSpec
from rtphys.spec.recording import RecordingSpec
from rtphys.studies import evaluate as module
from rtphys.studies.certify import CertificationTask, CertifyWorker
from rtphys.studies.evaluate import (
    EvaluateWorker,
    EvaluationResult,
    EvaluationSeries,
    EvaluationTask,
    evaluate,
    recording_header,
)
from rtphys.studies.requests import EvaluationRun
from rtphys.task.spec import load_task

TASK, PROTOCOLS = "click_bell", ("clean", "phys_random")
SEEDS = (FIRST_SEED, FIRST_SEED + 2)  # the one between them is infeasible


# ---- one task under one protocol -----------------------------------------------------------------


MANY = [FIRST_SEED, FIRST_SEED + 2, FIRST_SEED + 3]  # the one between them is infeasible
IDLE = EvaluationHeader(EvaluationSpec("idle").of("clean", "lift_pot"), FINGERPRINT)


def opened(out: Path, episodes: int = 3, **wanted) -> EvaluationSeries:
    rows = tuple(
        BenchmarkInstance(seed, "" if seed in MANY else "slipped")
        for seed in range(MANY[0], MANY[-1] + 1)
    )
    listed = InstanceList("lift_pot", "clean", FINGERPRINT, rows)
    return EvaluationSeries(out, IDLE, listed.first(episodes), **wanted)


def record(seed: int, success: bool = False, **known) -> EpisodeRecord:
    return EpisodeRecord("lift_pot", "clean", seed, success, steps=seed % 7, **known)


def take(made: EvaluationSeries, *seeds: int) -> None:
    while len(made.running) < len(seeds):
        made.begin()
    for seed in seeds:
        made.take(seed, EvaluationResult(record(seed)))
    made.close_if_over()


@pytest.mark.parametrize("torn", [b"", b"0123", b'0123 {"task"'])
def test_a_kill_loses_no_record(tmp_path: Path, torn: bytes) -> None:
    take(opened(tmp_path), MANY[0], MANY[2])  # the one between was under way
    path = ledger_file(tmp_path, *IDLE.spec.key)
    path.write_bytes(path.read_bytes() + torn)
    again = opened(tmp_path)
    assert again.progress.accepted - again.progress.new_accepted == 1
    assert again.begin() == MANY[1]
    take(again, MANY[1], MANY[2])
    take(opened(tmp_path / "whole"), *MANY)
    assert path.read_bytes() == ledger_file(tmp_path / "whole", *IDLE.spec.key).read_bytes()


def test_fewer_episodes_leave_the_others_there(tmp_path: Path) -> None:
    take(opened(tmp_path), *MANY)
    fewer = opened(tmp_path, 1)
    assert fewer.over
    assert [one.seed for one in fewer.records] == MANY[:1]
    fewer.close_if_over()
    assert [one.seed for one in opened(tmp_path).records] == MANY


def test_a_figure_of_more_episodes_does_not_stay_beside_a_summary_of_fewer(tmp_path: Path) -> None:
    stale = [tmp_path / f"attributes_{name}.png" for name in ("clean", "phys_random")]
    for figure in stale:
        figure.write_bytes(b"of more episodes, or of another protocol")
    take(fewer := opened(tmp_path, 1), MANY[0])
    module._conclude(tmp_path, IDLE.spec, [fewer])
    assert json.loads((tmp_path / SUMMARY).read_text())["attributes"] == {"clean": []}
    assert not any(figure.exists() for figure in stale)


def test_records_of_other_instances_are_refused(tmp_path: Path) -> None:
    take(opened(tmp_path), *MANY)
    rows = (BenchmarkInstance(MANY[1]),)
    with pytest.raises(BadFile, match=r"lift_pot.ledger: its seeds are not those of the instance"):
        EvaluationSeries(tmp_path, IDLE, InstanceList("lift_pot", "clean", FINGERPRINT, rows))
    other = replace(IDLE, fingerprint=FINGERPRINT.model_copy(update={"assets": "else"}))
    with pytest.raises(DatasetMismatch, match=r"fingerprint.assets was '', now 'else'"):
        EvaluationSeries(tmp_path, other, opened(tmp_path).instances)


def test_the_lists_in_a_folder_are_those_of_its_episodes(tmp_path: Path, pack: Pack) -> None:
    """A run that is refused leaves them alone, and one of fewer episodes does not shorten them."""
    ground = fingerprint_of(load_task(TASK), "clean", pack)
    spec, listed = (
        EvaluationSpec("idle"),
        replace(instances(TASK, "clean", *MANY), fingerprint=ground),
    )
    rows = [EpisodeRecord(TASK, "clean", seed, True) for seed in MANY]
    write_results(tmp_path / "out", spec, listed, rows, ground)
    others = replace(listed, instances=listed.instances[1:])
    for given, problem in ((others, "seeds are not those of the instance list"), (listed, "")):
        write_lists(list_file(tmp_path / "bench", "clean"), [given])
        wish = EvaluationRun(
            (TASK,), ("clean",), 1, out=tmp_path / "out", instances=tmp_path / "bench", workers=1
        )
        with pytest.raises(BadFile, match=problem) if problem else nullcontext():
            evaluate(spec, wish, pack)
        found = read_results(tmp_path / "out")
        assert found.lists == {("clean", TASK): listed}
        (row,) = summarise(found.records, found.lists).tasks
        assert row.counts.of_tried == Rate(3, 4)


def test_a_lost_episode_is_a_failure_with_its_reason(tmp_path: Path) -> None:
    made = opened(tmp_path)
    seed = made.begin()
    made.take(seed, WorkerFailure("worker_hang", "ran longer than 30 s"))
    (lost,) = made.records
    assert lost == replace(record(seed), steps=0, reason="worker_hang", detail=lost.detail)
    assert "30 s" in lost.detail and not made.halted


def test_successes_of_an_earlier_run_count_as_solved(tmp_path: Path) -> None:
    made = opened(tmp_path)
    for one in (record(MANY[0], True), record(MANY[1])):
        made.begin()
        made.take(one.seed, EvaluationResult(one))
    assert opened(tmp_path).progress.solved == 1


def test_what_was_run_without_recording_is_refused(tmp_path: Path, pack: Pack) -> None:
    take(opened(tmp_path), *MANY)
    header = recording_header(IDLE.spec, opened(tmp_path).instances, load_task("lift_pot"), pack)
    with DatasetWriter(tmp_path / "kept") as dataset:
        said = r"lift_pot.ledger: holds 3 episodes that were run without recording; evaluate into"
        with pytest.raises(BadFile, match=said):
            opened(tmp_path, writer=dataset.task(header))


def test_an_episode_that_is_recorded_already_leaves_nothing_on_the_disk(
    tmp_path: Path, pack: Pack
) -> None:
    """Where the results were deleted, and all are played again."""
    listed = opened(tmp_path / "first").instances
    header = recording_header(IDLE.spec, listed, load_task("lift_pot"), pack)
    with DatasetWriter(tmp_path / "kept") as dataset:
        for results in ("first", "second"):
            made = opened(tmp_path / results, writer=(writer := dataset.task(header)))
            assert made.begin() == MANY[0]
            writer.staging(MANY[0]).mkdir(parents=True)
            made.take(MANY[0], EvaluationResult(record(MANY[0]), Rejection(MANY[0], "gave_up")))
            left = writer.staging(MANY[0]).exists()
            writer.discard(MANY[0])
        assert writer.totals.attempts == 1 and not left


def test_no_record_outlives_its_attempt_when_the_machine_crashes(
    tmp_path: Path, pack: Pack, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also an attempt without files. Of each ledger the disk has what was synced by then."""
    synced, really = dict[int, int](), os.fsync

    def fsync(file: int) -> None:
        really(file)
        synced[os.fstat(file).st_ino] = os.fstat(file).st_size

    made, lost = opened(tmp_path), Rejection(MANY[0], "worker_crash")
    header = recording_header(IDLE.spec, made.instances, load_task("lift_pot"), pack)
    with DatasetWriter(tmp_path / "kept") as dataset:
        monkeypatch.setattr(os, "fsync", fsync)
        made = opened(tmp_path, writer=dataset.task(header))
        made.take(made.begin(), EvaluationResult(record(MANY[0]), lost))
        left = dict(synced)
    for ledger in (*tmp_path.rglob("*.ledger"), *tmp_path.rglob("ledger.jsonl")):
        os.truncate(ledger, left[ledger.stat().st_ino])
    with DatasetWriter(tmp_path / "kept") as dataset:
        assert opened(tmp_path, writer=dataset.task(header)).begin() == MANY[1]


def test_a_policy_that_changes_the_folder_moves_no_file(
    tmp_path: Path, pack: Pack, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As the code of many policies does, for the paths in its own files."""
    monkeypatch.chdir(tmp_path)
    made = opened(Path("out"), video="all")
    header = recording_header(IDLE.spec, made.instances, load_task("lift_pot"), pack)
    with DatasetWriter("kept") as dataset:
        job = opened(Path("out"), video="all", writer=dataset.task(header)).job(MANY[0])
        assert job.video_folder == tmp_path / "out"
        assert job.staging is not None and job.staging.is_relative_to(tmp_path / "kept")


def test_a_recording_takes_no_episode_of_an_edited_policy(tmp_path: Path, pack: Pack) -> None:
    listed, task = opened(tmp_path).instances, load_task("lift_pot")
    of = partial(recording_header, IDLE.spec, listed, task, pack)
    assert of().spec.policy == "idle, seed 0"
    with DatasetWriter(tmp_path / "kept") as dataset:
        dataset.task(of("a" * 64)).record(Rejection(MANY[0], "gave_up", ""))
    with DatasetWriter(tmp_path / "kept") as dataset:
        said = r"spec.policy was 'idle, seed 0, files aaaaaaaa', now .* files bbbbbbbb"
        with pytest.raises(DatasetMismatch, match=said):
            dataset.task(of("b" * 64))


# ---- a worker ------------------------------------------------------------------------------------


def task_of(seed: int, protocol: str = "clean", **options: str) -> EvaluationTask:
    setup = PolicySetup(TASK, protocol, "unseen", 0, options)
    return EvaluationTask(EpisodeSpec(TASK, protocol, split="unseen").at(seed), setup)


@pytest.mark.sim
def test_a_crash_of_the_policy_is_its_failure(pack: Pack) -> None:
    worker = EvaluateWorker(pack, FEW)
    raising = {str(SEEDS[0]): "raise", str(SEEDS[1]): "nonsense"}
    first = worker.do(task_of(SEEDS[0], **raising)).record
    assert (first.reason, first.success, first.steps) == ("policy_error", False, 3)
    assert "ValueError: nothing comes to mind" in first.detail and "still_life.py" in first.detail
    second = worker.do(task_of(SEEDS[1], **raising)).record
    assert second.reason == "policy_error" and "14 finite numbers" in second.detail
    # Nothing of a policy outlives its crash: in another order the record is the same.
    again = worker.do(task_of(SEEDS[0], **raising)).record
    assert "in episode 1 of this process" in again.detail


@pytest.mark.sim
def test_the_camera_is_no_factor_for_a_policy_without_pictures(pack: Pack) -> None:
    worker, camera = EvaluateWorker(pack, FEW), {"camera_angle", "camera_distance"}
    asked = {"blind": {}, "sees": {"look": "yes"}}
    inert = {
        name: {*worker.do(task_of(SEEDS[0], "phys_random", actions="0", **look)).record.inert}
        for name, look in asked.items()
    }
    assert camera <= inert["blind"]
    assert len(camera & inert["sees"]) == 1  # one displacement an episode: turned, or moved
    assert inert["blind"] - camera == inert["sees"] - camera


@pytest.mark.sim
def test_a_policy_without_pictures_plays_where_props_have_their_own_physics(pack: Pack) -> None:
    setup = PolicySetup("heavy_below", "clean", "unseen", 0, {"actions": "0"})
    recipe = EpisodeSpec("heavy_below", "clean", split="unseen").at(SEEDS[0])
    worker = EvaluateWorker(pack, FEW)
    record = worker.do(EvaluationTask(recipe, setup)).record
    assert record.reason == "gave_up" and {"camera_angle", "camera_distance"} <= {*record.inert}
    assert "object_mass@first" in record.physics


@pytest.mark.sim
@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_the_expert_solves_what_it_has_certified(pack: Pack, protocol: str) -> None:
    recipe = EpisodeSpec(TASK, protocol).at(FIRST_SEED)
    certified = CertifyWorker(pack).do(CertificationTask(recipe))
    record = EvaluateWorker(pack, "expert").do(task_of(FIRST_SEED, protocol)).record
    assert certified.feasible and record.success and record.held
    assert record.first_touch is not None and 0 < record.first_touch < record.time
    assert record.state.startswith(certified.state)
    assert set(record.physics) >= {"friction", "center_of_mass", "table_tilt"}


# ---- whole runs ----------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def lists(pack: Pack, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Lists that look certified; only what the expert does with them needs real ones."""
    out = tmp_path_factory.mktemp("lists")
    rows = ((SEEDS[0], "", "0"), (SEEDS[0] + 1, "slipped"), (SEEDS[1], "", "0"))
    instances = tuple(BenchmarkInstance(*row) for row in rows)
    for protocol in PROTOCOLS:
        fingerprint = fingerprint_of(load_task(TASK), protocol, pack)
        made = InstanceList(TASK, protocol, fingerprint, instances)
        write_lists(list_file(out, protocol), [made])
    return out


def run(
    out: Path,
    lists: Path,
    pack: Pack,
    policy: str = FEW,
    listener: Listener | None = None,
    spec: EvaluationSpec | None = None,
    options: dict[str, str] | None = None,
    **changes,
) -> list[EpisodeRecord]:
    """Evaluates; returns the records of the first protocol."""
    made = replace(EvaluationRun((TASK,), PROTOCOLS, 2, out, lists), **changes)
    asked = replace(spec or EvaluationSpec(policy), options=options or {})
    evaluate(asked, made, pack, listener or Listener())
    return [*read_results(out).records[made.protocols[0], TASK]]


CLEAN = {"protocols": ("clean",)}


def files_of(out: Path) -> dict[str, bytes]:
    """What must be the same on every run."""
    places = [*sorted(out.rglob("*.ledger")), *sorted(out.rglob("*.jsonl")), out / SUMMARY]
    return {str(path.relative_to(out)): path.read_bytes() for path in places}


@pytest.mark.processes
@pytest.mark.sim
def test_records_do_not_depend_on_workers_or_on_a_crash_between_them(
    tmp_path: Path, lists: Path, pack: Pack
) -> None:
    for workers in (1, 2):
        run(tmp_path / str(workers), lists, pack, workers=workers)
    whole = files_of(tmp_path / "1")
    assert len(whole) == 5 and whole == files_of(tmp_path / "2")
    # A crash has left one and a half records of the first list and nothing of the other.
    cut = tmp_path / "2"
    head, *lines = ledger_file(cut, "clean", TASK).read_bytes().splitlines(keepends=True)
    ledger_file(cut, "clean", TASK).write_bytes(head + lines[0] + lines[1][:90])
    ledger_file(cut, "phys_random", TASK).unlink()
    (cut / SUMMARY).unlink()
    counts = Ears()
    run(cut, lists, pack, listener=counts, workers=2)
    assert [one.accepted - one.new_accepted for one in counts.progresses] == [1, 0]
    assert files_of(cut) == whole
    for records in read_results(cut).records.values():
        assert [one.seed for one in records] == [*SEEDS]
        assert {(one.steps, one.reason, one.success) for one in records} == {(3, "gave_up", False)}
    summary = json.loads(whole[SUMMARY])
    assert summary["tasks"][0]["of_tried"]["trials"] == 3  # the infeasible seed was tried too
    assert summary["pairs"][0]["neither"] == 2


@pytest.mark.sim
@pytest.mark.processes
def test_a_policy_that_is_gone_stops_the_run_and_can_be_resumed(
    tmp_path: Path, lists: Path, pack: Pack
) -> None:
    first = {str(SEEDS[0]): "gone"}
    with pytest.raises(WorkerError, match="its server does not answer"):
        run(tmp_path, lists, pack, options=first, workers=1, **CLEAN)
    # A start that came to no result does not claim the folder for its options.
    gone = {str(SEEDS[1]): "gone"}
    with pytest.raises(WorkerError, match="its server does not answer") as error:
        run(tmp_path, lists, pack, options=gone, workers=1, **CLEAN)
    assert error.value.exit_code == 5 and not error.value.trace
    left = read_results(tmp_path).records["clean", TASK]
    assert [one.seed for one in left] == [SEEDS[0]]


@pytest.mark.processes
@pytest.mark.sim
@pytest.mark.slow
@pytest.mark.parametrize(
    ("misdeed", "reason", "detail"),
    [("die", "worker_crash", "exit code 3"), ("hang", "worker_hang", "30 s")],
)
def test_a_process_that_dies_or_hangs_is_a_failure_of_its_episode(
    tmp_path: Path, lists: Path, pack: Pack, misdeed: str, reason: str, detail: str
) -> None:
    bad = {str(SEEDS[0]): misdeed}
    first, second = run(tmp_path, lists, pack, options=bad, timeout=30.0, **CLEAN)
    assert first.reason == reason and detail in first.detail
    assert second.reason == "gave_up"


def test_what_cannot_be_is_refused(tmp_path: Path, lists: Path, pack: Pack) -> None:
    def tried(policy: str = FEW, **changes) -> None:
        run(tmp_path / "out", changes.pop("instances", lists), pack, policy, **changes)

    certify = r"rtphys certify task=click_bell protocol=clean,phys_random feasible=2"
    with pytest.raises(RtphysError, match=f"does not exist.*{certify}"):
        tried(instances=tmp_path)
    # The lists that are made replace those that are there.
    every = r"has no list of lift_pot; .* task=click_bell,lift_pot protocol=clean feasible=2 out"
    with pytest.raises(RtphysError, match=every):
        tried(tasks=("click_bell", "lift_pot"), protocols=("clean",))
    with pytest.raises(RtphysError, match="holds 2 feasible seeds, not 3"):
        tried(episodes=3)
    with pytest.raises(BadValue, match=r"episodes = 0 .*at least 1"):
        tried(episodes=0)
    with pytest.raises(UnknownName, match="did you mean 'idle'"):
        tried(policy="idel")
    with pytest.raises(UnknownName, match="did you mean 'phys_random'"):
        tried(protocols=("phys_randon",))
    assert not (tmp_path / "out").exists()


@pytest.mark.sim
def test_a_list_with_another_fingerprint_is_refused(
    tmp_path: Path, lists: Path, pack: Pack
) -> None:
    mine = tmp_path / "mine.jsonl"
    text = list_file(lists, "clean").read_text()
    mine.write_text(text.replace(pack.digest, "0" * 64))
    with pytest.raises(RtphysError, match=r"assets was '0+', now .*`accept_changes`"):
        run(tmp_path / "out", mine, pack, episodes=1, **CLEAN)
    run(tmp_path / "stale", mine, pack, episodes=1, accept_changes=True, **CLEAN)
    (mark,) = json.loads((tmp_path / "stale" / SUMMARY).read_text())["changed_since_certified"]
    assert (mark["protocol"], mark["task"]) == ("clean", TASK)
    assert mark["clauses"] == [f"assets was '{'0' * 64}', now '{pack.digest}'"]
    # Which numpy it was certified with is stated in the list, not enforced.
    mine.write_text(text.replace('"numpy": "', '"numpy": "0.'))
    assert len(run(tmp_path / "out", mine, pack, episodes=1, **CLEAN)) == 1
    assert "changed_since_certified" not in (tmp_path / "out" / SUMMARY).read_text()


def test_a_list_under_a_wrong_name_is_refused(tmp_path: Path, lists: Path, pack: Pack) -> None:
    list_file(tmp_path, "clean").write_bytes(list_file(lists, "phys_random").read_bytes())
    with pytest.raises(BadFile, match=r"is the list of click_bell, phys_random"):
        run(tmp_path / "out", tmp_path, pack, accept_changes=True, **CLEAN)


@pytest.mark.sim
def test_a_folder_holds_one_evaluation(
    tmp_path: Path, lists: Path, pack: Pack, monkeypatch: pytest.MonkeyPatch
) -> None:
    small = EvaluationSpec(FEW, recording=replace(EvaluationSpec(FEW).recording, size="128x96"))
    run(tmp_path, lists, pack, episodes=1, **CLEAN)
    for changes, clause in (
        ({"policy": "idle"}, "policy was"),
        ({"policy": "idle", "protocols": ("phys_random",)}, "policy was"),  # of other episodes
        ({"spec": small}, "recording.size was None, now '128x96'"),
        ({"options": {"actions": "2"}}, "options.actions"),
    ):
        with pytest.raises(DatasetMismatch, match=clause):
            run(tmp_path, lists, pack, **{**CLEAN, **changes})
    with monkeypatch.context() as edited:
        edited.setattr(module, "files_digest", lambda *_: "of a later edit")
        with pytest.raises(DatasetMismatch, match="files of the policy were edited"):
            run(tmp_path, lists, pack, **CLEAN)
    (tmp_path / "run.json").touch()
    with pytest.raises(BadFile, match="an earlier version"):
        run(tmp_path, lists, pack, **CLEAN)
    (tmp_path / "run.json").unlink()
    assert len(run(tmp_path, lists, pack, **CLEAN)) == 2  # more of the same


def test_a_list_of_another_robot_is_refused_whatever_is_accepted(tmp_path: Path) -> None:
    """Nobody has certified these seeds for it."""
    rows = (BenchmarkInstance(SEEDS[0], "", "0" * 16),)
    write_lists(list_file(tmp_path, "clean"), [InstanceList(TASK, "clean", FINGERPRINT, rows)])
    wish = EvaluationRun((TASK,), ("clean",), 1, instances=tmp_path, accept_changes=True)
    assert module.certified(wish, "clean", TASK, FINGERPRINT).feasible == rows
    panda = FINGERPRINT.model_copy(update={"embodiment": "franka-panda"})
    said = (
        "is certified for the robot aloha-agilex, which says nothing of franka-panda; to certify: "
        ".* embodiment=franka-panda"
    )
    with pytest.raises(RtphysError, match=said):
        module.certified(wish, "clean", TASK, panda)


def test_the_rejects_of_a_dataset_are_those_of_its_protocol_alone(tmp_path: Path) -> None:
    """Seeds 0, 1, 3 of four; nobody tried them under `clean`, or with another robot."""
    collect(tmp_path / "data", 3)
    wish = EvaluationRun((TASK,), ("clean",), instances=tmp_path / "data")
    own, other = (
        module.certified(wish, protocol, TASK, FINGERPRINT) for protocol in ("phys_random", "clean")
    )
    assert own.instances == other.instances and not own.certified
    assert (own.tried_under, other.tried_under) == ("", "phys_random")
    counts = [Counts.of([], [one]) for one in (own, other)]
    assert [(one.feasible, one.tried) for one in counts] == [(3, 4), (3, None)]
    collect(tmp_path / "data", 1, synthetic.header(overrides={"friction": 0.2}))  # listed before
    assert module.certified(wish, "phys_random", TASK, FINGERPRINT).instances == own.instances
    panda = FINGERPRINT.model_copy(update={"embodiment": "franka-panda"})
    said = "with the robot franka_panda, only with aloha-agilex; set `embodiment`"
    with pytest.raises(BadValue, match=said):
        module.certified(wish, "clean", TASK, panda)


def test_the_seeds_of_a_part_of_a_dataset_have_gaps(tmp_path: Path, pack: Pack) -> None:
    """A recording kept the first of them alone, and the list that was written was not read."""
    collect(tmp_path / "data", 3)  # seeds 0, 1, 3 of four
    subset(Dataset(tmp_path / "data").where(seeds=[0, 3]), tmp_path / "part")
    wish = EvaluationRun((TASK,), ("clean",), instances=tmp_path / "part")
    listed = module.certified(wish, "clean", TASK, FINGERPRINT)
    write_lists(tmp_path / "clean.jsonl", [listed])
    assert read_list(tmp_path / "clean.jsonl", TASK) == listed
    cell = EvaluationHeader(EvaluationSpec("idle").of("clean", TASK), FINGERPRINT)
    header = recording_header(cell.spec, listed, load_task(TASK), pack)
    with DatasetWriter(tmp_path / "kept") as dataset:
        made = EvaluationSeries(tmp_path / "out", cell, listed, writer=dataset.task(header))
        for seed in (made.begin(), made.begin()):
            failed = Rejection(seed, "gave_up")
            made.take(seed, EvaluationResult(record(seed, reason="gave_up"), failed))
    (entry,) = Dataset(tmp_path / "kept").task_datasets
    assert [row.seed for row in entry.rows(tmp_path / "kept")] == [0, 3]


def test_seeds_of_a_plain_task_dataset_stand_in_for_those_of_a_held_one(tmp_path: Path) -> None:
    """One whose protocol fits, but which holds an attribute, was chosen and then refused."""
    clean = {"protocol": "clean"}
    collect(tmp_path, 1, synthetic.header(**clean))
    collect(tmp_path, 1, synthetic.header(overrides={"friction": 0.2}))
    wish = EvaluationRun((TASK,), ("phys_random",), instances=tmp_path)
    assert module.certified(wish, "phys_random", TASK, FINGERPRINT).tried_under == "clean"


@pytest.mark.parametrize(
    ("given", "problem"),
    [
        ({"ranges": load_domain("global")}, "drawn from `ranges`"),
        ({"overrides": {"friction": 0.2}}, "picked or held"),
        ({"only": ("friction",)}, "picked or held"),
    ],
)
def test_a_dataset_of_other_physics_is_no_list(
    tmp_path: Path, given: dict[str, object], problem: str
) -> None:
    """An evaluation draws from the task's own domain, so these seeds would have other physics."""
    collect(tmp_path, 1, synthetic.header(**given))
    wish = EvaluationRun((TASK,), ("phys_random",), instances=tmp_path)
    with pytest.raises(BadValue, match=f"{problem}.*which an evaluation does not know"):
        module.certified(wish, "phys_random", TASK, FINGERPRINT)


def test_a_recorded_dataset_has_the_pictures_that_were_asked_for(pack: Pack) -> None:
    instances = InstanceList(TASK, "clean", FINGERPRINT, (BenchmarkInstance(SEEDS[0]),))
    asked = RecordingSpec(size="64x48", senses=("depth",))
    header = recording_header(
        EvaluationSpec("idle", recording=asked), instances, load_task(TASK), pack
    )
    assert header.spec.recording == asked


def test_a_recorded_dataset_is_of_the_robot_that_acts(tmp_path: Path, pack: Pack) -> None:
    robot = EpisodeSpec(TASK, "clean", split="unseen", embodiment="franka-panda")
    instances = InstanceList(TASK, "clean", FINGERPRINT, (BenchmarkInstance(SEEDS[0]),))
    header = recording_header(EvaluationSpec("idle", robot), instances, load_task(TASK), pack)
    with DatasetWriter(tmp_path / "kept") as dataset:
        kept = dataset.task(header)
    assert kept.header.spec.episode == robot
    assert kept.task_dataset.name == f"clean/{TASK}/franka_panda"


@pytest.mark.sim
@pytest.mark.render
def test_the_command_runs_records_and_films(tmp_path: Path, lists: Path) -> None:
    options = ["--task", TASK, "--protocol", "clean", "--episodes", "1", "--workers", "1"]
    options += ["--instances", str(lists), "--out", str(tmp_path), "--video", "failures"]
    options += ["--policy-option", "actions=2"]
    done = ran(["evaluate", "--policy", FEW, *options])
    assert " 0 % [0-79.3] 0/1" in done.output and "gave_up 1" in done.output
    path = tmp_path / "video" / "clean" / TASK / f"{SEEDS[0]}_failure.mp4"
    facts = probe(path.read_bytes())
    assert (facts.width, facts.height) == (320, 360) and facts.frames > 2
    path.unlink()
    again = CliRunner().invoke(app, ["evaluate", "--policy", FEW, *options])
    assert f"1 episode of an earlier run in {tmp_path} stand; they get no new vid" in again.stderr
    assert not path.exists()
    (official,) = (tmp_path / "eval_result").rglob("_result_clean.txt")
    assert official.read_text().rstrip().endswith("0.0")


@pytest.mark.sim
@pytest.mark.slow
@pytest.mark.render
def test_a_dataset_is_replayed_on_its_own_seeds(tmp_path: Path, pack: Pack) -> None:
    data = tmp_path / "data"
    options = ["--task", TASK, "--episodes", "1", "--out", str(data), "--workers", "1"]
    clean = ["--protocol", "clean", "--cameras", "head"]
    ran(["collect", *options, *clean])
    policy = f"replay:{data}"
    (first,) = run(tmp_path / "out", data, pack, policy, episodes=1, **CLEAN)
    assert first.success
    # The same actions under physics that they know nothing of: a result, whatever it is.
    (twin,) = run(tmp_path / "twin", data, pack, policy, episodes=1, protocols=("phys_random",))
    assert twin.seed == first.seed and twin.physics != first.physics


@pytest.mark.sim
@pytest.mark.slow
@pytest.mark.render
def test_a_policy_sees_when_it_asks_to(tmp_path: Path, pack: Pack, lists: Path) -> None:
    """That it sees the same in every process, `test_commands_with_many_workers` holds."""
    states = []
    for name, look in (("looking", {"look": "yes"}), ("blind", {})):
        made = run(tmp_path / name, lists, pack, options={**look, "actions": "8"}, **CLEAN)
        states.append([one.state for one in made])
    assert states[0] != states[1]


@pytest.mark.processes
@pytest.mark.sim
@pytest.mark.slow
def test_a_killed_run_ends_up_with_the_same_summary(tmp_path: Path, lists: Path) -> None:
    options = ["--task", TASK, "--protocol", ",".join(PROTOCOLS), "--episodes", "2"]
    options += ["--policy", FEW, "--instances", str(lists), "--workers", "2"]
    command = [sys.executable, "-m", "rtphys.cli.main", "evaluate", *options, "--out"]
    whole, killed = tmp_path / "whole", tmp_path / "killed"
    subprocess.run([*command, str(whole)], check=True, capture_output=True)
    process = subprocess.Popen([*command, str(killed)], stderr=subprocess.DEVNULL)
    while not list(killed.rglob("*.ledger")):
        assert process.poll() is None, "it ended before it could be killed"
        time.sleep(0.02)
    process.send_signal(signal.SIGKILL)
    process.wait()
    subprocess.run([*command, str(killed)], check=True, capture_output=True)
    assert files_of(whole) == files_of(killed)
