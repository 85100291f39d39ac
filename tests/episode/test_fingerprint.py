"""A fingerprint covers what decides a state: task, family, expert, simulation."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import rtphys
from rtphys.assets.pack import builtin_pack
from rtphys.episode.fingerprint import shaping_files, versions
from rtphys.task.spec import load_task

PACKAGE = Path(rtphys.__file__).parent
DRAWING = ("sim/renderer.py", "episode/render.py", "data/video.py", "cli/main.py")
# Prints the files whose code runs in an attempt under every attribute, but for what it imports.
FILES_THAT_RUN = """
import sys
from rtphys.assets.pack import default_pack
from rtphys.episode.generate import attempt
from rtphys.spec.episode import EpisodeSpec
from rtphys.task.spec import load_task
recipe, task, pack = EpisodeSpec("TASK", "phys_random_all").at(1), load_task("TASK"), default_pack()
ran = set()
sys.setprofile(lambda frame, event, given: ran.add(frame.f_code.co_filename))
attempt(recipe, task, pack)
sys.setprofile(None)
print(*ran, sep="\\n")
"""


@pytest.mark.sim
@pytest.mark.parametrize("task", ["lift_pot", "open_laptop"])
def test_the_way_from_a_recipe_to_its_states_is_covered_and_pictures_are_not(task: str) -> None:
    program = [sys.executable, "-c", FILES_THAT_RUN.replace("TASK", task)]
    output = subprocess.run(program, check=True, capture_output=True, text=True).stdout
    ran = {Path(line) for line in output.splitlines() if line.startswith(f"{PACKAGE}/")}
    covered = shaping_files()
    assert len(ran) > 50
    assert ran - covered == set()
    assert covered.isdisjoint(PACKAGE / name for name in DRAWING)


def test_what_an_attribute_of_a_library_imports_counts(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "attributes"
    folder.mkdir()
    (folder / "stickiness.py").write_text("from ._glue import STRENGTH\n")
    (folder / "_glue.py").write_text("STRENGTH = 1.0\n")
    monkeypatch.setenv("RTPHYS_LIBRARY", str(tmp_path))
    assert {folder / "stickiness.py", folder / "_glue.py"} <= shaping_files()


def test_a_mesh_of_a_librarys_robot_counts_though_its_size_stays(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "robots" / "mine"
    shutil.copytree(builtin_pack().embodiment_folder("piper"), folder)
    monkeypatch.setenv("RTPHYS_LIBRARY", str(tmp_path))
    task = load_task("click_bell")
    before = versions(task, "mine")
    mesh = next((folder / "meshes").glob("*.stl"))
    data = bytearray(mesh.read_bytes())
    data[-3] ^= 1  # of a corner's last coordinate
    mesh.write_bytes(data)
    after = versions(task, "mine")
    assert {key for key in before if before[key] != after[key]} == {"robot"}
    assert versions(task, "piper") == {key: before[key] for key in before if key != "robot"}


FAMILY = "LIFT = 0.1  # [m]\n"
OWN = '''"""Do nothing."""
from rtphys.task import Task, hands_open

from ._family import LIFT


def layout(draw):
    return []


def script(robot):
    robot.left.lift(LIFT)


task = Task(layout=layout, script=script, success=hands_open(), step_limit=100)
'''


def test_a_familys_code_counts_and_its_comments_do_not(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "tasks"
    folder.mkdir()
    monkeypatch.setenv("RTPHYS_LIBRARY", str(tmp_path))
    (folder / "own.py").write_text(OWN)
    found = []
    for text in (FAMILY, FAMILY.replace("[m]", "metres, upwards"), FAMILY.replace("0.1", "0.2")):
        (folder / "_family.py").write_text(text)
        found.append(versions(load_task("own")))
    assert found[0] == found[1]
    assert found[0]["task"] != found[2]["task"]
    assert found[0]["code"] == found[2]["code"]
