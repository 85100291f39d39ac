"""`rtphys assets`: what a pack holds, and that no world is built with a robot that it refuses."""

import json
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from shutil import copytree

import pytest
import yaml
from PIL import Image
from typer.testing import CliRunner

from rtphys.assets.identity import STAMP
from rtphys.assets.known_robots import PIPER
from rtphys.assets.pack import builtin_pack, default_pack
from rtphys.cli import machine
from rtphys.cli.main import app
from rtphys.sim import world


@pytest.fixture
def mine(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of a robot in a user's library."""
    folder = tmp_path / "robots" / "mine"
    copytree(builtin_pack().embodiment_folder("piper"), folder)
    text = (folder / "config.yml").read_text()
    (folder / "config.yml").write_text(yaml.safe_dump({"hand": PIPER["hand"]}) + text)
    monkeypatch.setenv("RTPHYS_LIBRARY", str(tmp_path))
    return folder


def output_of(*arguments: str, fails: bool = False) -> str:
    done = CliRunner().invoke(app, arguments)
    assert (done.exit_code != 0) == fails, done.output
    return " ".join(done.output.split())


def test_a_usable_robot_and_a_pair_with_it(mine: Path) -> None:
    text = output_of("assets", "check", "--robot", "mine")
    assert "mine: usable, 14 numbers: left arm 6 [rad]" in text
    assert "its hands open 8.0 cm and 8.0 cm" in text
    facts = json.loads(output_of("assets", "check", "--robot", "mine,franka-panda,0.70", "--json"))
    assert (facts["robot"], facts["numbers"]) == ("mine,franka-panda,0.7", 15)


@pytest.mark.parametrize("command", [("check", "click_bell"), ("collect", "--task", "click_bell")])
def test_an_unusable_robot_is_refused_before_a_world_is_built(
    mine: Path, command: tuple[str, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def build(*_: object) -> None:
        raise AssertionError("a world was built")

    monkeypatch.setattr(world.World, "__init__", build)
    monkeypatch.chdir(tmp_path)
    config = mine / "config.yml"
    config.write_text(config.read_text().replace("[[0, -0.45, 0.85", "[[0, -2.45, 0.85"))
    text = output_of(*command, "--embodiment", "mine", fails=True)
    assert "the left arm reaches nothing on the table; see `robot_pose` of 'mine'" in text
    mesh = next((mine / "meshes").glob("*.glb"))
    mesh.unlink()
    text = output_of("assets", "check", "--robot", "mine", fails=True)
    assert f"has no mesh meshes/{mesh.name} (needed by piper.urdf)" in text


def test_each_model_is_a_row_with_its_points() -> None:
    listed = json.loads(output_of("assets", "list", "*bell", "015_laptop", "--json"))
    rows = {(row["object"], row["model"]): row for row in listed}
    pack = default_pack()
    for (name, index), row in rows.items():
        model = (pack.articulation if row["articulated"] else pack.model)(name, index)
        assert row["contact_points"] == len(model.contact_points)
        assert row["functional_points"] == len(model.functional_points)
    assert {name for name, _ in rows} >= {"050_bell", "052_dumbbell", "015_laptop"}
    assert rows["015_laptop", 0]["size_m"] is None
    assert rows["050_bell", 0]["size_m"] == [
        round(float(x), 4) for x in pack.model("050_bell", 0).extents
    ]


def test_the_table_holds_every_model_and_a_wrong_name_is_an_error() -> None:
    lines = CliRunner().invoke(app, ["assets", "list"]).output.splitlines()
    pack = default_pack()
    assert len(lines) == 2 + sum(len(pack.indices(name)) for name in pack.names)
    assert "did you mean '050_bell'" in output_of("assets", "list", "050_bel", fails=True)


def test_a_folder_without_models_hides_no_other(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As `objects/objaverse` of the official pack."""
    copytree(default_pack().root / "objects" / "050_bell", tmp_path / "objects" / "050_bell")
    (tmp_path / "objects" / "objaverse" / "apple").mkdir(parents=True)
    monkeypatch.setenv("RTPHYS_ASSETS", str(tmp_path))
    rows = json.loads(output_of("assets", "list", "--json"))
    assert [(row["object"], row["model"]) for row in rows] == [("050_bell", 0), ("050_bell", 1)]
    assert "objaverse" in output_of("assets", "list", "objaverse", fails=True)


def test_a_picture_is_of_the_models_that_are_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert "Missing argument" in output_of("assets", "show", fails=True)
    said = output_of("assets", "show", "050_bell/0", "*_dumbbell", "--size", "32")
    assert f"assets.png: {1 + len(default_pack().indices('052_dumbbell'))} models" in said
    for out in ("sheet", "no/folder/sheet.gif"):
        assert "its name ends in .png or .jpg" in output_of(
            "assets", "show", "050_bell", "--out", out, fails=True
        )
    output_of("assets", "show", "050_bell/0", "--size", "32", "--out", "new/folder/sheet.jpg")
    with Image.open("new/folder/sheet.jpg") as picture:
        assert picture.size == (32, 44)
    assert "write an object's name" in output_of("assets", "show", "050_bell/²", fails=True)


def test_building_never_replaces_what_is_no_pack(tmp_path: Path) -> None:
    """A dataset, the official pack, a file: all was deleted."""
    (tmp_path / "data").mkdir()
    mine = tmp_path / "data" / "thesis.txt"
    mine.write_text("years of work")
    for out in (tmp_path / "data", mine):
        said = output_of("assets", "build", "--out", str(out), fails=True)
        assert "rtphys built no pack there; name a new or empty folder" in said
    assert mine.read_text() == "years of work"


def test_a_pack_is_built_into_a_new_or_empty_folder_or_over_another(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def build(root: Path, *_: object, **__: object) -> None:
        copytree(builtin_pack().root / "embodiments", root / "embodiments", dirs_exist_ok=True)
        (root / STAMP).write_text('{"digest": "0"}')

    monkeypatch.setattr(machine, "build_pack", build)
    (tmp_path / "empty").mkdir()
    for name in ("new", "empty", "empty"):
        output_of("assets", "build", "--out", str(tmp_path / name), "--force")
        assert (tmp_path / name / STAMP).is_file()


def test_a_link_is_kept_whoever_else_links(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As the jobs of a cluster do, all at once; and it is for all who share the cache."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    (pack := tmp_path / "pack" / "objects").mkdir(parents=True)
    with ThreadPoolExecutor(2) as jobs:
        for job in [jobs.submit(machine.link, pack.parent) for _ in range(100)]:
            job.result()
    link = tmp_path / "cache" / "rtphys" / "assets" / "link.json"
    assert json.loads(link.read_text()) == {"root": str(pack.parent), "fallback": False}
    (new := tmp_path / "new").touch()
    assert link.stat().st_mode == new.stat().st_mode and [*link.parent.iterdir()] == [link]
    (odd := tmp_path / "p\udcff" / "objects").mkdir(parents=True)
    assert "its path is not UTF-8" in output_of("assets", "link", str(odd.parent), fails=True)
    assert default_pack().root == pack.parent, "commands go on"


@pytest.mark.parametrize("ignored", [("check", "--fallback", "builtin"), ("link", ".", "--remove")])
def test_what_would_be_ignored_is_refused(
    ignored: tuple[str, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))  # the user's link is not ours to remove
    assert "is not allowed" in output_of("assets", *ignored, fails=True)


def test_a_task_that_cannot_be_loaded_hides_no_other(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "tasks").mkdir()
    (tmp_path / "tasks" / "stir_mud.py").write_text("import nothing_such")
    monkeypatch.setenv("RTPHYS_LIBRARY", str(tmp_path))
    monkeypatch.setattr(machine, "task_names", lambda: ["click_bell", "stir_mud"])
    said = output_of("assets", "check", fails=True)
    assert "stir_mud.py: cannot be loaded" in said and "tasks that can run: click_bell" in said
