"""The loader: lazy, RGB, typed, and usable without a simulator."""

import math
import pickle
import shutil
import subprocess
import sys
import types
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest
import synthetic
from collected import FRAMES, collect, keep, write

import rtphys
from rtphys.cli.derived import names_in
from rtphys.core.errors import BadFile, BadValue, RtphysError, UnknownName
from rtphys.data.dataset import Dataset, find_episode
from rtphys.data.episode import Episode
from rtphys.data.files import facts_of
from rtphys.data.hdf5_episode import EpisodeFile
from rtphys.data.rewrite import convert
from rtphys.data.selection import One, Selection, seed_set
from rtphys.physics import attributes
from rtphys.physics.values import REDRAWS
from rtphys.spec.sweep import swept


@pytest.fixture(scope="module", params=["native", "legacy"])
def dataset(
    request: pytest.FixtureRequest, three: Path, tmp_path_factory: pytest.TempPathFactory
) -> Dataset:
    out = tmp_path_factory.mktemp("other") if request.param == "legacy" else three
    if out != three:
        convert(three, out, "legacy")
    return Dataset(out)


def test_lists_episodes_by_seed(dataset: Dataset) -> None:
    assert [episode.seed for episode in dataset] == [0, 1, 3]
    assert dataset.tasks == ("click_bell",)
    assert dataset.where(task="click_bell", protocol="phys_random")[2].number == 2
    with pytest.raises(UnknownName, match="did you mean 'click_bell'"):
        dataset.where(task=["click_bell", "click_bel"])
    with pytest.raises(UnknownName, match="unknown recorded task '3'"):
        dataset.where(task=3)  # type: ignore[arg-type]


def test_a_broken_picture_is_named(dataset: Dataset, tmp_path: Path) -> None:
    """As one on a damaged disk: by its file, camera and frame, whoever looks at it."""
    shutil.copytree(dataset.path, tmp_path / "data")
    episode = Dataset(tmp_path / "data")[1]
    native = episode.layout == "native"
    key = "vision/cam_left_wrist/colors" if native else "observation/left_camera/rgb"
    with h5py.File(episode.paths.hdf5, "r+") as file:
        streams = file[key][()]
        streams[2] = streams[2][:20]
        file[key][...] = streams
    named = f"{episode.paths.hdf5}: left_camera, frame 2: .* no JPEG picture"
    for look in (
        lambda: episode.image("left_camera", 2),
        lambda: episode.images("left_camera"),
        lambda: [*episode.each_image("left_camera")],
    ):
        with pytest.raises(BadFile, match=named):
            look()
    assert episode.image("left_camera", 1).any()


def test_a_part_by_physics_and_by_seeds(dataset: Dataset) -> None:
    values = {one.seed: float(str(one.physics["friction"])) for one in dataset}
    low, _, high = sorted(values.values())
    part = dataset.where(physics={"friction": (low, high - 1e-9)})
    assert len(part) == 2 and max(values, key=lambda seed: values[seed]) not in [
        one.seed for one in part
    ]
    assert [one.seed for one in dataset.where(seeds=(1, 3, 9))] == [1, 3]
    assert len(dataset.where(task=["click_bell"], embodiment={"Aloha-AgileX"})) == 3
    assert len(part.where(seeds=[one.seed for one in part][:1])) == 1
    with pytest.raises(UnknownName, match="did you mean 'friction'"):
        dataset.where(physics={"frictoin": (0, 1)})
    said = "'object_mass@first' is not allowed; it could not act in any episode here"
    with pytest.raises(BadValue, match=said):
        dataset.where(physics={"object_mass@first": (0, 1)})


@pytest.mark.parametrize(
    ("wanted", "said"),
    [
        ({"physics": {"friction": 0.2}}, r"lowest and the highest value, such as \(0.2, 0.2\)"),
        ({"physics": {"friction": (0.3, 0.1)}}, r"physics\['friction'\] = \(0.3, 0.1\) is not"),
        ({"physics": {"friction": (0.3,)}}, "lowest and the highest"),
        ({"physics": {"friction": ("a", "b")}}, "lowest and the highest"),
        ({"seeds": 3}, r"seeds = 3 is not allowed; whole numbers, such as \[3\] or range"),
        ({"seeds": "3"}, "whole numbers"),
        ({"numbers": 0}, r"numbers = 0 is not allowed; whole numbers, such as \[0\]"),
    ],
    ids=str,
)
def test_a_part_that_cannot_be_says_what_can(
    dataset: Dataset, wanted: dict[str, object], said: str
) -> None:
    with pytest.raises(BadValue, match=said):
        dataset.where(**wanted)  # type: ignore[arg-type]


def test_a_protocol_is_all_its_configurations_and_a_configuration_is_one(tmp_path: Path) -> None:
    collect(tmp_path, 2)
    collect(tmp_path, 1, synthetic.header(overrides={"friction": 0.1}))
    data = Dataset(tmp_path)
    assert len(data.where(protocol="phys_random")) == 3
    assert len(data.where(config="phys_random")) == 2
    assert len(data.where(config="phys_random.friction=0.1")) == 1


def test_a_sum_has_the_episodes_of_both_and_no_folder(tmp_path: Path) -> None:
    collect(tmp_path / "a", 2)
    collect(tmp_path / "b", 1)
    both = Dataset(tmp_path / "a") + Dataset(tmp_path / "b")
    assert [one.seed for one in both] == [0, 1, 0] and len(both) == 3
    assert both[2].paths.hdf5.is_relative_to(tmp_path / "b") and both[2].instructions.seen
    assert len(both.where(task="click_bell", seeds=[0])) == 2
    assert [*both.groups()] == [("click_bell", 0), ("click_bell", 1)]
    assert len(both.groups()["click_bell", 0]) == 2
    with pytest.raises(BadValue, match="`rtphys merge` writes one"):
        _ = both.path


def test_the_files_are_those_of_the_episodes_that_are_meant(tmp_path: Path) -> None:
    """And of the failures that were kept."""
    keep(tmp_path, attempts=4)
    data = Dataset(tmp_path)
    for part in (data, data.where(seeds=[1, 2]), data.where(numbers=[0]), data.where(seeds=[9])):
        paths = [path for one in (*part, *part.failures()) for path in one.paths.all()]
        assert {tmp_path / name for name, _ in part.files()} == {*paths}
        assert all(facts_of(tmp_path / name) == facts for name, facts in part.files())
    assert [len([*data.where(seeds=seeds).files()]) for seeds in ([1, 2], [9])] == [8, 0]


def test_a_sweep_that_was_cut_off_has_the_seeds_that_have_all_values(tmp_path: Path) -> None:
    """One value was ahead of the other when the run ended."""
    header = synthetic.header()
    specs = swept(header.spec, "friction=0.1,0.3")
    for count, spec in zip((2, 1), specs, strict=True):
        collect(tmp_path, count, replace(header, spec=spec))
    data = Dataset(tmp_path)
    assert [[*group] for group in data.sweep()] == [[0.1, 0.3]]
    alone = data.where(config=specs[0].name).sweep()
    assert [one.seed for group in alone for one in group.values()] == [0, 1]


def test_what_is_newer_than_the_manifest_is_not_there_yet(ahead: Path, tmp_path: Path) -> None:
    assert [one.seed for one in Dataset(ahead)] == [0, 1]
    assert len([*Dataset(ahead).files()]) == 8
    convert(ahead, tmp_path / "other", "legacy")
    assert [one.seed for one in Dataset(tmp_path / "other")] == [0, 1]


class Table(list):
    """In the place of pandas' own, which nothing here needs."""

    def __init__(self, rows: list[dict[str, object]], columns: list[str]) -> None:
        super().__init__({name: row.get(name, math.nan) for name in columns} for row in rows)
        self.columns = columns


@pytest.fixture
def pandas(monkeypatch: pytest.MonkeyPatch) -> None:
    module = types.ModuleType("pandas")
    module.DataFrame = Table  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "pandas", module)


def test_a_table_has_a_row_an_attempt(
    tmp_path: Path, pandas: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    keep(tmp_path, attempts=3)
    rows = Dataset(tmp_path).to_pandas()
    assert [(row["seed"], row["outcome"]) for row in rows] == [
        (0, "accepted"),
        (1, "accepted"),
        (2, "slipped"),
    ]
    facts = {"task": "click_bell", "config": "phys_random", "number": 0, "frames": FRAMES}
    assert facts.items() <= rows[0].items() and rows[0]["embodiment"] == "aloha-agilex"
    assert rows[0]["friction"] == Dataset(tmp_path)[0].physics["friction"]
    groups = Dataset(tmp_path).groups()
    assert [one.failed for one in groups["click_bell", 2]] == [True]
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(RtphysError, match="pip install pandas"):
        Dataset(tmp_path).to_pandas()


def put(episode: Episode, key: str, **changes: object) -> None:
    """Changes the label of an attribute."""
    episode.phys_meta["attributes"][key].update(changes)  # type: ignore[index]


def test_a_camera_attribute_that_is_held_at_zero_keeps_its_number(
    tmp_path: Path, pandas: None
) -> None:
    """The baseline of a sweep, in whose episode the camera happened to be displaced otherwise."""
    made = [synthetic.episode(seed, FRAMES) for seed in range(2)]
    for episode, source in zip(made, ("set", "domain"), strict=True):
        for key in ("camera_angle", "object_mass"):
            put(episode, key, could_act=False, acted=False, value=0.0, source=source)
    write(tmp_path, *made)
    first, second = Dataset(tmp_path).to_pandas()
    assert first["camera_angle"] == 0.0 and math.isnan(second["camera_angle"])
    assert math.isnan(first["object_mass"]), "a value that no object has says nothing"


def test_a_table_has_every_attribute_and_a_number_only_where_it_acted(
    tmp_path: Path, pandas: None
) -> None:
    """In one order, whatever the first row lacks; `raw` has all that could act."""
    made = [synthetic.episode(seed, FRAMES) for seed in range(2)]
    for seed, episode in enumerate(made):
        put(episode, "restitution", acted=bool(seed), value=0.25)
        put(episode, "object_mass", could_act=False, acted=False, value=3.0)
        put(episode, "center_of_mass", could_act=bool(seed), acted=None)
        put(episode, "object_joint_damping", acted=True, value=None)
    write(tmp_path, *made)
    table = Dataset(tmp_path).to_pandas()
    names = [name for key in attributes() for name in (
        [f"{key}.{part}" for part in "xyz"] if key == "center_of_mass" else [key]
    )]  # fmt: skip
    assert table.columns[:7] == [
        "task", "config", "embodiment", "seed", "number", "frames", "outcome"
    ]  # fmt: skip
    assert table.columns[7:] == sorted(names)
    first, second = table
    unknown = {name for name in names if math.isnan(first[name])}
    camera = {"camera_distance", "camera_angle"}
    mean = {"restitution", "object_mass", "object_joint_damping"}
    assert unknown - camera == mean | {f"center_of_mass.{part}" for part in "xyz"}
    assert second["restitution"] == 0.25 and not math.isnan(second["center_of_mass.z"])
    raw = Dataset(tmp_path).to_pandas(raw=True)
    assert raw.columns == table.columns
    assert raw[0]["restitution"] == 0.25 and math.isnan(raw[0]["object_mass"])
    assert math.isnan(raw[0]["object_joint_damping"]), "the asset's own is no number"


def test_a_table_of_attempts_has_what_the_ledger_has_of_those_without_files(
    tmp_path: Path, pandas: None
) -> None:
    collect(tmp_path, 3)
    *_, last = Dataset(tmp_path).where(seeds=range(3)).to_pandas(attempts=True)
    assert (last["seed"], last["outcome"], last["number"]) == (2, "slipped", None)
    assert last["friction"] == 0.1 and math.isnan(last["restitution"])


def test_pictures_are_rgb_and_complete(dataset: Dataset) -> None:
    episode = dataset[1]
    truth = [frame["left_camera"] for frame in synthetic.pictures(1, FRAMES)]
    images = episode.images("left_camera")
    assert images.shape == (FRAMES, synthetic.HEIGHT, synthetic.WIDTH, 3)
    assert images[0, -4, 4].argmax() == 0, "left third is red"
    assert np.abs(images.astype(int) - np.stack(truth)).mean() < 8
    for t in (0, FRAMES - 1, -1):
        np.testing.assert_array_equal(episode.image("left_camera", t), images[t])
    with pytest.raises(IndexError):
        episode.image("left_camera", FRAMES)
    with pytest.raises(UnknownName, match="front_camera"):
        episode.image("front_camera", 0)
    with pytest.raises(UnknownName, match="head_camera"):
        episode.images("front_camera")


def test_a_file_that_was_changed_is_read_anew(dataset: Dataset, tmp_path: Path) -> None:
    one, other = dataset[0], dataset[1]
    path = shutil.copy(one.paths.hdf5, tmp_path / "episode.hdf5")
    file = EpisodeFile(Path(path), one.layout)
    for _ in range(2):  # the second time from where the first found them
        assert file.stream("head", 2) == EpisodeFile(one.paths.hdf5, one.layout).stream("head", 2)
    shutil.copy(other.paths.hdf5, path)
    assert file.stream("head", 2) == EpisodeFile(other.paths.hdf5, one.layout).stream("head", 2)
    Path(path).unlink()
    with pytest.raises(BadFile, match="no such file"):
        file.stream("head", 2)


def test_numbers(dataset: Dataset) -> None:
    episode, truth = dataset[2], synthetic.frames_of(3, FRAMES)
    assert len(episode) == FRAMES
    np.testing.assert_array_equal(episode.state, truth.vector)
    np.testing.assert_array_equal(episode.action, truth.vector[1:])
    np.testing.assert_array_equal(episode.poses("bell"), truth.object_poses["bell"])
    scalar_last = episode.poses("left", order="xyzw")
    np.testing.assert_array_equal(scalar_last[:, 6], truth.left_endpose[:, 3])
    with pytest.raises(UnknownName, match="unknown pose"):
        episode.poses("gong")
    with pytest.raises(BadValue):
        episode.poses("bell", order="zyx")  # type: ignore[arg-type]


def test_physics_is_what_was_drawn(dataset: Dataset) -> None:
    from rtphys.physics import after

    for episode in dataset:
        drawn = synthetic.DOMAIN.sample(
            episode.seed, inside=after({REDRAWS: episode.seed % 3}), task=episode.task
        )
        assert episode.physics == drawn
    assert dataset[0].instructions.seen[0] == "ring the bell"
    assert dataset[0].meta.readback.bodies["bell"]["mass"] == 0.25


def test_factors_are_what_could_act_and_did(dataset: Dataset) -> None:
    for episode in dataset:
        labels = episode.meta.attributes
        known = {
            key for key, label in labels.items() if label.could_act and label.acted is not False
        }
        assert episode.factors.keys() == known
        assert all(episode.factors[key] == episode.physics[key] for key in known)
    assert any(episode.factors.keys() < episode.meta.attributes.keys() for episode in dataset)


def test_pickles_small_after_use(dataset: Dataset) -> None:
    episode = dataset[0]
    assert (episode.images("head_camera") == episode.images("head")).all()
    assert len(pickle.dumps(episode)) < 400 + 4 * len(str(episode.paths.hdf5))
    assert pickle.loads(pickle.dumps(episode)).image("head_camera", 0).any()


def test_found_by_any_of_its_files(dataset: Dataset) -> None:
    for path in dataset[1].paths.all():
        assert find_episode(path) == dataset[1]
    with pytest.raises(BadFile, match="is no episode"):
        find_episode(dataset.path / "manifest.json" / "x")
    with pytest.raises(BadFile, match="in any folder above"):
        find_episode(Path("/nowhere/episode.hdf5"))


def test_finding_a_file_resolves_the_paths_of_its_number_alone(
    dataset: Dataset, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of 100,000 episodes on a network disk, all paths took minutes."""
    resolved, really = list[Path](), Path.resolve
    monkeypatch.setattr(Path, "resolve", lambda path: resolved.append(path) or really(path))
    assert find_episode(dataset[2].paths.instruction) == dataset[2]
    assert len(resolved) <= 5


def test_needs_no_simulator(dataset: Dataset) -> None:
    code = (
        "import sys; sys.modules['sapien'] = sys.modules['pinocchio'] = None\n"
        "import rtphys; assert 'numpy' not in sys.modules\n"
        f"d = rtphys.Dataset({str(dataset.path)!r}); d[0].images('head_camera'); print(d)"
    )
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert "3 episodes of 1 task)" in result.stdout, result.stderr


def test_package_names() -> None:
    assert rtphys.Dataset is Dataset
    with pytest.raises(AttributeError, match="no attribute 'Datasets'"):
        _ = rtphys.Datasets  # type: ignore[attr-defined]


# ---- which episode is meant: by task, configuration, seed, number, or as a failure ---------------


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("kept")
    keep(out, attempts=3)  # of which the last is a failure
    return out


def seeds(data: Path, **wanted) -> list[int]:
    return [one.seed for one in One(**wanted).of_path(data)]


def test_selectors(data: Path) -> None:
    assert seeds(data) == [0, 1]
    assert seeds(data, episode="1") == [1]
    assert seeds(data, episode="0:9") == [0, 1]
    assert seeds(data, failure=0) == [2]
    assert seeds(data, seed="2") == [2], "a seed says by itself that a failure is meant"
    assert seeds(data, task=("click_bell",), config=("phys_random",), seed="1:9") == [1, 2]
    assert seeds(data / "manifest.json", episode="0") == [0]
    (failure,) = One(failure=0).of_path(data)
    assert failure.failed and One().of_path(failure.paths.video) == (failure,)


@pytest.mark.parametrize(
    ("wanted", "error", "said"),
    [
        ({"episode": "7"}, BadValue, "episodes 0 to 1"),
        ({"episode": ""}, BadValue, "at least one number"),
        ({"failure": 4}, BadValue, "failures 0 to 0"),
        ({"seed": "9"}, BadFile, "no such episode"),
        ({"seed": "x"}, BadValue, "such as 3,7"),
        ({"seed": "7:3"}, BadValue, "7:3 holds no number"),
        ({"seed": "7:99999999999"}, BadValue, "or more than 10000000"),
        ({"config": ("phys_randm",)}, UnknownName, "did you mean 'phys_random'"),
    ],
)
def test_what_is_not_there_is_said(
    data: Path, wanted: dict[str, object], error: type[Exception], said: str
) -> None:
    with pytest.raises(error, match=said):
        seeds(data, **wanted)


def test_a_file_is_of_one_episode(data: Path) -> None:
    (first,) = One(episode="0").of_path(data)
    with pytest.raises(BadValue, match="a file is of one episode; name it alone"):
        One(episode="1").of_path(first.paths.hdf5)


def test_a_selection_of_everything_is_everything() -> None:
    assert Selection() == Selection(seed="") and seed_set("seed", "3,5:7") == {3, 5, 6}


def test_a_selection_has_the_failures_of_its_seeds(data: Path) -> None:
    for part, wanted in (
        (Selection(), [0, 1]),
        (Selection(episode="1"), [1]),
        (Selection(seed="0,2", episode="0:9"), [0]),
        (Selection(seed="2"), []),
    ):
        assert [one.seed for one in part.of(Dataset(data))] == wanted
    (part,) = Selection(seed="2").of(Dataset(data)).parts
    assert [row.seed for row in part.rows()] == [2]


def test_a_selection_takes_several_configurations_and_such_with_commas(tmp_path: Path) -> None:
    """A command line cuts what it is given at every comma."""
    names = ["phys_random", "phys_random.only=friction,restitution"]
    for only in (None, ("friction", "restitution")):
        collect(tmp_path, 1, synthetic.header(only=only))
    for words in (names[:1], names[1:], names):
        part = Selection(config=names_in(words)).of(Dataset(tmp_path))
        assert sorted(part.configs) == words
