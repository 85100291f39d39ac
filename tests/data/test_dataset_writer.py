"""Order, resume, locks and refusals of the dataset writer."""

import errno
import fcntl
import multiprocessing
import multiprocessing.synchronize
import os
import pickle
import shutil
import stat
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest
import synthetic
from collected import FOLDER, FRAMES, collect, content, outcome, wanting, write

from rtphys.core.errors import BadFile
from rtphys.data import faults, files
from rtphys.data.attempts import Accepted, Totals, read_attempts
from rtphys.data.dataset import Dataset
from rtphys.data.lock import FolderLock, check_unlocked
from rtphys.data.staging import stage_episode
from rtphys.data.verify import verify
from rtphys.data.writer import DatasetWriter, Rejection


@pytest.mark.parametrize(
    ("robot", "joints"), [("franka-panda", (7, 7)), ("piper,franka-panda,0.7", (6, 7))]
)
def test_a_robot_has_as_many_numbers_as_its_joints(
    tmp_path: Path, robot: str, joints: tuple[int, int]
) -> None:
    what = synthetic.header(embodiment=robot)
    of = synthetic.episode(0, FRAMES, what.spec.episode)
    of = replace(of, frames=synthetic.frames_of(0, FRAMES, joints))
    write(tmp_path, of, what=what)
    assert verify(tmp_path).sound
    (read,) = Dataset(tmp_path)
    assert read.frames.layout.per_arm == joints
    np.testing.assert_array_equal(read.frames.vector, of.frames.vector)
    assert Dataset(tmp_path).embodiments == (robot,)
    assert len(Dataset(tmp_path).where(embodiment=robot)) == 1


@pytest.fixture(scope="module")
def reference(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    out = tmp_path_factory.mktemp("reference")
    collect(out, 4)
    assert verify(out).sound
    return content(out)


def test_tree_is_the_official_one(reference: dict[str, bytes]) -> None:
    assert reference[f"{FOLDER}/seed.txt"] == b"0 1 3 4 "
    assert reference[f"{FOLDER}/seeds.txt"] == b"0\n1\n3\n4\n"
    ends = {"data": "hdf5", "video": "mp4", "phys_meta": "json", "instruction": "json"}
    own = {f"{kind}/episode_{n:07d}.{end}" for kind, end in ends.items() for n in range(4)}
    own |= {"scene_info.json", "seed.txt", "seeds.txt", "ledger.jsonl"}
    assert set(reference) == {"manifest.json", *(f"{FOLDER}/{name}" for name in own)}


def test_legacy_tree_and_two_tasks_of_one_manifest(tmp_path: Path) -> None:
    collect(tmp_path, 2, synthetic.header("legacy"))
    folder = tmp_path / "click_bell/phys_random"
    names = ("data/episode1.hdf5", "video/episode1.mp4", "instructions/episode1.json")
    assert all((folder / name).is_file() for name in names)
    assert b"\\u00e4" in (folder / names[2]).read_bytes(), "legacy JSON is ASCII"
    collect(tmp_path, 1)
    report = verify(tmp_path)
    assert (report.problems, report.episodes) == ([], 3)


def test_without_sentences_the_file_has_the_task_s_name(tmp_path: Path) -> None:
    episode = replace(synthetic.episode(0, FRAMES), instructions={"seen": [], "unseen": []})
    stage_episode(tmp_path / "staged", episode)
    with h5py.File(tmp_path / "staged/data.hdf5") as file:
        assert file["instruction"][()] == b"click bell"
        assert file["instructions"][()] == b'["click bell"]'


@pytest.mark.parametrize("seed", [0, 2])
def test_an_outcome_out_of_turn_is_refused(tmp_path: Path, seed: int) -> None:
    """Results in any other order wait in the campaign's series."""
    with DatasetWriter(tmp_path) as dataset:
        task = dataset.task(synthetic.header())
        task.record(outcome(task, 0))
        staged = outcome(task, seed)
        with pytest.raises(ValueError, match=f"seed {seed} is not that of 1"):
            task.record(staged)
        assert (task.next_seed, task.totals.attempts, task.totals.episodes) == (1, 1, 1)
    assert verify(tmp_path).problems == []


@pytest.mark.parametrize("first", [0, 1, 2, 3])
def test_resume_gives_the_undisturbed_dataset(
    tmp_path: Path, reference: dict[str, bytes], first: int
) -> None:
    collect(tmp_path, first)
    assert verify(tmp_path).problems == []
    collect(tmp_path, 4)
    assert content(tmp_path) == reference


@pytest.mark.parametrize(
    ("other", "text"),
    [
        (
            {"overrides": {"friction": 0.2}, "config": "phys_random"},
            r"overrides\.friction was None, now 0\.2",
        ),
        ({"first_seed": 1}, r"spec\.first_seed was 0, now 1"),
        ({"senses": ("depth",)}, r"senses was \[\], now \['depth'\]"),
        ({"keep_failures": "3"}, "keep_failures was None, now '3'"),
        ({"twin": "clean"}, "twin was None, now 'clean'"),
        ({"shader": "default"}, "recording.shader was 'slim', now 'default'"),
        ({"versions": {"rtphys": "9"}}, r"versions\.rtphys was '0\.1\.0', now '9'"),
    ],
)
def test_another_collection_is_refused_with_its_difference(
    tmp_path: Path, other: dict[str, object], text: str
) -> None:
    collect(tmp_path, 1)
    before = content(tmp_path)
    with pytest.raises(faults.DatasetMismatch, match=text):
        collect(tmp_path, 2, synthetic.header(**other))
    assert content(tmp_path) == before


def test_foreign_episodes_are_never_taken_for_leftovers(tmp_path: Path) -> None:
    foreign = tmp_path / FOLDER / "data/episode_0000000.hdf5"
    foreign.parent.mkdir(parents=True)
    foreign.write_bytes(b"precious")
    with pytest.raises(faults.DatasetMismatch, match="have no ledger"):
        collect(tmp_path, 1)
    assert content(tmp_path) == {foreign.relative_to(tmp_path).as_posix(): b"precious"}


def _hold(out: Path, ready: "multiprocessing.synchronize.Event") -> None:
    with DatasetWriter(out):
        ready.set()
        ready.wait()
        os.kill(os.getpid(), 19)  # stop: the lock must still be held


def test_second_run_on_a_folder_names_the_first(tmp_path: Path) -> None:
    context = multiprocessing.get_context("fork")
    ready = context.Event()
    owner = context.Process(target=_hold, args=(tmp_path, ready))
    owner.start()
    try:
        assert ready.wait(20)
        with pytest.raises(faults.DatasetLocked, match=f"process {owner.pid} on "):
            DatasetWriter(tmp_path)
    finally:
        owner.kill()
        owner.join()
    collect(tmp_path, 1)  # a lock dies with its owner
    assert not list(tmp_path.glob(".rtphys*"))


@pytest.mark.parametrize(
    ("number", "kind", "text"),
    [
        (errno.EWOULDBLOCK, faults.DatasetLocked, r"\(unknown process\)"),
        (errno.EACCES, faults.DatasetLocked, r"\(unknown process\)"),  # that of NFS
        (errno.EIO, faults.CannotWrite, "lock: Input/output error"),
    ],
)
def test_a_lock_that_is_held_or_fails(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, number: int, kind: type[Exception], text: str
) -> None:
    monkeypatch.setattr("fcntl.flock", failing(number))
    with pytest.raises(kind, match=text):
        DatasetWriter(tmp_path)


@pytest.mark.parametrize("number", [errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP])
def test_a_file_system_without_locks(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, number: int
) -> None:
    flock = fcntl.flock
    monkeypatch.setattr("fcntl.flock", failing(number))
    with DatasetWriter(tmp_path):
        held = tmp_path / ".rtphys.lock.held"
        owner = rf"process {os.getpid()} on .*; if it was killed, delete {held}: this file system"
        with pytest.raises(faults.DatasetLocked, match=owner):
            DatasetWriter(tmp_path)
        monkeypatch.setattr("fcntl.flock", flock)  # another machine mounts the folder with locks
        with pytest.raises(faults.DatasetLocked, match=owner):
            DatasetWriter(tmp_path)
    with DatasetWriter(tmp_path):
        monkeypatch.setattr("fcntl.flock", failing(number))
        with pytest.raises(faults.DatasetLocked, match=f"process {os.getpid()} on "):
            DatasetWriter(tmp_path)
    collect(tmp_path, 1)
    assert verify(tmp_path).sound and not list(tmp_path.glob(".rtphys*"))


def test_a_run_leaves_the_lock_of_a_folder_that_was_made_anew(tmp_path: Path) -> None:
    """Somebody removed the folder under the first run, and began a second one."""
    out = tmp_path / "data"
    out.mkdir()
    first = FolderLock(out)
    shutil.rmtree(out)
    out.mkdir()
    with FolderLock(out):
        first.release()
        with pytest.raises(faults.DatasetLocked):
            FolderLock(out)
    assert not list(out.iterdir())


def test_a_lock_that_is_released_while_another_run_looks_at_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    flock, fstat, path = fcntl.flock, os.fstat, tmp_path / ".rtphys.lock"
    other = [b"of another run"]

    def replaced(handle: int, kind: int) -> None:
        flock(handle, kind)
        if other:  # the owner of this file ended, and a third run made its own
            path.unlink()
            path.write_bytes(other.pop())

    def removed(handle: int) -> os.stat_result:
        if path.read_bytes():
            path.unlink()
        return fstat(handle)

    monkeypatch.setattr("fcntl.flock", replaced)
    monkeypatch.setattr(os, "fstat", removed)
    lock = FolderLock(tmp_path)
    monkeypatch.undo()
    assert path.read_text().startswith(f"process {os.getpid()} on ")
    lock.release()
    assert not list(tmp_path.iterdir())


def test_a_file_system_that_syncs_no_folders(
    tmp_path: Path, reference: dict[str, bytes], monkeypatch: pytest.MonkeyPatch
) -> None:
    fsync = os.fsync

    def files_alone(handle: int) -> None:
        if stat.S_ISDIR(os.fstat(handle).st_mode):
            raise OSError(errno.EINVAL, os.strerror(errno.EINVAL))
        fsync(handle)

    monkeypatch.setattr(os, "fsync", files_alone)
    collect(tmp_path, 4)
    assert content(tmp_path) == reference


def failing(number: int):
    def flock(*_: object) -> None:
        raise OSError(number, os.strerror(number))

    return flock


def test_a_name_that_no_file_system_takes(tmp_path: Path) -> None:
    out = tmp_path / ("n" * 300)
    check_unlocked(out)  # nobody can have locked it
    with pytest.raises(faults.CannotWrite, match=r"n{300}: File name too long"):
        DatasetWriter(out)


def test_a_file_where_the_folder_should_be(tmp_path: Path) -> None:
    (tmp_path / "data").write_text("mine")
    with pytest.raises(faults.CannotWrite, match="a file stands where a folder is needed"):
        DatasetWriter(tmp_path / "data")
    assert content(tmp_path) == {"data": b"mine"}


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ('{"name": "my web app"}', r"manifest\.json: is no dataset's"),
        ('{"dataset_version": "2.0"}', r"is of dataset version 2\.0; this rtphys reads version 3"),
        ("not json", "line 1, column 1"),
    ],
)
def test_foreign_manifest_is_refused(tmp_path: Path, text: str, problem: str) -> None:
    (tmp_path / "manifest.json").write_text(text)
    with pytest.raises(BadFile, match=problem):
        DatasetWriter(tmp_path)
    assert set(content(tmp_path)) == {"manifest.json"}


def test_every_file_is_synced_before_its_row(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """So that a power cut leaves no row without its files."""
    synced, rows, fsync = set[int](), 0, os.fsync

    def watched(handle: int) -> None:
        nonlocal rows
        fsync(handle)
        synced.add(os.fstat(handle).st_ino)
        if Path(f"/proc/self/fd/{handle}").readlink().name == "ledger.jsonl":
            rows += 1
            placed = [path for path in (tmp_path / FOLDER).glob("*/episode_*") if path.is_file()]
            assert {path.stat().st_ino for path in placed} <= synced

    monkeypatch.setattr(os, "fsync", watched)
    collect(tmp_path, 3)
    assert rows >= 4


@pytest.mark.parametrize("calls", [*range(16), 20, 25, 31, 40])
def test_full_disk_at_any_moment_loses_nothing(
    tmp_path: Path, reference: dict[str, bytes], monkeypatch: pytest.MonkeyPatch, calls: int
) -> None:
    """`calls`: of fsync, until the disk is full."""
    left, fsync = iter(range(calls)), os.fsync

    def filling(handle: int) -> None:
        if next(left, None) is None:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        fsync(handle)

    with monkeypatch.context() as patched:
        patched.setattr(os, "fsync", filling)
        with pytest.raises(faults.CannotWrite, match="the disk is full"):
            collect(tmp_path, 4)
    assert not list(tmp_path.rglob(f"*{files.TEMPORARY}"))
    if (tmp_path / "manifest.json").exists():
        assert verify(tmp_path).problems == []
    collect(tmp_path, 4)
    assert content(tmp_path) == reference


@pytest.mark.parametrize("counted", [False, True])
def test_ctrl_c_between_a_row_and_its_count(
    tmp_path: Path,
    reference: dict[str, bytes],
    monkeypatch: pytest.MonkeyPatch,
    counted: bool,
) -> None:
    add = Totals.add

    def interrupted(totals: Totals, row: Accepted) -> None:
        if counted:
            add(totals, row)
        monkeypatch.setattr(Totals, "add", add)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt), DatasetWriter(tmp_path) as dataset:
        task = dataset.task(wanting(4))
        task.record(outcome(task, 0))
        monkeypatch.setattr(Totals, "add", interrupted)
        task.record(outcome(task, 1))
    assert verify(tmp_path).problems == []
    assert len(Dataset(tmp_path)) == 2
    collect(tmp_path, 4)
    assert content(tmp_path) == reference


def test_the_disk_has_every_row_that_the_manifest_counts(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also the last ones, which gave no episode: a crash of the machine must not lose them."""
    synced, really = dict[int, int](), os.fsync  # file -> bytes that a crash leaves

    def fsync(file: int) -> None:
        really(file)
        synced[os.fstat(file).st_ino] = os.fstat(file).st_size

    monkeypatch.setattr(os, "fsync", fsync)
    collect(tmp_path, 3, attempts=3)
    (entry,) = Dataset(tmp_path).task_datasets
    ledger = entry.below(tmp_path).ledger
    assert entry.rejections == {"slipped": 1}
    assert synced[ledger.stat().st_ino] == entry.ledger.bytes == ledger.stat().st_size


def test_what_waits_for_the_first_commit_goes_with_an_error(tmp_path: Path) -> None:
    """As where another task fills the disk."""
    with pytest.raises(faults.CannotWrite), DatasetWriter(tmp_path) as dataset:
        task = dataset.task(synthetic.header())
        outcome(task, 0)
        assert task.staging(0).is_dir()
        raise faults.CannotWrite("other", OSError(errno.ENOSPC, "full"))
    assert not task.task_dataset.staging.exists() and content(tmp_path) == {}
    task.staging(7).mkdir(parents=True)  # of a run that was killed
    with DatasetWriter(tmp_path) as dataset:
        dataset.task(synthetic.header())
        assert not task.task_dataset.staging.exists()


@pytest.mark.parametrize("part", [".", "phys_random/click_bell"])
def test_a_folder_that_is_removed_meanwhile_is_named(tmp_path: Path, part: str) -> None:
    out = tmp_path / "out"
    removed = pytest.raises(faults.CannotWrite, match="it was removed while this run wrote")
    with removed as caught, DatasetWriter(out) as dataset:
        task = dataset.task(synthetic.header())
        task.record(outcome(task, task.next_seed))
        shutil.rmtree(out / part)
        task.record(Rejection(task.next_seed, "grip_slip"))
    assert str(out) in str(caught.value)
    assert not [path for path in out.rglob("*") if path.is_file()]


def test_contradicting_arrays_leave_nothing(tmp_path: Path) -> None:
    good = synthetic.episode(0, FRAMES)
    short = replace(good.frames, qpos=good.frames.qpos[:-1])
    with pytest.raises(faults.BadEpisode, match=r"qpos has shape \(3, 16\), not \(4, 16\)"):
        stage_episode(tmp_path / "seed_0", replace(good, frames=short))
    with pytest.raises(faults.BadEpisode, match="do not match the frames"):
        stage_episode(tmp_path / "seed_0", replace(good, images=synthetic.pictures(0, 3)))
    assert content(tmp_path) == {}


def test_errors_cross_processes() -> None:
    error = faults.CannotWrite("x", OSError(errno.ENOSPC, "full"))
    copy = pickle.loads(pickle.dumps(error))
    assert (type(copy), str(copy), copy.errno) == (type(error), str(error), errno.ENOSPC)
    assert str(error).endswith("free some space, then repeat the command"), "an export begins anew"


@pytest.mark.parametrize("excluded", [False, True])
def test_an_episode_with_a_recovery_is_marked(tmp_path: Path, excluded: bool) -> None:
    """And where a collection excludes it, the verifier finds it."""
    what = synthetic.header(recovery=not excluded)
    first, second = (synthetic.episode(seed, FRAMES, what.spec.episode) for seed in (0, 1))
    verdict = {**second.phys_meta["verdict"], "recovered": True}  # type: ignore[dict-item]
    second = replace(second, phys_meta={**second.phys_meta, "verdict": verdict})
    write(tmp_path, first, second, what=what)
    (entry,) = Dataset(tmp_path).task_datasets
    assert entry.spec.episode.recovery is not excluded and entry.recovered == 1
    rows = [*read_attempts(entry.below(tmp_path).ledger)]
    assert [isinstance(row, Accepted) and row.recovered for row in rows] == [False, True]
    problems = [str(problem) for problem in verify(tmp_path).problems]
    assert len(problems) == excluded
    assert all("verdict.recovered" in problem for problem in problems)
