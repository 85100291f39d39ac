"""Every damage is reported with the file's name; a lie with valid checksums is found too."""

import errno
import json
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import h5py
import pytest
import synthetic
from collected import FOLDER, collect, content, outcome, write
from forger import Entry, Forge, Forger, forge, put

from rtphys.assets.pack import default_pack
from rtphys.core.errors import BadFile
from rtphys.core.seeds import stream
from rtphys.data.check_episode import Effort
from rtphys.data.dataset import Dataset
from rtphys.data.hdf5_file import open_read
from rtphys.data.jpeg import MARK
from rtphys.data.json_text import pretty
from rtphys.data.layout import EMBODIMENT, STAGING, TaskDataset
from rtphys.data.lock import FolderLock
from rtphys.data.manifest import manifest_bytes
from rtphys.data.rewrite import subset
from rtphys.data.verify import Report, verify
from rtphys.data.video import encode_images
from rtphys.data.writer import DatasetWriter, Rejection

LEDGER = f"{FOLDER}/ledger.jsonl"
NOTHING = {"size": 0, "sha256": "0" * 64}


@pytest.fixture
def copy(three: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(three, tmp_path / "copy"))


def test_what_the_system_refuses_is_no_damage(copy: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A file that may not be read, or a disk that fails, says nothing of what the file holds."""
    path = TaskDataset.of(copy, synthetic.header().spec).episode(0).hdf5

    def refuse(*_: object, **__: object) -> None:
        raise PermissionError(errno.EACCES, "Unable to synchronously open file")

    monkeypatch.setattr(h5py, "File", refuse)
    with pytest.raises(BadFile, match=r"hdf5: permission denied$"), open_read(path):
        pass


def words(report: Report) -> str:
    return "\n".join(map(str, report.problems))


def test_sound_dataset(three: Path) -> None:
    seen: list[tuple[int, int]] = []
    report = verify(three, progress=lambda done, total: seen.append((done, total)))
    assert (report.problems, report.notes) == ([], [])
    assert (report.episodes, report.files) == (3, 15)
    assert seen[-1][0] == seen[-1][1] and seen == sorted(seen)
    assert verify(three, Effort.QUICK).sound


@pytest.mark.parametrize("flips", [60, pytest.param(500, marks=pytest.mark.slow)])
def test_every_flipped_byte_is_reported_naming_the_file(copy: Path, flips: int) -> None:
    rng = stream(flips, "flips")
    paths = sorted(p for p in copy.rglob("*") if p.is_file())
    unseen = []
    for n in range(flips):
        path = paths[n % len(paths)]
        data = path.read_bytes()
        place, bit = int(rng.integers(len(data))), 1 << int(rng.integers(8))
        path.write_bytes(data[:place] + bytes([data[place] ^ bit]) + data[place + 1 :])
        report = verify(copy, Effort.QUICK)
        if path not in [problem.path for problem in report.problems]:
            unseen.append((path, place, words(report)))
        path.write_bytes(data)
    assert unseen == []
    assert verify(copy).sound


@pytest.mark.parametrize("name", ["data/episode_0000001.hdf5", "video/episode_0000000.mp4"])
def test_missing_and_cut_files(copy: Path, name: str) -> None:
    path = copy / FOLDER / name
    data = path.read_bytes()
    path.write_bytes(data[:-1])
    assert f"{path}: has {len(data) - 1} bytes, not {len(data)}" in words(verify(copy))
    path.unlink()
    assert words(verify(copy)) == f"{path}: is missing"


def test_a_file_nobody_listed(copy: Path) -> None:
    extra = copy / FOLDER / "data" / "episode_0000009.hdf5"
    extra.write_bytes(b"")
    assert words(verify(copy)) == f"{extra}: is in no manifest"


@pytest.mark.parametrize("name", ["data/.staging/episode_0000000.hdf5", "data/more", "more"])
def test_nothing_hides_in_a_folder_or_behind_a_link(copy: Path, tmp_path: Path, name: str) -> None:
    extra = copy / FOLDER / name
    if extra.suffix:
        extra.parent.mkdir()
        extra.write_bytes(b"")
    else:
        extra.symlink_to(tmp_path, target_is_directory=True)
    assert words(verify(copy)) == f"{extra}: is in no manifest"


def test_files_of_a_run_that_goes_on_are_notes(copy: Path) -> None:
    """What was made since the ledger was read is nobody's fault, however many episodes."""
    extra = copy / FOLDER / "data" / "episode_0000009.hdf5"
    extra.write_bytes(b"")
    (copy / FOLDER / STAGING).mkdir()
    assert words(verify(copy)) == f"{extra}: is in no manifest"  # a killed run leaves one at most
    with FolderLock(copy):
        report = verify(copy)
    assert report.sound and f"{extra}: newer than what was checked; a run goes on" in report.notes


def test_a_file_beside_the_datasets_is_no_part_of_them(copy: Path) -> None:
    """A README, a licence: a user may add what is no data."""
    for folder in (copy, copy / FOLDER.partition("/")[0]):
        (folder / "notes.txt").write_text("mine")
    report = verify(copy)
    assert report.sound and not report.notes


def test_without_a_dataset(tmp_path: Path, three: Path) -> None:
    assert "there is no manifest.json here" in words(verify(tmp_path))
    assert "there is no such folder" in words(verify(tmp_path / "gone"))
    whole = f"there is no manifest.json here (this is a part of {three})"
    assert whole in words(verify(three / "phys_random"))
    with pytest.raises(BadFile, match="this is a part of"):  # every reader says it
        Dataset(three / "phys_random")


@pytest.mark.parametrize(
    ("way", "value", "text"),
    [
        (("attributes", "friction", "value"), 0.5, "attributes.friction is 0.5, the seed"),
        (("attributes", "friction", "varied"), False, "attributes.friction.varied"),
        (("attributes", "friction", "tolerance"), 0.5, "attributes.friction.tolerance"),
        (("attributes", "table_tilt", "unit"), "rad", "attributes.table_tilt.unit"),
        (("attributes", "center_of_mass", "value"), lambda v: v[::-1], "center_of_mass"),
        (("attributes",), lambda v: dict([*v.items()][1:]), "is missing"),
        (("draws", "camera_mode"), "spin", "draws.camera_mode is 'spin'"),
        (("draws", "center_of_mass_redraws"), 9, "center_of_mass is"),
        (("seed",), 77, "seed is 77, the ledger says 1"),
        (("task",), "stack", "task is 'stack'"),
        (
            ("recipe", "spec", "embodiment"),
            "franka-panda",
            "recipe is not the ledger's: spec.embodiment was 'aloha-agilex', now 'franka-panda'",
        ),
        (("verdict", "accepted"), False, "verdict.accepted"),
        (("mood",), "good", "mood: extra inputs"),
        (("domain", "digest"), "0" * 64, "domain is"),
    ],
)
def test_a_label_that_lies_is_found(
    copy: Path, way: tuple[str, ...], value: object, text: str
) -> None:
    forge(copy, lambda forger: forger.label(1, put(*way, value=value)))
    report = verify(copy)
    assert {p.path.name for p in report.problems} == {"episode_0000001.json"}
    assert text in words(report)


def test_wrong_hdf5_content_with_valid_checksums(copy: Path) -> None:
    def scramble(forger: Forger) -> None:
        with h5py.File(forger.place.episode(0).hdf5, "r+") as file:
            file["action/left_arm_joint_states"][2, 1] += 1
            file["vision/cam_head/colors"][1] = b"\xff\xd8 no picture \xff\xd9"
            file["vision/cam_head/colors"][2] = file["vision/cam_head/colors"][2].replace(MARK, b"")
        with h5py.File(forger.place.episode(2).hdf5, "r+") as file:
            file["rtphys/time"][-1] += 0.01
            del file["state/right_ee_poses"]

    forge(copy, scramble)
    text = words(verify(copy))
    assert "episode_0000000.hdf5: action/left_arm_joint_states differs from the recorded" in text
    assert "episode_0000000.hdf5: head_camera picture 1 does not decode" in text
    assert "head_camera picture 2 is not marked as standard RGB" in text
    assert "episode_0000002.hdf5: state/right_ee_poses is missing" in text
    assert "episode_0000002.hdf5: frames are 0.06 to 0.07 s apart" in text


@pytest.mark.parametrize(
    ("joints", "text"),
    [
        ((7, 7), "an arm has 7 joints, not 6: it is not the aloha's"),
        ((6, 6), "has no joint 'fl_joint1': it is not of the robot aloha-agilex"),
    ],
)
def test_joints_of_another_robot(
    tmp_path: Path, joints: tuple[int, int], text: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As of a recorded evaluation whose spec named another robot than the one that acted."""
    monkeypatch.delenv("XDG_CACHE_HOME")  # else it builds an asset pack of its own
    digest = {"pack": "builtin", "digest": default_pack().digest}
    frames = synthetic.frames_of(0, joints=joints)
    names = tuple(name.replace("fl", "left").replace("fr", "right") for name in frames.joint_names)
    other = replace(synthetic.episode(0), frames=replace(frames, joint_names=names))
    write(tmp_path, other, what=synthetic.header(assets=digest))
    assert words(verify(tmp_path)).endswith(text)


def test_video_with_too_few_frames(copy: Path) -> None:
    short = encode_images(synthetic.pictures(0, 3)).video
    forge(copy, lambda forger: forger.place.episode(0).video.write_bytes(short))
    assert "has 3 frames for 4 recorded ones" in words(verify(copy))


def test_forging_nothing_changes_nothing(copy: Path, three: Path) -> None:
    forge(copy, lambda _: None)
    assert content(copy) == content(three)


def test_deep_looks_at_the_meaning(copy: Path) -> None:
    """Synthetic joints are noise and cameras hang in the air: only a deep look notices."""
    report = verify(copy, Effort.DEEP)
    text = words(report)
    assert "left_camera moves by" in text
    assert "leaves its limits" in text
    assert "extrinsic_cv and cam2world_gl disagree" not in text


def test_what_was_sound_is_remembered_by_digest(copy: Path, tmp_path: Path) -> None:
    memory = tmp_path / "cache" / "verified.txt"
    assert verify(copy, memory=memory).sound
    assert len(memory.read_text().split()) == 3
    before = memory.read_text()
    assert verify(copy, memory=memory).sound
    assert memory.read_text() == before
    forge(copy, lambda f: f.label(1, put("attributes", "friction", "value", value=0.5)))
    assert "attributes.friction is 0.5" in words(verify(copy, memory=memory))
    path = copy / FOLDER / "data/episode_0000002.hdf5"
    path.write_bytes(path.read_bytes()[:-1] + b"!")
    assert str(path) in words(verify(copy, memory=memory)), "a checksum is never remembered"


@pytest.mark.parametrize(
    ("part", "value", "text"),
    [
        (
            ("resolved", "domain", "rules", "friction"),
            {"uniform": [1, 2]},
            "domain global has digest",
        ),
        (("spec", "episode", "protocol"), "clean", "protocol is 'phys_random'"),
        (("spec", "episode", "overrides"), {"friction": 0.3}, "attributes.friction is"),
        (("spec", "episode", "pair_tasks"), True, "the seed gives"),
    ],
)
def test_what_was_sound_under_another_spec_is_looked_at_again(
    copy: Path, tmp_path: Path, part: tuple[str, ...], value: object, text: str
) -> None:
    memory = tmp_path / "cache" / "verified.txt"
    assert verify(copy, memory=memory).sound

    def edit(forger: Forger) -> None:
        forger.header["spec"]["config"] = "phys_random"  # the folder's name stays
        put(*part, value=value)(forger.header)

    forge(copy, edit)
    assert text in words(verify(copy, memory=memory))


def test_a_memory_that_cannot_be_written_only_costs_time(copy: Path, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    assert verify(copy, memory=tmp_path / "file" / "verified.txt").sound


# ---- the ledger and what follows from it -------------------------------------------------------


def lines(copy: Path, change: Callable[[list[bytes]], object]) -> None:
    """Changes lines of the ledger, and leaves all that follows from it."""
    path = copy / LEDGER
    found = path.read_bytes().splitlines(keepends=True)
    change(found)
    path.write_bytes(b"".join(found))


@pytest.mark.parametrize(
    ("change", "text"),
    [
        (lambda ls: ls.pop(), "has fewer lines than the manifest counted"),
        (lambda ls: ls.pop(2), "line 3: its checksum does not match"),
        (lambda ls: ls.pop(0), "line 1: its checksum does not match"),
        (lambda ls: ls.insert(2, ls.pop(3)), "line 3: its checksum does not match"),
        (lambda ls: ls.insert(2, ls[1]), "line 3: its checksum does not match"),
        (lambda ls: ls.__setitem__(-1, ls[-1][:-9]), "has fewer lines than the manifest counted"),
        (lambda ls: ls.__setitem__(1, ls[1].replace(b"0.", b"1.", 1)), "line 2: its checksum"),
        (lambda ls: ls.clear(), "is empty"),
    ],
)
def test_lines_that_are_lost_moved_torn_or_changed(
    copy: Path, change: Callable[[list[bytes]], object], text: str
) -> None:
    lines(copy, change)
    report = verify(copy)
    assert f"{copy / LEDGER}" in words(report) and text in words(report)


def test_a_dataset_without_its_ledger(copy: Path) -> None:
    (copy / LEDGER).unlink()
    assert words(verify(copy)) == (
        f"{copy / LEDGER}: is missing: it lists every attempt and every file"
    )


@pytest.mark.parametrize(
    ("change", "text"),
    [
        (put("episodes", value=2), "differs from what the ledgers say"),
        (put("frames", value=99), "differs from what the ledgers say"),
        (put("rejections", value={"unlucky": 1}), "differs from what the ledgers say"),
        (put("could_act", value=[]), "differs from what the ledgers say"),
        (put("ledger", "check", value="0" * 64), "does not agree with the ledger of"),
        (put("ledger", "bytes", value=9), "differs from what the ledgers say"),
        (put("ledger", "lines", value=99), "has fewer lines than the manifest counted"),
        (put("spec", "first_seed", value=3), "is not what its ledger says: spec.first_seed"),
        (put("spec", "episode", "split", value="unseen"), "ledger says: spec.episode.split"),
        (put("resolved", "versions", "rtphys", value="9"), "says: resolved.versions.rtphys"),
        (put("spec", "episode", "task", value="stack_bowls_two"), "does not lie where its task"),
    ],
)
def test_a_manifest_that_was_edited(copy: Path, change: Callable[[Entry], None], text: str) -> None:
    path = copy / "manifest.json"
    manifest = json.loads(path.read_text())
    change(manifest["task_datasets"][FOLDER])
    path.write_bytes(pretty(manifest))
    assert text in words(verify(copy))


def test_a_field_that_an_older_rtphys_did_not_write_has_its_usual_value(copy: Path) -> None:
    recording = ("task_datasets", FOLDER, "spec", "recording")
    forge(copy, lambda forger: forger.header["spec"]["recording"].pop("shader"))
    manifest = json.loads((copy / "manifest.json").read_text())
    put(*recording, value=lambda old: {k: v for k, v in old.items() if k != "shader"})(manifest)
    (copy / "manifest.json").write_bytes(pretty(manifest))
    assert words(verify(copy)) == ""
    put(*recording, "look", value="clean")(manifest)
    (copy / "manifest.json").write_bytes(pretty(manifest))
    assert "is not what its ledger says: spec.recording.look" in words(verify(copy))


def entry(*way: object, value: object) -> Forge:
    return lambda forger: put(*way, value=value)(forger.entries)


@pytest.mark.parametrize(
    ("change", "text"),
    [
        (lambda f: f.entries.pop(3), "attempt 2 is of seed 3, not of 2: one is missing"),
        (entry(4, "seed", value=7), "attempt 3 is of seed 7, not of 3: one is missing"),
        (entry(4, "frames", value=5), "has 4 frames, the ledger says 5"),
        (entry(4, "recovered", value=True), "verdict.recovered is False, the ledger says True"),
        (lambda f: f.entries[1]["files"].popitem(), "lists ["),
        (lambda f: f.entries[4]["files"].update({"data/episode_0000009.hdf5": NOTHING}), "lists ["),
        (entry(4, "physics", "friction", value=0.5), "attributes.friction is 1.14"),
    ],
)
def test_a_line_that_lies_with_a_sound_chain(copy: Path, change: Forge, text: str) -> None:
    forge(copy, change)
    assert text in words(verify(copy))


@pytest.mark.parametrize("name", ["seed.txt", "seeds.txt", "scene_info.json"])
@pytest.mark.parametrize("change", [lambda d: d + b" ", lambda d: d[:-1], lambda d: b"", None])
def test_side_files_follow_from_the_ledger(
    copy: Path, name: str, change: Callable[[bytes], bytes] | None
) -> None:
    path = copy / FOLDER / name
    data = path.read_bytes()
    if change is None:
        path.unlink()
        assert words(verify(copy)) == f"{path}: no such file or directory"
    else:
        path.write_bytes(change(data))
        assert words(verify(copy)) == f"{path}: is not what the ledger says"


# ---- runs that were cut off, and twins -----------------------------------------------------------


def test_a_manifest_that_lags(ahead: Path) -> None:
    """All that the ledger lists is checked; the side files may be of any moment since."""
    report = verify(ahead)
    assert (words(report), report.newer, report.episodes, report.files) == ("", 2, 3, 15)
    assert (
        f"{FOLDER}: the manifest lacks the last 2 attempts; the run was cut off or"
        in report.notes[0]
    )
    path = ahead / FOLDER / "data/episode_0000002.hdf5"
    path.write_bytes(path.read_bytes()[:-1])
    assert words(verify(ahead)).startswith(f"{path}: has ")
    lines(ahead, lambda found: found.pop(3))
    assert "line 4: its checksum does not match" in words(verify(ahead))


@pytest.mark.parametrize("name", ["seed.txt", "seeds.txt", "scene_info.json"])
def test_side_files_of_no_moment_since(ahead: Path, name: str) -> None:
    path = ahead / FOLDER / name
    path.write_bytes(path.read_bytes().replace(b"1", b"7"))
    assert words(verify(ahead)) == f"{path}: is not what the ledger says"


def test_a_torn_line_and_files_of_a_commit_that_was_cut_off(ahead: Path) -> None:
    """Of the next episode alone; they are notes, and gone with the next run."""
    lines(ahead, lambda found: found.append(found[-1][:-9]))
    place = TaskDataset(ahead, "phys_random", "click_bell", EMBODIMENT, "native")
    for path in (place.episode(3).hdf5, place.folder / ".seed.txt.part"):
        path.write_bytes(b"torn")
    report = verify(ahead)
    assert report.sound and "crash cut its last line short" in "".join(report.notes)
    assert "".join(report.notes).count("of a commit that was cut off; resuming removes it") == 2
    place.episode(4).hdf5.write_bytes(b"nobody's")
    assert words(verify(ahead)) == f"{place.episode(4).hdf5}: is in no manifest"
    place.episode(4).hdf5.unlink()
    collect(ahead, 4)
    assert (words(verify(ahead)), verify(ahead).notes) == ("", [])


def test_a_task_dataset_that_is_in_no_manifest_yet(copy: Path) -> None:
    (copy / "manifest.json").unlink()
    assert "(a collection has only begun; resume it; if the manifest was deleted," in words(
        verify(copy)
    )
    collect(copy, 1, synthetic.header("legacy"))
    assert FOLDER in json.loads((copy / "manifest.json").read_text())["task_datasets"]
    (copy / "manifest.json").write_bytes(manifest_bytes({}))
    notes = verify(copy).notes
    assert f"{FOLDER}: was begun and is not in the manifest yet; resume it" in notes


def twins(out: Path, seeds: tuple[int, int] = (4, 4)) -> None:
    """Two task datasets that pair their episodes, of so many attempts."""
    both = synthetic.header(twin="phys_random_all", recovery=False).spec.sides
    with DatasetWriter(out) as dataset:
        for side, attempts in zip(both, seeds, strict=True):
            task = dataset.task(replace(synthetic.header(), spec=side))
            while task.totals.attempts < attempts:
                task.record(outcome(task, task.next_seed))


def test_twins(tmp_path: Path) -> None:
    twins(tmp_path / "both")
    report = verify(tmp_path / "both")
    lie = "protocol is 'phys_random', the ledger says 'phys_random_all'"
    assert {p.text for p in report.problems} <= {lie}
    assert not [note for note in report.notes if "twin" in note]
    twins(tmp_path / "ahead", (4, 2))
    other = FOLDER.replace("phys_random", "phys_random.twin=phys_random_all")
    note = f"{FOLDER}: some episodes are not in {other} yet; resume it"
    assert note in verify(tmp_path / "ahead").notes
    ahead, some = Dataset(tmp_path / "ahead"), tmp_path / "some"
    assert [one.episode.seed for one in ahead.pairs()] == [0, 1], "3 has no twin yet"
    subset(Dataset(tmp_path / "both").where(seeds=range(1, 9)), some)
    pairs = Dataset(some).pairs()
    assert [(one.seed, twin.seed) for one, twin in pairs] == [(1, 1), (3, 3)]
    assert verify(some).notes == []
    subset(Dataset(tmp_path / "both").where(config="phys_random"), tmp_path / "one")
    assert "its twin phys_random.twin=phys_random_all" in "".join(verify(tmp_path / "one").notes)


def test_twins_that_pair_other_seeds(tmp_path: Path) -> None:
    both = synthetic.header(twin="phys_random_all").spec.sides
    with DatasetWriter(tmp_path) as dataset:
        first, second = (dataset.task(replace(synthetic.header(), spec=side)) for side in both)
        first.record(outcome(first, 0))
        second.record(Rejection(0, "slipped"))
        first.record(Rejection(1, "slipped"))
        second.record(outcome(second, 1))
    assert "pair other seeds" in words(verify(tmp_path))
