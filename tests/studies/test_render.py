"""A dataset drawn again: what was there comes out byte for byte, what is added is right."""

from collections import namedtuple
from pathlib import Path

import h5py
import numpy as np
import pytest
import synthetic
from collected import collect as collect_synthetic
from collected import content, keep, write

from rtphys.assets.pack import default_pack
from rtphys.campaign.series import Listener, Progress
from rtphys.core.errors import BadFile, BadValue, RtphysError
from rtphys.data.check_episode import Effort
from rtphys.data.dataset import Dataset
from rtphys.data.faults import DatasetMismatch
from rtphys.data.selection import Selection
from rtphys.data.verify import verify
from rtphys.data.writer import DatasetWriter, Rejection
from rtphys.spec.collection import CollectionSpec
from rtphys.spec.episode import EpisodeSpec
from rtphys.spec.recording import RecordingSpec
from rtphys.studies import render as module
from rtphys.studies.collect import collect
from rtphys.studies.render import (
    RenderSeries,
    RenderTask,
    RenderWorker,
    render,
)
from rtphys.studies.requests import RenderSpec, Run

TASK = "click_bell"


def collected(out: Path, recording: RecordingSpec) -> Path:
    spec = CollectionSpec(EpisodeSpec(TASK, "phys_random"), recording, episodes=1)
    collect([spec], Run(out=out, workers=1))
    return out


@pytest.fixture(scope="module")
def plain(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Without stored states: drawn again, it is simulated again."""
    return collected(tmp_path_factory.mktemp("plain") / "data", RecordingSpec())


@pytest.fixture(scope="module")
def stored(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("stored") / "data"
    return collected(folder, RecordingSpec(senses=("depth", "states"), layout="legacy"))


@pytest.mark.sim
@pytest.mark.render
@pytest.mark.slow
class TestDrawnAgain:
    def test_with_nothing_changed_every_file_is_the_same(
        self, plain: Path, stored: Path, tmp_path: Path
    ) -> None:
        for n, source in enumerate((plain, stored)):
            out, heard = tmp_path / str(n), list[Progress]()
            listener = Listener()
            listener.started = heard.extend
            done = render(RenderSpec(data=source, out=out, workers=1), listener)
            assert [(one.new_accepted, one.done) for one in heard] == [(1, True)]
            assert done.compared == 3 * len(Dataset(source)[0]) and done.differing == 0
            assert content(out) == content(source)

    def test_stored_states_are_drawn_without_simulating(
        self, stored: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setattr(module, "attempt", None)  # of this process: no worker is spawned
        plan = RenderSpec(data=stored, out=tmp_path, add=("segmentation",))
        worker = RenderWorker(*_pack_and_packs(stored), "slim")
        worker.start()
        entry = Dataset(stored).task_datasets[0]
        paths = Dataset(stored)[0].paths
        scene = {"info": {}}
        job = RenderTask(
            paths,
            "legacy",
            scene,
            plan.recording(entry),
            True,
            entry.resolved.assets["digest"],
            tmp_path,
        )
        done = worker.do(job)
        assert done.compared and not done.differing

    def test_senses_are_added_and_nothing_else_changes(self, plain: Path, tmp_path: Path) -> None:
        add = ("depth", "segmentation", "pointcloud", "states")
        done = render(RenderSpec(data=plain, out=tmp_path, add=add, workers=1))
        assert done.differing == 0
        assert verify(tmp_path, Effort.DEEP).problems == []
        before, after = Dataset(plain)[0], Dataset(tmp_path)[0]
        assert set(after.senses.senses) == set(add)
        with h5py.File(before.paths.hdf5) as old, h5py.File(after.paths.hdf5) as new:
            keys: list[str] = []
            old.visititems(lambda k, v: keys.append(k) if isinstance(v, h5py.Dataset) else None)
            for key in keys:
                assert np.array_equal(old[key][()], new[key][()]), key
        assert before.paths.video.read_bytes() == after.paths.video.read_bytes()

    def test_cameras_size_and_look(self, plain: Path, tmp_path: Path) -> None:
        plan = RenderSpec(
            data=plain, out=tmp_path, cameras=("head", "front"), size="64x48",
            look="official_random", workers=1,
        )  # fmt: skip
        render(plan)
        assert verify(tmp_path, Effort.DEEP).problems == []
        episode = Dataset(tmp_path)[0]
        assert episode.image("front_camera", 0).shape == (48, 64, 3)
        assert episode.config == "phys_random.look=official_random"
        assert episode.meta.visual is not None and episode.meta.visual.clutter == []
        assert np.array_equal(episode.state, Dataset(plain)[0].state)
        old = Dataset(plain)[0].paths.video
        assert episode.paths.video.read_bytes() != old.read_bytes()

    def test_another_look_needs_the_camera_of_the_video(self, plain: Path, tmp_path: Path) -> None:
        plan = RenderSpec(data=plain, out=tmp_path, cameras=("front",), look="official_random")
        with pytest.raises(BadValue, match="another look needs head, for the video"):
            render(plan)
        assert not [*tmp_path.iterdir()]

    def test_a_further_draw_of_a_look(self, plain: Path, tmp_path: Path) -> None:
        found = []
        for look in ("official_random.1", "official_random.2"):
            out = tmp_path / look
            render(RenderSpec(data=plain, out=out, size="64x48", look=look, workers=1))
            assert verify(out, Effort.DEEP).problems == []
            found.append(Dataset(out)[0])
        first, second = found
        assert first.config == "phys_random.look=official_random.1"
        assert not np.array_equal(first.image("head_camera", 0), second.image("head_camera", 0))
        assert np.array_equal(first.state, second.state)


def _pack_and_packs(source: Path):
    pack = default_pack()
    return pack, {Dataset(source).task_datasets[0].resolved.assets["digest"]: pack}


# ---- refused before any work ---------------------------------------------------------------------


def test_missing_assets_are_named_with_their_digest(tmp_path: Path) -> None:
    data = collect_synthetic(tmp_path / "data", 1)
    with pytest.raises(RtphysError, match="a" * 64):
        render(RenderSpec(data=data, out=tmp_path / "out"))
    assert not (tmp_path / "out").exists()


def test_what_a_policy_did_is_drawn_from_states_alone(tmp_path: Path) -> None:
    """It was said that rtphys had changed: the expert's states were compared with the policy's."""
    write(tmp_path / "data", synthetic.episode(0), what=synthetic.header(policy="random"))
    with pytest.raises(RtphysError, match="without `states` of the policy random"):
        render(RenderSpec(data=tmp_path / "data", out=tmp_path / "out"))
    assert not (tmp_path / "out").exists()


@pytest.mark.sim
def test_states_that_are_not_those_of_the_label_are_not_drawn(tmp_path: Path) -> None:
    """Nobody has simulated this episode."""
    data = Dataset(collect_synthetic(tmp_path / "data", 1))
    paths, pack = data[0].paths, default_pack()
    job = RenderTask(paths, "native", {"info": {}}, RecordingSpec(), True, "a", tmp_path / "new")
    worker = RenderWorker(pack, {"a": pack}, "slim")
    with pytest.raises(RtphysError, match=r"simulated again it gives states \w+, not "):
        worker.do(job)
    assert not (tmp_path / "new").exists()


def test_the_dataset_itself_is_no_place_for_the_new_one(tmp_path: Path) -> None:
    data = collect_synthetic(tmp_path, 1)
    with pytest.raises(BadValue, match="name another folder"):
        render(RenderSpec(data=data, out=data))


def test_no_dataset_at_all(tmp_path: Path) -> None:
    with pytest.raises(BadFile):
        render(RenderSpec(data=tmp_path, out=tmp_path / "out"))


@pytest.mark.parametrize(
    "given",
    [
        {"add": ("dept",)},
        {"cameras": ("haed",)},
        {"look": "clan"},
        {"shader": "slimm"},
        {"camera_type": "D345"},
    ],
)
def test_a_misspelt_name_is_refused(given: dict[str, object], tmp_path: Path) -> None:
    with pytest.raises(RtphysError, match="did you mean"):
        RenderSpec(data=tmp_path, out=tmp_path, **given)  # type: ignore[arg-type]


def test_a_cloud_without_the_head_camera_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    data = collect_synthetic(tmp_path / "data", 1)
    monkeypatch.setattr(module, "pack_with", lambda digest: object())
    plan = RenderSpec(data=data, out=tmp_path / "out", cameras=("front",), add=("pointcloud",))
    with pytest.raises(BadValue, match="head camera's"):
        render(plan)


def test_a_disk_that_is_too_small_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    usage = namedtuple("usage", "total used free")(10**12, 10**12 - 10**8, 10**8)
    data = collect_synthetic(tmp_path / "data", 1)
    monkeypatch.setattr(module, "pack_with", lambda digest: object())
    monkeypatch.setattr("shutil.disk_usage", lambda place: usage)
    with pytest.raises(RtphysError, match="GB"):
        render(RenderSpec(data=data, out=tmp_path / "out", add=("depth",)))


def test_other_seeds_are_not_drawn_into_the_same_folder(tmp_path: Path) -> None:
    """Those before the ones that are there would be left out without a word."""
    data = collect_synthetic(tmp_path / "data", 3, attempts=3)

    def begin(seeds: str) -> RenderSeries:
        plan = RenderSpec(data=data, out=tmp_path / "out", part=Selection(seed=seeds))
        with DatasetWriter(plan.out) as dataset:
            study = RenderSeries(plan, plan.part.of(Dataset(data)).parts[0], dataset)
            if study.seeds == [1]:
                study.writer.record(Rejection(1, "slipped"))
        return study

    assert begin("1").seeds == [1]
    assert begin("1:3").seeds == [2]
    with pytest.raises(DatasetMismatch, match="its seeds are not those"):
        begin("0:3")


@pytest.fixture
def needed(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """The disk space [bytes] that each check of a render asks for; it needs no assets."""
    asked = list[float]()
    monkeypatch.setattr(module, "pack_with", lambda digest: object())
    monkeypatch.setattr(module, "check_space", lambda out, room: asked.append(room))
    monkeypatch.setattr(module, "check_drawable", lambda shader: 0)
    return asked


def test_space_is_needed_for_what_is_not_drawn_yet(tmp_path: Path, needed: list[float]) -> None:
    data = collect_synthetic(tmp_path / "data", 1)
    for out in (tmp_path / "new", collect_synthetic(tmp_path / "drawn", 1)):
        module._check(RenderSpec(data=data, out=out), Dataset(data))
    assert needed[0] > needed[1] == 0


def test_space_is_needed_for_the_chosen_episodes_alone(tmp_path: Path, needed: list[float]) -> None:
    collect_synthetic(tmp_path / "data", 4)  # of seeds 0, 1, 3, 4
    for seeds in ("", "3,4", "0"):
        plan = RenderSpec(data=tmp_path / "data", out=tmp_path / "out", part=Selection(seed=seeds))
        module._check(plan, plan.part.of(Dataset(plan.data)))
    every, two, one = needed
    assert every == 2 * two == 4 * one > 0


def test_space_is_needed_for_kept_failures_too(tmp_path: Path, needed: list[float]) -> None:
    for name, kept in (("all", "all"), ("few", None)):
        keep(tmp_path / name, kept)
        module._check(
            RenderSpec(data=tmp_path / name, out=tmp_path / "out"), Dataset(tmp_path / name)
        )
    data, (every, few) = Dataset(tmp_path / "all"), needed
    assert every / few == pytest.approx(1 + len(data.failures()) / len(data)) != 1
