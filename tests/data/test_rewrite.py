"""Datasets made of datasets: the other layout and back, shards joined, a part taken."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import synthetic
from collected import FOLDER, collect, content, content_but_pictures, keep, outcome
from forger import forge
from typer.testing import CliRunner

from pages import ROOT, blocks
from rtphys.cli.main import app
from rtphys.core.errors import BadFile, BadValue, UnknownName
from rtphys.data.dataset import Dataset
from rtphys.data.faults import DatasetMismatch
from rtphys.data.rewrite import convert, merge, subset
from rtphys.data.verify import verify
from rtphys.data.writer import DatasetWriter


def test_there_and_back(three: Path, tmp_path: Path) -> None:
    seen: list[tuple[int, int]] = []
    names = convert(three, tmp_path / "old", "legacy", lambda *at: seen.append(at))
    assert names == ["click_bell/phys_random"]
    assert seen == [(1, 3), (2, 3), (2, 3), (3, 3)]
    report = verify(tmp_path / "old")
    assert (report.problems, report.episodes) == ([], 3)
    convert(tmp_path / "old", tmp_path / "new", "native")
    assert content_but_pictures(tmp_path / "new") == content_but_pictures(three)
    convert(three, tmp_path / "same", "native")
    assert content(tmp_path / "same") == content(three), "nothing is encoded again"


def test_pictures_keep_their_colours_on_the_way(three: Path, tmp_path: Path) -> None:
    convert(three, tmp_path / "old", "legacy")
    convert(tmp_path / "old", tmp_path / "new", "native")
    first = Dataset(three)[0].images("head")
    for out in ("old", "new"):
        shown = Dataset(tmp_path / out)[0].images("head")
        assert np.abs(shown.astype(int) - first).mean() < 6, "which are as saturated as can be"


def test_nothing_that_makes_a_task_dataset_is_lost(tmp_path: Path) -> None:
    """One beside the plain one: with a name of its own, rules of the look, and a twin."""
    own = synthetic.header(config="mine", twin="clean", split="unseen", visual={"clutter": 3})
    collect(tmp_path / "native", 2, own)
    collect(tmp_path / "native", 2, replace(own, spec=own.spec.sides[1]))
    convert(tmp_path / "native", tmp_path / "old", "legacy")
    convert(tmp_path / "old", tmp_path / "new", "native")
    assert content_but_pictures(tmp_path / "new") == content_but_pictures(tmp_path / "native")


class Stop(Exception):
    pass


def stop(done: int, _: int) -> None:
    if done == 2:
        raise Stop


def shards(out: Path, kept: str = "all") -> list[Path]:
    """One collection of six episodes by two, of every second seed each."""
    parts = [out / f"shard{number}" for number in (1, 2)]
    for number, part in enumerate(parts, start=1):
        collect(part, 3, synthetic.header(shards=2, shard=number, keep_failures=kept))
    return parts


REWRITES: dict[str, Callable[..., object]] = {
    "convert": lambda source, out, *say: convert(source, out, "legacy", *say),
    "merge": lambda source, out, *say: merge(shards(source), out, *say),
    "subset": lambda source, out, *say: subset(Dataset(source), out, *say),
}


@pytest.mark.parametrize("name", REWRITES)
def test_each_goes_on_where_it_was(three: Path, tmp_path: Path, name: str) -> None:
    source = tmp_path / "source" if name == "merge" else three
    with pytest.raises(Stop):
        REWRITES[name](source, tmp_path / "cut", stop)
    assert verify(tmp_path / "cut").problems == []
    REWRITES[name](source, tmp_path / "cut")
    REWRITES[name](source, tmp_path / "whole")
    assert content(tmp_path / "cut") == content(tmp_path / "whole")


@pytest.mark.parametrize("first", [{0, 1}, {3}, {0, 3}])
def test_a_part_of_other_seeds_is_not_continued(
    first: set[int], three: Path, tmp_path: Path
) -> None:
    """Neither with seeds that come before those that are there, nor without some of these."""

    def take(seeds: set[int]) -> None:
        subset(Dataset(three).where(seeds=seeds), tmp_path / "part")

    take(first)
    before = content(tmp_path / "part")
    for seeds in ({0, 1, 3}, {1}):
        if seeds == {0, 1, 3} and first == {0, 1}:
            continue  # that is how a call that was cut off goes on
        with pytest.raises(DatasetMismatch, match="its seeds are not those"):
            take(seeds)
        assert content(tmp_path / "part") == before


def test_the_progress_of_a_part_counts_what_is_taken(three: Path, tmp_path: Path) -> None:
    calls: list[tuple[int, int]] = []
    part = Dataset(three).where(seeds=[1, 3])
    subset(part, tmp_path / "part", lambda *at: calls.append(at))
    assert calls[-1] == (2, 2)


def test_a_part_has_the_failures_of_its_seeds(tmp_path: Path) -> None:
    """Kept or not: without them its acceptance would be 100 %."""
    collect(tmp_path / "data", 9, synthetic.header(keep_failures="1"), attempts=9)
    run = CliRunner().invoke
    words = ["subset", str(tmp_path / "data"), "--out"]
    assert run(app, [*words, str(tmp_path / "part"), "--drop-seed", "0"]).exit_code == 0
    part = Dataset(tmp_path / "part")
    assert [one.seed for one in part] == [1, 3, 4, 6, 7]
    assert [one.seed for one in part.failures()] == [2], "one of three was kept"
    (entry,) = part.task_datasets
    assert (entry.attempts, dict(entry.rejections)) == (8, {"slipped": 3})
    assert verify(tmp_path / "part").problems == []
    for none in ("900:910", "5"):
        done = run(app, [*words, str(tmp_path / "none"), "--seed", none])
        assert done.exit_code == 2 and "the dataset holds no such episode" in done.stderr, none
    assert not (tmp_path / "none").exists()


def test_a_part_may_be_of_one_robot(tmp_path: Path) -> None:
    collect(tmp_path / "data", 1)
    with DatasetWriter(tmp_path / "data") as writer:
        task = writer.task(synthetic.header(embodiment="franka-panda"))
        task.record(outcome(task, 0))
    words = ["subset", str(tmp_path / "data"), "--out", str(tmp_path / "part"), "--embodiment"]
    assert CliRunner().invoke(app, [*words, "franka-panda"]).exit_code == 0
    assert Dataset(tmp_path / "part").embodiments == ("franka-panda",)
    done = CliRunner().invoke(app, [*words, "franka-pnda"])
    assert done.exit_code == 2 and "did you mean 'franka_panda'" in done.stderr


def test_robots_whose_legacy_folders_have_one_name_are_not_mixed(tmp_path: Path) -> None:
    """The second one's episodes were left out without a word, their seeds being there."""
    collect(tmp_path / "data", 1)
    collect(tmp_path / "data", 1, synthetic.header(embodiment="franka-panda"))
    said = "two robots would share click_bell/phys_random: convert a `rtphys subset` of each"
    with pytest.raises(BadValue, match=said):
        convert(tmp_path / "data", tmp_path / "old", "legacy")
    assert not (tmp_path / "old").exists()


def test_a_failure_whose_label_does_not_say_which_is_refused(tmp_path: Path) -> None:
    """The ledger needs it."""
    keep(tmp_path / "data", attempts=3)
    (failure,) = Dataset(tmp_path / "data").failures()
    label = json.loads(failure.paths.phys_meta.read_bytes())
    del label["failure"]
    failure.paths.phys_meta.write_text(json.dumps(label))
    forge(tmp_path / "data", lambda _: None)
    with pytest.raises(BadFile, match="attributes or failure are missing"):
        merge([tmp_path / "data"], tmp_path / "all")


def test_only_what_was_written_is_counted(three: Path, tmp_path: Path) -> None:
    collect(tmp_path / "out", 2, synthetic.header(config="another"))
    done = CliRunner().invoke(app, ["subset", str(three), "--out", str(tmp_path / "out")])
    assert "3 episodes in 1 task dataset, in" in done.stdout


def test_refusals(three: Path, tmp_path: Path) -> None:
    with pytest.raises(BadValue, match="it is a dataset that is read; name another folder"):
        convert(three, three, "legacy")
    with pytest.raises(UnknownName, match="did you mean 'legacy'"):
        convert(three, tmp_path / "out", "legasy")
    with pytest.raises(BadFile, match=r"manifest\.json"):
        convert(tmp_path, tmp_path / "out", "legacy")
    assert content(tmp_path) == {}


def test_the_page_pairs_legacy_files_with_their_seeds(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """By the order of names, 10 of 12 would get another episode's seed."""
    collect(tmp_path / "data_legacy", 12, synthetic.header("legacy"))
    monkeypatch.chdir(tmp_path)
    (block,) = [text for text in blocks(ROOT / "docs/dataset.md", "python") if "seed.txt" in text]
    exec(block, {})
    paired = dict(line.split() for line in capsys.readouterr().out.splitlines())
    dataset = Dataset(tmp_path / "data_legacy")
    assert paired == {str(e.paths.hdf5.relative_to(tmp_path)): str(e.seed) for e in dataset}
    names = sorted(paired)
    seeds = (tmp_path / names[0]).parents[1].joinpath("seed.txt").read_text().split()
    assert sum(paired[name] == seed for name, seed in zip(names, seeds, strict=True)) == 2


# ---- merge -------------------------------------------------------------------------------------


def seeds(out: Path, config: str = "phys_random") -> list[int]:
    return [episode.seed for episode in Dataset(out).where(config=config)]


def test_each_shard_keeps_as_many_failures_as_it_may(tmp_path: Path) -> None:
    parts = shards(tmp_path, kept="1")
    merge(parts, tmp_path / "merged")
    kept = [len(list((out).rglob("failures/data/*.hdf5"))) for out in (*parts, tmp_path / "merged")]
    assert kept[2] == kept[0] + kept[1] > 1
    assert verify(tmp_path / "merged").problems == []


def test_shards_of_one_task_dataset(tmp_path: Path) -> None:
    """Numbered by seed; every attempt and every kept failure of each shard is there."""
    first, second = shards(tmp_path)
    assert (seeds(first), seeds(second)) == ([0, 4, 6], [1, 3, 7])
    progress: list[tuple[int, int]] = []
    assert merge([second, first], tmp_path / "all", lambda *at: progress.append(at)) == [FOLDER]
    assert progress[-1] == (6, 6)
    report = verify(tmp_path / "all")
    assert (report.problems, report.notes) == ([], [])
    assert seeds(tmp_path / "all") == [0, 1, 3, 4, 6, 7]
    assert [one.seed for one in Dataset(tmp_path / "all").failures()] == [2, 5]
    (entry,) = Dataset(tmp_path / "all").task_datasets
    assert (entry.attempts, entry.spec.shards, entry.spec.shard) == (8, 2, 0)
    for part in (first, second):
        for episode in (*Dataset(part), *Dataset(part).failures()):
            where = Dataset(tmp_path / "all")
            found = where.failures() if episode.failed else where
            same = next(one for one in found if one.seed == episode.seed)
            assert same.paths.hdf5.read_bytes() == episode.paths.hdf5.read_bytes()
            assert same.paths.video.read_bytes() == episode.paths.video.read_bytes()
    merge([first, second], tmp_path / "again")
    assert content(tmp_path / "again") == content(tmp_path / "all"), "in any order"
