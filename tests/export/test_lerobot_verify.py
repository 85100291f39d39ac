"""An export is compared with its source, number by number and picture by picture."""

import json
import re
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from collected import FRAMES, collect
from typer.testing import CliRunner

pq = pytest.importorskip("pyarrow.parquet", reason="the extra rtphys[lerobot] is not installed")

import pyarrow as pa  # noqa: E402

from rtphys.cli.main import app  # noqa: E402
from rtphys.core.errors import BadFile, BadValue  # noqa: E402
from rtphys.data import video  # noqa: E402
from rtphys.data.dataset import Dataset  # noqa: E402
from rtphys.export.lerobot import ExportSpec, export_lerobot  # noqa: E402
from rtphys.export.lerobot_episode import KEYFRAMES  # noqa: E402
from rtphys.export.lerobot_plan import RATES  # noqa: E402
from rtphys.export.lerobot_verify import verify_export  # noqa: E402

R = FRAMES - 1


@pytest.fixture(params=["v3.0", "v2.1"])
def exported(dataset: Dataset, tmp_path: Path, request: pytest.FixtureRequest) -> Path:
    spec = ExportSpec(request.param, features=("contact",), sentences="all")
    return export_lerobot(dataset, tmp_path / "lr", spec)


def test_an_export_is_its_dataset(exported: Path, dataset: Dataset) -> None:
    assert verify_export(exported, dataset) == []
    done = CliRunner().invoke(app, ["verify-export", str(exported), str(dataset.path)])
    assert done.exit_code == 0 and "every number and picture" in done.output


def test_the_arrays_of_an_episode_are_forgotten(exported: Path, dataset: Dataset) -> None:
    fresh = Dataset(dataset.path)
    assert verify_export(exported, fresh) == []
    assert not any("frames" in vars(one) for one in fresh)


def test_a_file_may_hold_more_pictures_than_an_episode_may(
    exported: Path, dataset: Dataset, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(video, "MAX_FRAMES", R)
    assert verify_export(exported, dataset) == []


def test_a_number_that_differs_is_named(exported: Path, dataset: Dataset) -> None:
    path = max((exported / "data").rglob("*.parquet"))
    table = pq.read_table(path)
    action = np.array(table["action"].to_pylist(), np.float32)
    action[-1, 3] += 1e-6
    column = pa.FixedSizeListArray.from_arrays(pa.array(action.ravel()), action.shape[1])
    index = table.column_names.index("action")
    pq.write_table(table.set_column(index, "action", column), path)
    (problem,) = verify_export(exported, dataset)
    assert problem == "episode 2 (click_bell, seed 3): action is not the dataset's"
    done = CliRunner().invoke(app, ["verify-export", str(exported), str(dataset.path)])
    assert done.exit_code == 1 and problem in done.output


def test_a_label_or_sentence_that_differs_is_named(exported: Path, dataset: Dataset) -> None:
    meta = exported / "meta"
    if (path := meta / "episodes.jsonl").exists():
        replace_in(path, f'"phys/friction":{dataset[0].physics["friction"]}', '"phys/friction":9.5')
        replace_in(meta / "tasks.jsonl", "ring the bell", "open the pot")
    else:
        path = meta / "episodes/chunk-000/file-000.parquet"
        frictions = [9.5, *(one.physics["friction"] for one in dataset[1:])]
        change_column(path, "phys/friction", frictions)
        sentences = pq.read_table(meta / "tasks.parquet")["task"].to_pylist()
        change_column(meta / "tasks.parquet", "task", ["open the pot", *sentences[1:]])
    assert verify_export(exported, dataset) == [
        "episode 0 (click_bell, seed 0): phys/friction is not the dataset's",
        "the list of sentences is not the dataset's",
    ]


def replace_in(path: Path, old: str, new: str) -> None:
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))


def change_column(path: Path, name: str, values: list) -> None:
    table = pq.read_table(path)
    index = table.column_names.index(name)
    pq.write_table(table.set_column(index, name, pa.array(values)), path)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (lambda shown: shown[..., ::-1], "another picture|red and blue are exchanged"),
        (lambda shown: shown[[0, *range(len(shown) - 1)]], "another picture|frame before"),
        (lambda shown: shown[:-1], "frame 2 and later: the video ends"),
    ],
    ids=["colours", "shifted", "short"],
)
def test_a_picture_that_differs_is_named(
    exported: Path, dataset: Dataset, change, told: str
) -> None:
    path = max((exported / "videos").rglob("*.mp4"))
    shown = change(np.stack([*video.decode(path.read_bytes())]))
    rate = RATES["v3.0" if "file-" in path.name else "v2.1"]
    writer = video.VideoWriter(*shown.shape[1:3], rate, KEYFRAMES)
    for picture in shown:
        writer.add(np.ascontiguousarray(picture))
    path.write_bytes(writer.finish())
    problems = verify_export(exported, dataset)
    assert problems and all("right_camera" in one for one in problems)
    assert re.search(told, problems[-1])


def test_a_file_that_is_cut_short_is_named(exported: Path, dataset: Dataset) -> None:
    assert verify_export(exported, dataset) == []
    for path in (max((exported / "videos").rglob("*.mp4")), *(exported / "data").rglob("*.parq*")):
        whole = path.read_bytes()
        path.write_bytes(whole[: len(whole) // 2])
        with pytest.raises(BadFile, match=re.escape(str(path))):
            verify_export(exported, dataset)
        path.write_bytes(whole)


def change_tables(exported: Path, change: Callable[[pa.Table], pa.Table]) -> None:
    for path in (exported / "data").rglob("*.parquet"):
        pq.write_table(change(pq.read_table(path)), path)


def test_lists_of_another_kind_hold_the_same_numbers(exported: Path, dataset: Dataset) -> None:
    """As another tool may write them."""

    def change(table: pa.Table) -> pa.Table:
        place, values = table.column_names.index("action"), table["action"].combine_chunks()
        return table.set_column(place, "action", values.cast(pa.list_(pa.float32())))

    change_tables(exported, change)
    assert verify_export(exported, dataset) == []


def test_a_column_that_was_added_is_named(exported: Path, dataset: Dataset) -> None:
    change_tables(exported, lambda table: table.append_column("note", pa.array(["a"] * len(table))))
    problems = verify_export(exported, dataset)
    assert len(problems) == len(dataset)
    assert all(one.endswith("note is not the dataset's") for one in problems)


@pytest.mark.parametrize(
    "change", [lambda table: table.drop_columns(["index"]), lambda table: table.slice(0, 0)]
)
def test_a_table_without_frames_is_named(
    exported: Path, dataset: Dataset, change: Callable[[pa.Table], pa.Table]
) -> None:
    change_tables(exported, change)
    with pytest.raises(BadFile, match="holds no index of its frames"):
        verify_export(exported, dataset)


@pytest.mark.parametrize("said", [None, 7, "data/{nothing}.parquet", "data/{0}.parquet"])
def test_a_path_that_leads_nowhere_is_named(exported: Path, dataset: Dataset, said: object) -> None:
    path = exported / "meta/info.json"
    path.write_text(json.dumps({**json.loads(path.read_text()), "data_path": said}))
    with pytest.raises(BadFile, match=r"info\.json: data_path is .*names no file of an episode"):
        verify_export(exported, dataset)


def test_a_place_that_is_no_number_is_named(dataset: Dataset, tmp_path: Path) -> None:
    out = export_lerobot(dataset, tmp_path / "lr")
    table = out / "meta/episodes/chunk-000/file-000.parquet"
    whole = pq.read_table(table)
    begins = next(name for name in whole.column_names if name.endswith("from_timestamp"))
    for name in ("data/chunk_index", begins):
        pq.write_table(whole.drop_columns([name]), table)
        with pytest.raises(BadFile, match=re.escape(f"{table}: {name} is None, not a number")):
            verify_export(out, dataset)
    pq.write_table(whole, table)
    path = out / "meta/info.json"
    path.write_text(json.dumps({**json.loads(path.read_text()), "fps": "17"}))
    with pytest.raises(BadFile, match=r"info\.json: fps is '17', not a number"):
        verify_export(out, dataset)


def test_what_was_made_of_another_dataset_is_refused(
    exported: Path, dataset: Dataset, tmp_path: Path
) -> None:
    collect(tmp_path / "other", 2)
    with pytest.raises(BadValue, match="of another dataset, or of another state"):
        verify_export(exported, Dataset(tmp_path / "other"))
    shutil.rmtree(exported / "meta")
    with pytest.raises(BadFile, match=r"rtphys\.json"):
        verify_export(exported, dataset)
