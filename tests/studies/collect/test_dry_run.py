"""`collect --dry-run`: what would be collected and where, what could not act; nothing is done."""

import re
import shutil
from pathlib import Path

import pytest
import robotless
from collecting import content
from robotless import plans

from pages import ROOT, ran
from rtphys.core.errors import BadValue
from rtphys.doctor import Finding
from rtphys.spec.collection import CollectionSpec
from rtphys.spec.episode import EpisodeSpec
from rtphys.spec.sweep import swept
from rtphys.studies import collect as collect_module
from rtphys.studies import resources
from rtphys.studies.collect import check, without_effect
from rtphys.studies.rates import MOST, SHARES, costs
from rtphys.studies.requests import Run, room_needed


@pytest.fixture(autouse=True)
def a_renderer(monkeypatch: pytest.MonkeyPatch) -> None:
    """As if there were one; and whoever collects would be caught."""
    fine = Finding("renderer", "ok", "", "")
    monkeypatch.setattr(resources, "check_renderer", lambda command: fine)


def rows(*options: str) -> tuple[dict[str, list[str]], str]:
    """Folder -> its cells; and the last line."""
    line = ["collect", *options, "--dry-run"]
    done = ran(line, columns=200)
    *table, last = done.stdout.strip().splitlines()
    cells = [re.split(r" {2,}", row.strip()) for row in table]
    return {row[0]: row[1:] for row in cells if len(row) > 1 and row[0] != "folder"}, last


def test_it_names_every_folder_and_writes_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(collect_module, "collect", None)
    out = tmp_path / "data"
    options = ["--task", "click_bell,lift_pot", "--protocol", "phys_random", "--twin", "clean"]
    found, last = rows(*options, "--episodes", "7", "--first-seed", "3", "--out", str(out))
    assert list(found) == [
        f"{config}/{task}/aloha_agilex"
        for task in ("click_bell", "lift_pot")
        for config in ("phys_random", "phys_random.twin=clean")
    ]
    assert {tuple(cells[:3]) for cells in found.values()} == {("7", "0", "3")}
    own, twin = list(found.values())[:2]
    assert (own[-1], twin[-1]) != ("nominal", "nominal")
    assert twin[-1] == "nominal"
    each = costs()["click_bell"].megabytes + costs()["lift_pot"].megabytes
    table = 7 * each * 2 * SHARES["phys_random"][1]
    assert last.startswith(f"28 episodes in {out}, at most {MOST * table:.0f} MB")
    assert "nothing was collected" in last and f" and {table:.0f} MB by the table" in last
    assert not list(tmp_path.iterdir())


def test_it_knows_what_is_there(tmp_path: Path, without_robot: None) -> None:
    out = robotless.collect(plans(1, 5), tmp_path / "data")
    before = content(out)
    options = ["--task", "click_bell,lift_pot", "--protocol", "clean", "--first-seed", "3"]
    options += ["--out", str(out)]
    found, _ = rows(*options, "--episodes", "9")
    assert [cells[:2] for cells in found.values()] == [["9", "5"], ["9", "0"]]
    assert content(out) == before


def test_a_shard_names_its_own_part(tmp_path: Path) -> None:
    options = ["--task", "click_bell,lift_pot", "--episodes", "9", "--out", str(tmp_path / "data")]
    found, last = rows(*options, "--shard", "2/2")
    assert list(found) == ["phys_random_all/lift_pot/aloha_agilex"]
    assert last.startswith("9 episodes")
    found, last = rows(*options, "--shard", "1/4")
    assert {folder: cells[0] for folder, cells in found.items()} == {
        "phys_random_all/click_bell/aloha_agilex": "5"
    }


def test_a_sweep_and_a_manifest(tmp_path: Path) -> None:
    out = ["--out", str(tmp_path / "data")]
    found, _ = rows("--task", "lift_pot", "--sweep", "friction=0.1,0.2", *out)
    assert [folder.partition("/")[0] for folder in found] == [
        "phys_random_all.friction=0.1",
        "phys_random_all.friction=0.2",
    ]
    found, _ = rows("--manifest", "smoke", *out)
    assert {folder.partition("/")[0] for folder in found} == {"clean", "phys_random_all"}
    assert not list(tmp_path.iterdir())


VARIATIONS = {  # options -> folder, and what the first line begins with after the protocol
    "--only friction": ("only_friction", "friction varies;"),
    "--protocol clean --only friction": ("clean.only=friction", "friction varies;"),
    "--protocol clean --set friction=0.2": ("clean.friction=0.2", "friction is held at 0.2;"),
    "--protocol phys_random_all --only friction": (
        "phys_random_all.only=friction",
        "friction varies; textures",
    ),
    "--protocol clean --sweep friction=0.05,0.3,0.8": (
        "clean.friction=0.05",
        "friction is swept: 0.05, 0.3, 0.8;",
    ),
}


@pytest.mark.parametrize("options", VARIATIONS)
def test_folder_and_first_line_say_what_varies(options: str, tmp_path: Path) -> None:
    folder, said = VARIATIONS[options]
    line = ["collect", "--task", "click_bell", *options.split(), "--dry-run"]
    done = ran([*line, "--out", str(tmp_path / "data")], columns=200)
    assert f"{folder}/click_bell/aloha_agilex " in done.stdout
    assert done.stdout.startswith(f"protocol {folder.partition('.')[0]}: {said}")


def test_few_episodes_are_told_in_minutes_and_megabytes(tmp_path: Path) -> None:
    out = ["--out", str(tmp_path / "data")]
    _, few = rows("click_bell", "--episodes", "3", *out)
    assert re.search(r"at most [1-9]\d* MB.* about \d+ s of CPU.* and [1-9]\d* MB by", few), few
    _, many = rows("click_bell", "--episodes", "5000", *out)
    assert re.search(r"at most \d+\.\d GB.* about \d\.\d h of CPU.* and \d+\.\d GB by", many), many


@pytest.mark.parametrize(
    ("tasks", "said"), [("mine", "this task has"), ("mine,yours", "these tasks have")]
)
def test_tasks_that_nobody_measured_have_no_estimate(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, tasks: str, said: str
) -> None:
    (tmp_path / "tasks").mkdir()
    for task in tasks.split(","):
        shutil.copy(ROOT / "tasks" / "click_bell.py", tmp_path / "tasks" / f"{task}.py")
    monkeypatch.setenv("RTPHYS_LIBRARY", str(tmp_path))
    _, last = rows(tasks, "--episodes", "1", "--out", str(tmp_path / "data"))
    assert f"no cost estimate: {said} not been measured; nothing was collected" in last


@pytest.mark.parametrize(
    ("episode", "measured"),
    [  # [MB] of the files that were collected; the largest that anybody has met
        ({"task": "stack_bowls_three", "protocol": "phys_random_all"}, 44.3),
        ({"task": "stack_bowls_three", "protocol": "phys_random"}, 25.5),
        ({"task": "open_laptop", "protocol": "phys_random_all"}, 15.8),
        ({"task": "click_bell", "protocol": "phys_random_all"}, 7.2),
        (
            {
                "task": "beat_block_hammer",
                "protocol": "clean",
                "overrides": {"friction": 0.15},
            },
            4.95,
        ),
        ({"task": "lift_pot", "protocol": "clean", "overrides": {"friction": 0.02}}, 5.34),
        ({"task": "soap_on_notebook", "protocol": "clean"}, 4.1),  # a task of a user's own
    ],
    ids=str,
)
def test_no_episode_that_was_measured_is_larger_than_the_bound(
    episode: dict[str, object], measured: float
) -> None:
    spec = CollectionSpec(EpisodeSpec(**episode), episodes=1)  # type: ignore[arg-type]
    assert measured * 1e6 < room_needed([spec], MOST) < 50 * measured * 1e6
    assert room_needed([spec]) < room_needed([spec], MOST)


def test_the_bound_holds_for_every_measured_mean_with_room_for_its_spread() -> None:
    for task, cost in costs().items():
        spec = CollectionSpec(EpisodeSpec(task, "phys_random_all"), episodes=1)
        assert room_needed([spec]) == pytest.approx(cost.megabytes * 1e6)
        assert room_needed([spec], MOST) > 2 * cost.megabytes * 1e6


def test_time_and_space_depend_on_the_protocol() -> None:
    def last(protocol: str) -> str:
        words = ("click_bell", "--episodes", "5000", "--protocol", protocol, "--out", "/nowhere/x")
        return rows(*words)[1]

    assert last("phys_random") != last("phys_random_all")


def specs(*tasks: str, **changes: object) -> list[CollectionSpec]:
    return [CollectionSpec(EpisodeSpec(task, "phys_random", **changes)) for task in tasks]  # pyright: ignore


def test_one_line_for_each_attribute() -> None:
    asked = {"overrides": {"object_joint_damping": 3.0}, "only": ("friction", "object_mass")}
    assert without_effect(specs("open_laptop", **asked)) == []
    assert without_effect(specs("click_bell", "stack_blocks_two", "open_laptop", **asked)) == [
        "object_joint_damping could not act in 2 of 3 tasks, among them click_bell: "
        "there is no object with joints",
        "object_mass could not act in click_bell: there is no object that can move",
    ]
    (line,) = without_effect(specs("click_bell", only=("center_of_mass",)))
    assert line == "center_of_mass could not act in click_bell: there is no object that can move"


@pytest.mark.parametrize(
    "spec",
    [
        CollectionSpec(EpisodeSpec(only=("object_mass",))),
        CollectionSpec(EpisodeSpec(protocol="only_object_mass")),
        CollectionSpec(EpisodeSpec(protocol="clean"), twin="only_object_mass"),
    ],
    ids=lambda spec: f"{spec.name} {spec.twin}",
)
def test_it_is_one_line_by_whatever_way_one_asks(spec: CollectionSpec) -> None:
    (line,) = without_effect([spec.of_task("click_bell")])
    assert line == "object_mass could not act in click_bell: there is no object that can move"
    assert without_effect([spec.of_task("lift_pot")]) == []


@pytest.mark.parametrize(
    "spec",
    [
        CollectionSpec(EpisodeSpec(only=("object_mass",))),
        CollectionSpec(EpisodeSpec(protocol="clean", overrides={"object_mass": 1.0})),
    ],
    ids=lambda spec: spec.name,
)
def test_what_every_prop_has_of_its_own_is_left_with_nothing(spec: CollectionSpec) -> None:
    (line,) = without_effect([spec.of_task("heavy_below")])
    assert line == (
        "object_mass could not act in heavy_below: every object that can move has its own value "
        "(object_mass@first, object_mass@second)"
    )
    held = EpisodeSpec("heavy_below", "clean", overrides={"object_mass@first": 1.0})
    assert without_effect([CollectionSpec(held)]) == []
    assert without_effect([spec.of_task("bin_the_slippery")]) == []  # of masses it has no own


@pytest.mark.parametrize("task", ["heavy_below", "click_bell"])
def test_a_sweep_without_effect_is_refused(task: str, tmp_path: Path) -> None:
    clean = CollectionSpec(EpisodeSpec(task, "clean"))
    with pytest.raises(BadValue, match=f"object_mass=0.5,2.* could not act in {task}, whose episo"):
        check(swept(clean, "object_mass=0.5,2"), Run(tmp_path))
    check(swept(clean, "friction=0.5,1"), Run(tmp_path))
    assert without_effect(swept(clean, "object_mass=0.5,2")) == []  # said once


def test_what_nobody_asked_for_is_not_told() -> None:
    assert without_effect(specs("click_bell")) == []


@pytest.mark.parametrize("option", ["--set=object_mass=2", "--only=object_mass"])
def test_the_command_says_it_and_goes_on(option: str, tmp_path: Path) -> None:
    words = ["click_bell", option, "--dry-run", "--out", str(tmp_path / "data")]
    done = ran(["collect", *words])
    assert "click_bell" in done.stdout
    assert "object_mass could not act in click_bell" in done.stderr
