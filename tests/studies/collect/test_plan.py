"""What `collect` refuses before any work, and tasks that do not work."""

import json
from dataclasses import replace
from pathlib import Path

import pytest
from collecting import PLAN
from typer.testing import CliRunner

from pages import ran
from rtphys.campaign.series import Bug
from rtphys.cli.main import app
from rtphys.core.errors import BadValue
from rtphys.data.verify import verify
from rtphys.doctor import Finding
from rtphys.spec.collection import CollectionSpec
from rtphys.spec.episode import EpisodeSpec
from rtphys.spec.recording import RecordingSpec
from rtphys.studies import resources
from rtphys.studies.collect import collect
from rtphys.studies.requests import Run

pytestmark = [pytest.mark.sim, pytest.mark.render]


WRONG = {
    "--task click_bel": "did you mean 'click_bell'?",
    "--task click_bell --protocol cleen": "did you mean 'clean'?",
    "--task click_bell --cameras head,lft": "did you mean 'left'?",
    "--task click_bell --cameras left": "head is needed",
    "--task click_bell --cameras head,head": "each camera once",
    "--task click_bell --layout nativ": "did you mean 'native'?",
    "--task click_bell --split sen": "did you mean 'seen'?",
    "--task click_bell --twin cleen": "did you mean 'clean'?",
    "--task click_bell --protocol clean --twin clean": "it is the protocol itself",
    "--task click_bell --fallback builtin": "--fallback stands before the command's name",
    "--task click_bell --shader slm": "did you mean 'slim'?",
    "--task click_bell --set frction=1": "did you mean 'friction'?",
    "--task click_bell --set friction=-1": "friction = -1.0 is not allowed",
    "--task click_bell --set friction": "write key=value",
    "--task click_bell --protocol phys_random --only friktion": "did you mean 'friction'?",
    "--task click_bell --domain globl --protocol phys_random": "did you mean 'global'?",
    "--task click_bell --protocol clean --domain global": "varies no physics",
    "--task click_bell --domain no/such.yaml": "no/such.yaml",
    "--task click_bell --episodes 0": "--episodes = 0 is not allowed",
    "--task click_bell --runner rey": "did you mean 'ray'?",
    "--task click_bell --address 1.2.3.4:6379": "it belongs to --runner ray",
    "--task click_bell --runner ray --gpus 1": "it belongs to --runner local",
    "--task click_bell --shard 0/2": "from 1/n to n/n",
    "--manifest smok": "did you mean 'smoke'?",
    "--manifest smoke --episodes 3": "--episodes = 3 is not allowed; the manifest says that",
    "--manifest smoke lift_pot": "--task = 'lift_pot' is not allowed; the manifest says that",
    "--manifest smoke --set friction=1": "--set",
    "--manifest smoke --shader rt": "--shader",
    "--manifest smoke --shard 3/2": "from 1/n to n/n",
    "": "--task = None is not allowed; name at least one task, or a --manifest",
    "--task click_bell --workers 0": "--workers = 0 is not allowed",
    "--task click_bell --first-seed -1": "--first-seed = -1 is not allowed",
}


@pytest.mark.parametrize("more", [(), ("--dry-run",)], ids=["collect", "dry-run"])
@pytest.mark.parametrize("options", WRONG)
def test_what_cannot_work_is_one_clear_line_and_no_file(
    options: str, more: tuple[str, ...], tmp_path: Path
) -> None:
    out = tmp_path / "data"
    done = ran(["collect", *options.split(), "--out", str(out), *more], 2)
    assert len(done.stderr.strip().splitlines()) == 1
    assert WRONG[options] in done.stderr
    assert not out.exists()


def test_a_file_in_the_way_is_refused(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    out = tmp_path / "file" / "data"
    done = ran(["collect", "--task", "click_bell", "--out", str(out)], 2)
    assert str(out) in done.stderr


def test_without_a_renderer_the_cure_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    broken = Finding("renderer", "fail", "no_driver", "the Vulkan loader finds no device")
    monkeypatch.setattr(resources, "check_renderer", lambda command: broken)
    monkeypatch.setattr(resources, "user_cache", lambda: tmp_path)  # as on a first day
    out = tmp_path / "data"
    for more, code in (([], 3), (["--dry-run"], 0)):
        line = ["collect", "click_bell", "--out", str(out), *more]
        done = ran(line, code)
        assert "mesa-vulkan-drivers" in done.stderr
        assert not out.exists()


def test_a_dry_run_answers_where_the_disk_is_too_small(tmp_path: Path) -> None:
    line = ["collect", "click_bell", "--episodes", "9000000", "--out", str(tmp_path / "data")]
    done = ran(line, 2)
    assert "GB are needed" in done.stderr
    done = ran([*line, "--dry-run"])
    assert "9000000 episodes in" in done.stdout
    assert "here and now it would be refused: " in done.stderr and "GB are needed" in done.stderr
    assert "pictures of 320x240" not in done.stdout
    done = CliRunner().invoke(app, [*line, "--dry-run", "--size", "128x96"])
    assert "its CPU time is that of pictures of 320x240" in done.stdout


OTHER_SHADER = RecordingSpec(shader="default")


def test_one_task_dataset_is_collected_once(tmp_path: Path) -> None:
    with pytest.raises(BadValue, match=r"phys_random/click_bell/aloha_agilex' .*collected twice"):
        collect([PLAN, replace(PLAN, episodes=5)], Run(tmp_path / "data"))


def test_one_run_draws_with_one_shader(tmp_path: Path) -> None:
    other = replace(PLAN, episode=EpisodeSpec("lift_pot", "clean"), recording=OTHER_SHADER)
    with pytest.raises(BadValue, match=r"shader = 'default' .*draws with 'slim' already"):
        collect([PLAN, other], Run(tmp_path / "data"))
    assert not (tmp_path / "data").exists()


HOPELESS = '''
"""Do what cannot be done."""
from dataclasses import replace
from rtphys.task import Infeasible, load_task

def script(robot):
    %s

task = replace(load_task("click_bell"), script=script)
'''


def test_a_hopeless_task_is_given_up_and_its_rejections_are_kept(own_task, tmp_path: Path) -> None:
    own_task("hopeless", HOPELESS % 'raise Infeasible("unreachable", "for all eternity")')
    out = tmp_path / "data"
    options = ["--task", "hopeless", "--out", str(out), "--max-attempts", "3", "--workers", "1"]
    done = ran(["collect", *options], 4)
    assert "hopeless: the most attempts that were allowed were made: 3" in done.stderr
    assert "`--keep-failures 5` keeps some, which `rtphys report` shows" in done.stderr
    assert verify(out).problems == []
    leaf = json.loads((out / "manifest.json").read_text())["task_datasets"][
        "phys_random_all/hopeless/aloha_agilex"
    ]
    assert leaf["rejections"] == {"unreachable": 3}
    assert leaf["episodes"] == 0


@pytest.mark.processes
def test_a_bug_in_a_script_stops_the_run_with_a_traceback_in_a_file(
    own_task, tmp_path: Path
) -> None:
    own_task("hopeless", HOPELESS % "robot.dance()")
    out = tmp_path / "data"
    with pytest.raises(Bug, match=r"hopeless, seed 0: AttributeError: .*dance") as caught:
        collect([CollectionSpec(EpisodeSpec("hopeless", "clean"), episodes=1)], Run(out))
    log = out / "error.log"
    assert str(log) in str(caught.value)
    assert "robot.dance()" in log.read_text()
    assert not list(out.rglob("*.hdf5"))
