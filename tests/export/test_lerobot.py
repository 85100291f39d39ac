"""The LeRobot export against the format's rules and against the episodes it came from."""

import errno
import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import sensing
import synthetic
from collected import FRAMES, collect, keep, write

from pages import ran
from rtphys.core.errors import BadFile, BadValue, UnknownName
from rtphys.data import files, video
from rtphys.data.dataset import Dataset
from rtphys.data.faults import CannotWrite, DatasetLocked

pa = pytest.importorskip("pyarrow", reason="the extra rtphys[lerobot] is not installed")
pq = pytest.importorskip("pyarrow.parquet", reason="the extra rtphys[lerobot] is not installed")

from groot_reader import Reader  # noqa: E402

from rtphys.export import lerobot  # noqa: E402
from rtphys.export.card import CardText, croissant  # noqa: E402
from rtphys.export.lerobot import ExportSpec, Progress, export_lerobot  # noqa: E402
from rtphys.export.lerobot_episode import (  # noqa: E402
    STRIDE,
    count,
    none_counted,
    of_numbers,
    of_pixels,
)
from rtphys.export.lerobot_plan import RATES, Video, plan_for  # noqa: E402
from rtphys.export.lerobot_verify import verify_export  # noqa: E402
from rtphys.policies.lerobot import physics_vector  # noqa: E402

R = FRAMES - 1
MIXED = "piper,franka-panda,0.7"
VIDEOS = ("cam_high", "cam_left_wrist", "cam_right_wrist")
TABLE, EPISODES = "data/chunk-000/file-000.parquet", "meta/episodes/chunk-000/file-000.parquet"


@pytest.fixture(scope="module")
def v3(dataset: Dataset, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return export_lerobot(dataset, tmp_path_factory.mktemp("v3") / "out")


def export(
    dataset: Dataset, out: Path, progress: Progress | None = None, **of: str | tuple[str, ...]
) -> Path:
    return export_lerobot(dataset, out, ExportSpec(**of), progress)  # type: ignore[arg-type]


def of_robot(out: Path, robot: str, arms: tuple[int, int]) -> Dataset:
    """One episode of a robot with so many joints an arm."""
    what, frames = synthetic.header(embodiment=robot), synthetic.frames_of(0, FRAMES, arms)
    episode = synthetic.episode(0, FRAMES, what.spec.episode)
    return write(out, replace(episode, frames=frames), what=what)


def info(root: Path) -> dict:
    return json.loads((root / "meta/info.json").read_text())


def test_info_agrees_with_the_tables(v3: Path) -> None:
    meta, table = info(v3), pq.read_table(v3 / TABLE)
    declared = {n: f for n, f in meta["features"].items() if f["dtype"] != "video"}
    assert {*table.column_names} == {*declared}, "a loader refuses undeclared columns"
    assert (meta["total_episodes"], meta["total_frames"], meta["total_tasks"]) == (3, 3 * R, 1)
    assert meta["fps"] == 17, "LeRobot's tools cut videos at whole numbers"
    for name, feature in declared.items():
        kind = table.schema.field(name).type
        if feature["shape"] == [1]:
            assert str(kind) == feature["dtype"].replace("float32", "float")
        else:
            assert (str(kind.value_type), [kind.list_size]) == ("float", feature["shape"])
            assert len(feature["names"]) == kind.list_size


def test_an_export_has_as_many_numbers_as_the_robot(tmp_path: Path) -> None:
    dataset = of_robot(tmp_path / "data", MIXED, (6, 7))
    for version in ("v3.0", "v2.1"):
        stated = info(export(dataset, tmp_path / version, version=version))
        assert stated["robot_type"] == MIXED
        assert stated["features"]["action"]["shape"] == [15]
        assert stated["features"]["action"]["names"][6:8] == ["left_gripper", "right_joint_1"]
        assert stated["features"]["observation.effort"]["shape"] == [6 + 7 + 4]
    modality = json.loads((tmp_path / "v2.1/meta/modality.json").read_text())
    assert modality["action"]["right_arm"] == {"start": 7, "end": 14}
    assert modality["action"]["right_gripper"] == {"start": 14, "end": 15}


def test_rows_are_the_episodes(v3: Path, dataset: Dataset) -> None:
    table = pq.read_table(v3 / TABLE).to_pydict()
    assert table["index"] == list(range(3 * R))
    for number, episode in enumerate(dataset):
        rows = slice(number * R, (number + 1) * R)
        assert table["episode_index"][rows] == [number] * R
        assert table["frame_index"][rows] == list(range(R))
        vector = episode.frames.vector.astype(np.float32)
        np.testing.assert_array_equal(table["observation.state"][rows], vector[:-1])
        np.testing.assert_array_equal(table["action"][rows], vector[1:])
        effort = episode.frames.effort.astype(np.float32)
        np.testing.assert_array_equal(table["observation.effort"][rows], effort[:-1])
        np.testing.assert_allclose(table["timestamp"][rows], np.arange(R) / 17, atol=1e-6)


def test_episode_rows_carry_the_physics(v3: Path, dataset: Dataset) -> None:
    rows = pq.read_table(v3 / EPISODES).to_pylist()
    for row, episode in zip(rows, dataset, strict=True):
        assert (row["rtphys/config"], row["rtphys/seed"]) == ("phys_random", episode.seed)
        assert row["phys/friction"] == episode.physics["friction"]
        assert row["phys/center_of_mass"] == list(episode.physics.vector("center_of_mass"))
        assert row["tasks"] == ["ring the bell"]
        assert row["dataset_to_index"] - row["dataset_from_index"] == row["length"] == R
    assert sum(key.startswith("phys/") for key in rows[0]) == 13


@pytest.mark.parametrize("version", ["v3.0", "v2.1"])
def test_physics_that_could_not_act_is_null_in_every_table(tmp_path: Path, version: str) -> None:
    """Also where no episode has a number: the column is there, and is one of numbers."""
    collect(tmp_path / "data", 2)
    for number, episode in enumerate(Dataset(tmp_path / "data")):
        path = episode.paths.phys_meta
        meta = json.loads(path.read_text())
        for key, label in meta["attributes"].items():
            label |= {"could_act": key != "object_mass"}
            label |= {"acted": False} if key == "restitution" and not number else {}
        path.write_text(json.dumps(meta))
    own = Dataset(tmp_path / "data")
    out = export_lerobot(own, tmp_path / "lr", ExportSpec(version=version))
    if version == "v3.0":
        table = pq.read_table(out / EPISODES)
        assert table.schema.field("phys/object_mass").type == pa.float64()
        rows = table.to_pylist()
    else:
        rows = [json.loads(line) for line in (out / "meta/episodes.jsonl").open()]
    assert [row["phys/object_mass"] for row in rows] == [None, None]
    assert [row["phys/restitution"] for row in rows] == [None, own[1].physics["restitution"]]
    assert [row["phys/friction"] for row in rows] == [one.physics["friction"] for one in own]
    (records,) = croissant(own, CardText("name"))["recordSet"]  # type: ignore[misc]
    assert [one["episodes/object_mass"] for one in records["data"]] == [None, None]


def test_videos_show_the_frames_at_their_times(v3: Path, dataset: Dataset) -> None:
    rows = pq.read_table(v3 / EPISODES).to_pylist()
    for name, camera in zip(VIDEOS, dataset[0].cameras, strict=True):
        key = f"videos/observation.images.{name}"
        data = (v3 / key / "chunk-000/file-000.mp4").read_bytes()
        facts = video.probe(data)
        assert (facts.frames, facts.codec) == (3 * R, "h264")
        assert facts.fps == pytest.approx(17, rel=1e-6)
        pictures = np.stack([*video.decode(data)]).astype(int)
        for row, episode in zip(rows, dataset, strict=True):
            first = round(row[f"{key}/from_timestamp"] * 17)
            truth = episode.images(camera)[:-1]
            error = np.abs(pictures[first : first + R] - truth).mean()
            other = np.abs(pictures[first : first + R] - truth[..., ::-1]).mean()
            assert error < 12 < other, "right frames, true colours"


def test_statistics(v3: Path, dataset: Dataset) -> None:
    stats = json.loads((v3 / "meta/stats.json").read_text())
    action = np.concatenate([e.action for e in dataset]).astype(np.float32).astype(np.float64)
    np.testing.assert_allclose(stats["action"]["mean"], action.mean(axis=0))
    np.testing.assert_allclose(stats["action"]["q99"], np.quantile(action, 0.99, axis=0))
    assert stats["action"]["count"] == stats["observation.images.cam_high"]["count"] == [3 * R]
    assert set(stats) == set(info(v3)["features"])


@pytest.mark.parametrize("depth", [False, True])
def test_pixel_statistics_are_exact(depth: bool) -> None:
    rng = np.random.default_rng(0)
    levels, channels = (4096, 1) if depth else (256, 3)
    pictures = rng.integers(0, levels, (4, 120, 160, channels), dtype=np.uint16)
    counts = none_counted(Video("head_camera", depth))
    for picture in pictures:
        count(counts, picture)
    stats = of_pixels(counts, len(pictures))
    scale = 1 if depth else 255
    truth = of_numbers(pictures[:, ::STRIDE, ::STRIDE].reshape(-1, channels) / scale)
    for name in ("min", "max", "mean", "std", "q01", "q50", "q99"):
        exact = 1e-9 if name[0] != "q" else 0.01 if not depth else 2
        assert stats[name].shape == (channels, 1, 1)
        np.testing.assert_allclose(stats[name].ravel(), truth[name], rtol=1e-9, atol=exact)


def test_depth_is_a_video_of_millimetres(tmp_path: Path) -> None:
    """As lerobot 0.6 stores it: single-channel HEVC without loss, whose scale info.json states."""
    made = sensing.sensed(0, FRAMES, ("depth",))
    for tracks in made.tracks.values():
        tracks[0][0, :2] = 0.0, 5.0  # nothing, and farther than the largest number
    one = replace(synthetic.episode(0, FRAMES), sensed=made)
    data = write(tmp_path / "data", one, what=synthetic.header(senses=("depth",)))
    out = export(data, tmp_path / "lr", features=("depth",))
    key = "observation.images.cam_high_depth"
    feature = info(out)["features"][key]
    assert feature["shape"] == [synthetic.HEIGHT, synthetic.WIDTH, 1]
    about = feature["info"]
    assert about["is_depth_map"] and about["video.pix_fmt"] == "gray12le"
    path = out / "videos" / key / "chunk-000/file-000.mp4"
    assert video.probe(path.read_bytes()).codec == "hevc" == about["video.codec"]
    codes = np.stack([*video.decode(path.read_bytes())])
    span = about["video.depth_max"] - about["video.depth_min"]
    metres = about["video.depth_min"] + codes / 4095 * span  # lerobot's `dequantize_depth`
    truth = np.stack([data[0].senses.depth("head_camera", t) for t in range(R)])
    assert np.abs(metres - truth.clip(0, 4.095)).max() < 0.5001e-3
    assert codes[0, 0, 0] == 0 and codes[0, 0, 1] == 4095
    stats = json.loads((out / "meta/stats.json").read_text())[key]
    assert stats["max"] == [[[4095 if STRIDE == 1 else codes[:, ::STRIDE, ::STRIDE].max()]]]
    assert verify_export(out, data) == []
    other = path.with_name("other.mp4")
    writer = video.VideoWriter(*codes.shape[1:], RATES["v3.0"], 2, depth=True)
    codes[2, 5, 5] ^= 1
    for picture in codes:
        writer.add(picture)
    other.write_bytes(writer.finish())
    other.replace(path)
    (problem,) = verify_export(out, data)
    assert "head_camera, depth, frame 2: another picture" in problem
    with pytest.raises(BadValue, match=r"depth.* from v3\.0 on"):
        export(data, tmp_path / "old", version="v2.1", features=("depth",))
    clash = "head=a,left=a_depth"  # the second would take the place of the first one's depth
    with pytest.raises(BadValue, match=r"'a_depth' is not allowed; .* depth of head_camera"):
        export(data, tmp_path / "clash", camera_names=clash, features=("depth",))
    named = info(export(data, tmp_path / "named", camera_names=clash))["features"]
    assert {"observation.images.a", "observation.images.a_depth"} <= named.keys()


def test_the_command_says_which_format_a_converter_breaks(dataset: Dataset, tmp_path: Path) -> None:
    """LeRobot's converter rounds the frame rate of v2.1 to 16, and then cuts videos wrongly."""
    said = {}
    for version in ("v2.1", "v3.0"):
        words = ["export", "lerobot", str(dataset.path), "--out", str(tmp_path / version)]
        done = ran([*words, "--version", version], columns=300)
        said[version] = "converter to v3.0 breaks it: export v3.0" in done.output
    assert said == {"v2.1": True, "v3.0": False}


def test_a_consumer_reads_v21_by_its_modalities(dataset: Dataset, tmp_path: Path) -> None:
    """A window of observations and a chunk of actions, as a policy's loader asks for them."""
    root = export(dataset, tmp_path / "out", version="v2.1")
    reader, meta = Reader(root), info(root)
    assert (meta["codebase_version"], meta["fps"]) == ("v2.1", 250 / 15)
    assert reader.lengths == dict.fromkeys(range(3), R)
    lines = (root / "meta/episodes_stats.jsonl").read_text().splitlines()
    assert [json.loads(line)["episode_index"] for line in lines] == [0, 1, 2]
    for number, episode in enumerate(dataset):
        at = {"episode_chunk": 0, "episode_index": number}
        table = pq.read_table(root / meta["data_path"].format(**at))
        assert table["index"].to_pylist() == list(range(number * R, (number + 1) * R))
        frames, ahead = episode.frames, range(1, R + 2)
        vector = frames.vector.astype(np.float32)
        rows = np.minimum(list(ahead), R - 1)
        for side, first in (("left", 0), ("right", 7)):
            arm, hand = f"{side}_arm", f"{side}_gripper"
            state = reader.part(number, "state", arm, [0, R - 1])
            np.testing.assert_array_equal(state, vector[[0, R - 1], first : first + 6])
            chunk = reader.part(number, "action", arm, ahead)
            np.testing.assert_array_equal(chunk, getattr(frames, arm).astype(np.float32)[rows + 1])
            grip = reader.part(number, "action", hand, ahead)[:, 0]
            np.testing.assert_array_equal(grip, getattr(frames, hand).astype(np.float32)[rows + 1])
        for view, camera in zip(VIDEOS, dataset[0].cameras, strict=True):
            truth = episode.images(camera)[:-1].astype(int)
            key = f"observation.images.{view}"
            clip = root / meta["video_path"].format(video_key=key, **at)
            assert video.probe(clip.read_bytes()).frames == R
            assert reader.size(view) == (*truth.shape[1:], float(RATES["v2.1"]))
            assert np.abs(reader.frames(number, view, range(R)) - truth).mean() < 12
        assert reader.sentence(number, "human.task_description", R - 1) == "ring the bell"


def test_physics_in_each_frame(dataset: Dataset, tmp_path: Path) -> None:
    """Under our name, and under the one that LeRobot's own policies read."""
    root = export(dataset, tmp_path / "out", features=("physics", "environment_state"))
    table, features = pq.read_table(root / TABLE).to_pydict(), info(root)["features"]
    names = features["observation.physics"]["names"]
    assert features["observation.environment_state"]["names"] == names
    assert table["observation.environment_state"] == table["observation.physics"]
    friction = [row[names.index("friction")] for row in table["observation.physics"]]
    stated = [np.float32(episode.physics["friction"]) for episode in dataset]
    assert friction == [value for value in stated for _ in range(R)]
    # What an oracle is shown in an evaluation has the same order.
    shown = [physics_vector(episode.physics).tolist() for episode in dataset for _ in range(R)]
    assert table["observation.environment_state"] == shown


def with_own_damping(dataset: Dataset, *seeds: int) -> Dataset:
    """The hinges of these episodes have the asset's own, as under `clean` or `only_friction`."""
    for episode in dataset:
        if episode.seed in seeds:
            path = episode.paths.phys_meta
            meta = json.loads(path.read_text())
            meta["attributes"]["object_joint_damping"]["value"] = None
            path.write_text(json.dumps(meta))
    return Dataset(dataset.path)


@pytest.mark.parametrize("version", ["v3.0", "v2.1"])
def test_what_is_the_assets_own_in_every_episode_is_left_out_and_named(
    tmp_path: Path, version: str
) -> None:
    collect(tmp_path / "data", 2)
    own = with_own_damping(Dataset(tmp_path / "data"), 0, 1)
    wanted, root, said = ExportSpec(version, features=("physics",)), tmp_path / "lr", list[str]()
    export_lerobot(own, root, wanted, notice=said.append)
    names = info(root)["features"]["observation.physics"]["names"]
    assert "object_joint_damping" not in names and "friction" in names
    (line,) = said
    assert line.endswith("the asset's own is no number: object_joint_damping")
    if version == "v3.0":
        rows = pq.read_table(root / TABLE).to_pydict()["observation.physics"]
        friction = [row[names.index("friction")] for row in rows]
        assert friction == [np.float32(one.physics["friction"]) for one in own for _ in range(R)]
        assert verify_export(root, own) == []


def test_a_number_in_some_episodes_alone_is_refused_with_its_name(tmp_path: Path) -> None:
    collect(tmp_path / "data", 2)
    both = with_own_damping(Dataset(tmp_path / "data"), 1)
    said = (
        r"episode_0000001\.json: object_joint_damping is the asset's own here, and a number in "
        r".*episode_0000000\.json; .* export them apart, by `config` or `protocol`"
    )
    with pytest.raises(BadFile, match=said):
        export_lerobot(both, tmp_path / "lr", ExportSpec(features=("environment_state",)))
    part, root = both.where(seeds=[1]), tmp_path / "part"
    export_lerobot(part, root, ExportSpec(features=("physics",)))
    assert verify_export(root, both) == [], "the other episodes decide nothing"


@pytest.mark.parametrize(
    ("names", "expected"),
    [
        ("right_camera=wrist", ["wrist"]),
        ("robotwin", ["head_camera", "left_camera", "right_camera"]),
    ],
)
def test_chosen_cameras(dataset: Dataset, tmp_path: Path, names: str, expected: list[str]) -> None:
    root = export(dataset, tmp_path / "out", camera_names=names)
    shown = [n for n in info(root)["features"] if "images" in n]
    assert shown == [f"observation.images.{name}" for name in expected]


@pytest.fixture
def mixed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Dataset:
    """Of click_bell with two robots, of lift_pot with fewer cameras, of stack_bowls with large
    pictures."""
    out = tmp_path / "mixed"
    collect(out, 1)
    collect(out, 1, synthetic.header(embodiment=MIXED))
    monkeypatch.setattr(synthetic, "CAMERAS", ("head_camera", "right_camera"))
    collect(out, 1, synthetic.header(task="lift_pot", cameras=("head", "right")))
    monkeypatch.setattr(synthetic, "WIDTH", 96)
    collect(out, 1, synthetic.header(task="stack_bowls_two", cameras=("head", "right")))
    return Dataset(out)


def test_what_the_episodes_of_an_export_share_is_exported(mixed: Dataset, tmp_path: Path) -> None:
    """Others of the dataset decide nothing, neither when it is written nor when it is compared."""
    named, usual = ExportSpec(camera_names="robotwin"), mixed.where(embodiment="aloha-agilex")
    alike = [one for one in usual if one.task != "stack_bowls_two"]
    shared = {one.camera for one in plan_for(alike, named).videos.values()}
    assert shared == {"head_camera", "right_camera"}
    with pytest.raises(UnknownName, match="left_camera"):
        plan_for(alike, ExportSpec(camera_names="left_camera=wrist"))
    with pytest.raises(BadValue, match=f"aloha-agilex, {MIXED}.*by `embodiment`"):
        plan_for(mixed, named)
    sizes = r"64x48 \(click_bell, phys_random, .*; 96x48 \(stack_bowls_two.* have one size"
    with pytest.raises(BadValue, match=sizes):
        plan_for(usual, named)
    for number, part in enumerate((mixed.where(embodiment=MIXED), usual.where(task="click_bell"))):
        root = export(part, tmp_path / str(number))
        assert len([*(root / "videos").iterdir()]) == 3
        assert verify_export(root, mixed) == []
        next((root / "videos" / "observation.images.cam_left_wrist").rglob("*.mp4")).unlink()
        with pytest.raises(BadFile, match=r"\.mp4"):
            verify_export(root, mixed)


@pytest.mark.parametrize(
    ("of", "error", "problem"),
    [
        ({"features": ("touch",)}, BadFile, r"holds no touch; .* senses=touch` records it$"),
        ({"version": "v4"}, UnknownName, "LeRobot version"),
        ({"camera_names": "head_cam=top"}, UnknownName, "did you mean 'head_camera'"),
        ({"camera_names": "head_camera=a,left_camera=a"}, BadValue, "a distinct name"),
        ({"camera_names": "head=a,head_camera=b"}, BadValue, "name head_camera once"),
        ({"sentences": "none"}, UnknownName, "choice of sentences"),
    ],
)
def test_refusals_leave_nothing(
    dataset: Dataset, tmp_path: Path, of: dict, error: type[Exception], problem: str
) -> None:
    with pytest.raises(error, match=problem):
        export(dataset, tmp_path / "out", **of)
    assert list(tmp_path.iterdir()) == []


def test_failures_are_not_exported(tmp_path: Path) -> None:
    keep(tmp_path / "kept")
    kept = Dataset(tmp_path / "kept")
    assert len(kept.failures()) == 2
    assert info(export(kept, tmp_path / "out"))["total_episodes"] == len(kept) == 5


def test_a_folder_that_is_not_empty_is_left_alone(dataset: Dataset, tmp_path: Path) -> None:
    (tmp_path / "mine").write_text("")
    with pytest.raises(BadValue, match="it is not empty; delete it, or name a new folder"):
        export_lerobot(dataset, tmp_path)
    with pytest.raises(CannotWrite, match="a file stands where a folder is needed"):
        export_lerobot(dataset, tmp_path / "mine")


class Killed(BaseException):
    """Stands for the end of the process: nothing catches it."""


def contents(root: Path) -> dict[str, bytes]:
    return {str(p.relative_to(root)): p.read_bytes() for p in root.rglob("*") if p.is_file()}


@pytest.mark.parametrize("instant", [2, 4, 7, 12, 15])
@pytest.mark.parametrize("version", ["v3.0", "v2.1"])
def test_a_killed_export_goes_on(
    dataset: Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, version: str, instant: int
) -> None:
    """Killed before its nth file, it ends as one that was left alone, but encodes the rest only."""
    whole = export(dataset, tmp_path / "whole", version=version)
    left, encoded = [instant], []

    def dying(write: Callable[..., object]) -> Callable[..., object]:
        def writing(path: Path, data: object) -> object:
            left[0] -= 1
            if not left[0]:
                raise Killed
            return write(path, data)

        return writing

    with monkeypatch.context() as patched, pytest.raises(Killed):
        for name in ("write_synced", "replace_pieces"):
            patched.setattr(files, name, dying(getattr(files, name)))
        export(dataset, tmp_path / "out", version=version)
    assert not (tmp_path / "out").exists()
    known = len([*tmp_path.rglob("records/*.json")])
    again = lerobot.encode
    monkeypatch.setattr(lerobot, "encode", lambda *of: encoded.append(1) or again(*of))
    out = export(dataset, tmp_path / "out", version=version)
    assert contents(out) == contents(whole)
    assert len(encoded) == 3 - known
    assert sorted(path.name for path in tmp_path.iterdir()) == ["out", "whole"]


def stop(done: int, _: int) -> None:
    raise Killed


def test_the_rest_of_another_export_is_not_taken_over(dataset: Dataset, tmp_path: Path) -> None:
    with pytest.raises(Killed):
        export(dataset, tmp_path / "out", stop)
    two = [export(dataset, tmp_path / name, camera_names="robotwin") for name in ("out", "whole")]
    assert contents(two[0]) == contents(two[1])


def test_the_rest_of_another_robots_export_is_not_taken_over(tmp_path: Path) -> None:
    """Of the same task and seed: the rows would be those of the other robot."""
    of_robot(tmp_path / "data", "piper", (6, 6))
    both = of_robot(tmp_path / "data", "franka-panda", (7, 7))
    with pytest.raises(Killed):
        export(both.where(embodiment="piper"), tmp_path / "out", stop)
    out = export(both.where(embodiment="franka-panda"), tmp_path / "out")
    assert verify_export(out, both) == []


@pytest.mark.parametrize("version", ["v3.0", "v2.1"])
def test_a_link_and_the_current_folder_are_filled(
    dataset: Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, version: str
) -> None:
    """As a link to a larger disk, or after `mkdir lr && cd lr`."""
    (tmp_path / "disk" / "real").mkdir(parents=True)
    (tmp_path / "link").symlink_to(tmp_path / "disk" / "real")
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    for place in (tmp_path / "link", Path()):
        export(dataset, place, version=version)
    assert (tmp_path / "link").is_symlink()
    assert contents(tmp_path / "disk" / "real") == contents(tmp_path / "here")
    assert info(tmp_path / "here")["total_episodes"] == 3


def test_a_name_that_parquet_cannot_take_is_refused_at_once(
    dataset: Dataset, tmp_path: Path
) -> None:
    with pytest.raises(BadValue, match="takes no path that is not UTF-8"):
        export(dataset, tmp_path / "l\udcff")
    assert not [*tmp_path.iterdir()]


def test_an_export_that_could_not_be_moved_goes_on(
    dataset: Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As where its folder is a mount: nothing is encoded a second time."""

    def refuse(*_: object) -> None:
        raise OSError(errno.EBUSY, "Device or resource busy")

    with monkeypatch.context() as patched, pytest.raises(CannotWrite, match="busy"):
        patched.setattr(Path, "rename", refuse)
        export(dataset, tmp_path / "out", version="v2.1")
    monkeypatch.setattr(lerobot, "encode", lambda *_: pytest.fail("encoded again"))
    out = export(dataset, tmp_path / "out", version="v2.1")
    assert verify_export(out, dataset) == []
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


def test_a_disk_that_is_full_where_files_are_joined_is_named(
    dataset: Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(pa, "concat_tables", full)
    with pytest.raises(CannotWrite, match=f"cannot write {tmp_path / 'out'}: the disk is full"):
        export(dataset, tmp_path / "out")


@pytest.mark.parametrize("version", ["v3.0", "v2.1"])
@pytest.mark.parametrize("sentences", ["all", "task"])
def test_sentences_are_chosen(
    dataset: Dataset, tmp_path: Path, version: str, sentences: str
) -> None:
    spoken = {"all": ["ring the bell", "läute die Glocke"], "task": ["click bell"]}[sentences]
    out = export(dataset, tmp_path / "out", version=version, sentences=sentences)
    first = min((out / "data").rglob("*.parquet"))
    tasks = pq.read_table(first)["task_index"].to_pylist()[:R]
    assert tasks == [t % len(spoken) for t in range(R)], "they take turns"
    if version == "v3.0":
        rows = pq.read_table(out / "meta/tasks.parquet").to_pylist()
    else:
        rows = [json.loads(line) for line in (out / "meta/tasks.jsonl").read_text().splitlines()]
    assert [row["task"] for row in rows] == spoken


def test_a_second_export_to_one_folder_is_refused(dataset: Dataset, tmp_path: Path) -> None:
    def interrupted(done: int, _: int) -> None:
        if done == 2:
            with pytest.raises(DatasetLocked, match="another run writes here"):
                export(dataset, tmp_path / "out")

    export(dataset, tmp_path / "out", interrupted, version="v2.1")
    assert info(tmp_path / "out")["total_episodes"] == 3
    assert len([*(tmp_path / "out/data").rglob("*.parquet")]) == 3
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


def test_a_name_as_long_as_a_file_system_takes(dataset: Dataset, tmp_path: Path) -> None:
    out = export_lerobot(dataset, tmp_path / ("l" * 255))
    assert [*tmp_path.iterdir()] == [out]
