"""Shards join to what one machine makes, and datasets to one; what does not fit is refused."""

import shutil
from dataclasses import replace
from pathlib import Path

import pytest
import robotless
from collecting import content
from robotless import EPISODES, collect, plans, shards
from typer.testing import CliRunner

from rtphys.cli.main import app
from rtphys.core.errors import BadFile, BadValue
from rtphys.data import files
from rtphys.data.attempts import Accepted, Rejected, read_attempts
from rtphys.data.dataset import Dataset
from rtphys.data.faults import DatasetMismatch, PartsMismatch
from rtphys.data.rewrite import merge, subset, unfinished
from rtphys.spec.collection import CollectionSpec, TaskHeader
from rtphys.studies import collect as collect_module
from rtphys.studies.requests import shard_of, specs_for

pytestmark = pytest.mark.usefixtures("without_robot")
NAME = "clean/click_bell/aloha_agilex"


def rows(out: Path, task: str = "click_bell") -> list[Accepted | Rejected]:
    (ledger,) = out.glob(f"*/{task}/*/ledger.jsonl")
    return list(read_attempts(ledger))


# ---- shards --------------------------------------------------------------------------------------


@pytest.mark.parametrize(("tasks", "of"), [(2, 2), (3, 2), (2, 1)])
@pytest.mark.parametrize("twin", [None, "phys_random"])
def test_whole_tasks_join_to_the_same_bytes(
    tasks: int, of: int, twin: str | None, tmp_path: Path
) -> None:
    whole = tuple(replace(spec, twin=twin, keep_failures="2") for spec in plans(tasks))
    alone = collect(whole, tmp_path / "alone")
    merge(shards(whole, of, tmp_path)[::-1], tmp_path / "joined")
    assert content(tmp_path / "joined") == content(alone)


@pytest.mark.parametrize(("tasks", "of"), [(1, 2), (1, 3), (2, 4), (3, 4)])
def test_shards_that_share_a_task_join_by_seed(tasks: int, of: int, tmp_path: Path) -> None:
    """Every seed is one shard's; what comes of it is what one machine makes of it."""
    whole = plans(tasks)
    alone = collect(whole, tmp_path / "alone")
    merge(shards(whole, of, tmp_path)[::-1], tmp_path / "joined")
    for spec in whole:
        here, there = (rows(out, spec.episode.task) for out in (tmp_path / "joined", alone))
        seeds = [row.seed for row in here]
        assert seeds == sorted(set(seeds)) and sum(r.verdict == "accepted" for r in here) >= 12
        said = {row.seed: row.verdict for row in there}
        assert {row.seed: row.verdict for row in here if row.seed in said}.items() <= said.items()
    data = Dataset(tmp_path / "joined")
    numbers = [(episode.task, episode.number) for episode in data]
    assert len(set(numbers)) == len(data) == sum(e.episodes for e in data.task_datasets)


def test_a_merge_that_was_killed_is_resumed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    parts = shards(plans(), 3, tmp_path)
    merge(parts, tmp_path / "whole")
    known, left = files.write_synced, iter(range(EPISODES * 3))

    class Killed(Exception):
        pass

    def kill(path: Path, data: bytes) -> files.FileFacts:
        if next(left, None) is None:
            raise Killed
        return known(path, data)

    with monkeypatch.context() as patch, pytest.raises(Killed):
        patch.setattr(files, "write_synced", kill)
        merge(parts, tmp_path / "joined")
    merge(parts, tmp_path / "joined")
    assert content(tmp_path / "joined") == content(tmp_path / "whole")


def test_a_part_that_is_unfinished_is_named(tmp_path: Path) -> None:
    """A shard with fewer episodes than another, and what a killed run leaves."""
    parts = shards(plans(1), 3, tmp_path)
    assert unfinished(parts) == []
    shutil.rmtree(parts[1])
    collect(plans(1, EPISODES - 3), parts[1], "2/3")
    (clause,) = unfinished(parts)
    assert clause == f"{parts[1]}/{NAME}: shard 2 of 3 has 3 episodes, another shard has 4"
    done = CliRunner().invoke(app, ["merge", *map(str, parts), "--out", str(tmp_path / "few")])
    assert done.exit_code == 4 and f"unfinished: {clause}" in done.stderr
    assert len(Dataset(tmp_path / "few")) == EPISODES - 1, "joined all the same"
    staging = parts[0] / NAME / ".staging"
    staging.mkdir()
    assert unfinished(parts[:1]) == [f"{parts[0]}/{NAME}: its run was killed, or goes on"]
    collect(plans(1), parts[0], "1/3")
    collect(plans(1), parts[1], "2/3")
    assert unfinished(parts) == []
    manifest = (parts[2] / "manifest.json").read_bytes()
    collect(plans(1, EPISODES + 3), parts[2], "3/3")
    (parts[2] / "manifest.json").write_bytes(manifest)
    assert unfinished(parts) == [f"{parts[2]}/{NAME}: its run was killed, or goes on"]


@pytest.mark.parametrize("text", ["0/2", "3/2", "2", "a/b", "-1/2", "1/0"])
def test_a_shard_is_one_of_n(text: str) -> None:
    with pytest.raises(BadValue, match="from 1/n to n/n"):
        shard_of(plans(), text)


def test_the_division_is_even_and_whole() -> None:
    """Every task is worked on, by as many shards as any other or by one."""
    for tasks in range(1, 8):
        wanted = specs_for(plans()[0], "abcdefg"[:tasks])
        for of in range(1, 9):
            parts = [shard_of(wanted, f"{index}/{of}") for index in range(1, of + 1)]
            assert all(parts)
            work = [(one.episode.task, one.shard, one.shards) for part in parts for one in part]
            (sharing,) = {shares for _, _, shares in work}
            numbers = range(1, sharing + 1) if sharing > 1 else [0]
            assert sorted(work) == [
                (one.episode.task, n, sharing) for one in wanted for n in numbers
            ]


def test_a_shards_folder_is_no_other_shards(tmp_path: Path) -> None:
    out = collect(plans(1), tmp_path / "out", "1/2")
    with pytest.raises(DatasetMismatch, match=r"spec\.shard was 1, now 2"):
        collect(plans(1), out, "2/2")
    with pytest.raises(DatasetMismatch, match=r"spec.shard was 1, now 0; spec.shards was 2, now 1"):
        collect(plans(1), out)


# ---- what is refused -----------------------------------------------------------------------------


def test_parts_that_do_not_fit(tmp_path: Path) -> None:
    one, two, three = shards(plans(1), 3, tmp_path / "a")
    half = collect(plans(1), tmp_path / "c", "1/2")
    again = Path(shutil.copytree(two, tmp_path / "again"))
    other = collect(tuple(replace(s, keep_failures="1") for s in plans(1)), tmp_path / "d", "3/3")
    wrong = {
        "shard 2 of 3 is not among the parts": [one, three],
        "two of the parts are the same shard": [one, two, again, three],
        "shards was 3, now 2": [one, half],
        "keep_failures was None, now '1'": [one, two, other],
    }
    for problem, parts in wrong.items():
        with pytest.raises(PartsMismatch, match=f"cannot be joined with the others: .*{problem}"):
            merge(parts, tmp_path / "joined")
        assert not (tmp_path / "joined" / "manifest.json").exists()
    whole = [collect(plans(1), tmp_path / name) for name in ("e", "f")]
    with pytest.raises(PartsMismatch, match="seed 3 is in"):
        merge(whole, tmp_path / "joined")
    with pytest.raises(BadValue, match="it is a dataset that is read; name another folder"):
        merge([one, two, three], one)
    assert not (tmp_path / "joined").exists()  # refused before anything is written


def test_parts_of_different_versions(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    one = collect(plans(1), tmp_path / "one", "1/2")

    def newer(*arguments) -> TaskHeader:
        header = robotless.header(*arguments)
        return replace(header, resolved=replace(header.resolved, versions={"rtphys": "0.2.0"}))

    monkeypatch.setattr(collect_module, "header_of", newer)
    two = collect(plans(1), tmp_path / "two", "2/2")
    with pytest.raises(PartsMismatch, match=r"versions.rtphys was '0.1.0', now '0.2.0'"):
        merge([one, two], tmp_path / "joined")


def test_a_damaged_part(tmp_path: Path) -> None:
    parts = shards(plans(1), 2, tmp_path)
    victim = next(parts[1].rglob("*.hdf5"))
    victim.write_bytes(b"x" * victim.stat().st_size)
    with pytest.raises(BadFile, match="is not what its ledger says"):
        merge(parts, tmp_path / "joined")


# ---- any datasets --------------------------------------------------------------------------------


def test_other_seeds_of_one_task_are_joined_and_not_continued(tmp_path: Path) -> None:
    first, later = plans(1)[0], replace(plans(1)[0], first_seed=100)
    parts = [collect((one,), tmp_path / str(n)) for n, one in enumerate((later, first))]
    merge(parts, tmp_path / "joined")
    assert [row.seed for row in rows(tmp_path / "joined")] == [
        row.seed for part in reversed(parts) for row in rows(part)
    ]
    assert len(Dataset(tmp_path / "joined")) == 2 * EPISODES
    with pytest.raises(DatasetMismatch, match="made_by was 'merge', now 'collect'"):
        collect((first,), tmp_path / "joined")


def test_a_subset_of_tasks_keeps_them_as_they_are(tmp_path: Path) -> None:
    data = collect(plans(2), tmp_path / "data")
    subset(Dataset(data).where(task="lift_pot"), tmp_path / "part")
    assert content(tmp_path / "part") == content(collect(plans(2)[1:], tmp_path / "alone"))


def test_a_subset_of_seeds_is_numbered_anew(tmp_path: Path) -> None:
    data = collect(plans(1), tmp_path / "data")
    wanted = [episode.seed for episode in Dataset(data)][3:6]
    subset(Dataset(data).where(seeds=wanted), tmp_path / "part")
    part = Dataset(tmp_path / "part")
    assert [(episode.number, episode.seed) for episode in part] == list(enumerate(wanted))
    with pytest.raises(DatasetMismatch, match="made_by"):
        collect(plans(1), tmp_path / "part")


# ---- the commands --------------------------------------------------------------------------------


def run(*words: object) -> str:
    done = CliRunner().invoke(app, [str(word) for word in words])
    assert done.exit_code == 0, done.output
    return done.stdout


def test_the_commands(tmp_path: Path) -> None:
    parts, joined = shards(plans(2), 2, tmp_path), tmp_path / "joined"
    assert "24 episodes in 2 task datasets" in run("merge", *parts, "--out", joined)
    assert "12 episodes in 1 task dataset" in run(
        "subset", joined, "--out", tmp_path / "a", "--task", "lift_pot"
    )
    seeds = [episode.seed for episode in Dataset(joined)]
    said = run("subset", joined, "--out", tmp_path / "b", "--drop-seed", seeds[0])
    assert f"{sum(seed != seeds[0] for seed in seeds)} episodes" in said
    for wrong, problem in (
        (["--task", "lift_pt"], "did you mean 'lift_pot'?"),
        (["--seed", "x"], "--seed = 'x' is not allowed"),
    ):
        done = CliRunner().invoke(app, ["subset", str(joined), "--out", str(tmp_path), *wrong])
        assert done.exit_code == 2 and problem in done.stderr


def test_a_spec_says_what_its_shard_does() -> None:
    spec = CollectionSpec(first_seed=10, shards=3, shard=2)
    assert [spec.seed(n) for n in range(3)] == [11, 14, 17]
