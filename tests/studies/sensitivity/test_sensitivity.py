"""The command in real worlds: known answers, and the same file however it was made."""

import json
from dataclasses import replace
from pathlib import Path

import pytest
from typer.testing import CliRunner

from rtphys.assets.pack import Pack, default_pack
from rtphys.campaign.engine import Listener
from rtphys.cli.main import app
from rtphys.core.errors import BadValue, UnknownName
from rtphys.studies.sensitivity.plan import SensitivityPlan
from rtphys.studies.sensitivity.run import OtherSensitivity, sensitivity


class Killed(BaseException):
    """Stands for a signal."""


class Killer(Listener):
    """Ends the run after so many rounds of results."""

    def __init__(self, after: int) -> None:
        self.left = after

    def ticked(self) -> None:
        self.left -= 1
        if self.left < 0:
            raise Killed


@pytest.fixture(scope="module")
def pack() -> Pack:
    return default_pack()


def plan(out: Path, workers: int = 1) -> SensitivityPlan:
    keys = ("camera_angle", "table_height")
    return SensitivityPlan(("click_bell",), keys, seeds=2, steps=1, out=out, workers=workers)


@pytest.mark.sim
def test_a_camera_cannot_matter_open_loop_and_a_lower_table_must(
    tmp_path: Path, pack: Pack
) -> None:
    (result,) = sensitivity(plan(tmp_path / "one"), pack)
    attributes = result["attributes"]
    assert isinstance(attributes, dict) and result["seeds"] == [0, 1]
    assert attributes["camera_angle"]["share"] == 1.0
    assert attributes["table_height"]["share"] < 1.0
    file = tmp_path / "one" / "click_bell.json"
    before = file.read_bytes()
    sensitivity(plan(tmp_path / "one"), pack)  # measures nothing again
    assert file.read_bytes() == before

    with pytest.raises(Killed):
        sensitivity(plan(tmp_path / "two"), pack, Killer(2))
    sensitivity(plan(tmp_path / "two", workers=2), pack)
    assert (tmp_path / "two" / "click_bell.json").read_bytes() == before
    assert sorted(p.name for p in (tmp_path / "two").glob("*.json")) == ["click_bell.json"]

    words = ["sensitivity", "--task", "click_bell", "--only", "camera_angle,table_height"]
    more = ["--seeds", "2", "--steps", "1", "--out", str(tmp_path / "one")]
    figure = tmp_path / "map.png"
    done = CliRunner().invoke(app, [*words, *more, "--figure", str(figure), "--json"])
    assert done.exit_code == 0, done.output
    assert json.loads(done.stdout)[0]["attributes"] == attributes
    assert figure.read_bytes().startswith(b"\x89PNG")
    with pytest.raises(OtherSensitivity, match="steps was 1, now 2"):
        sensitivity(replace(plan(tmp_path / "one"), steps=2), pack)


def test_what_cannot_be_is_refused_before_any_work(tmp_path: Path) -> None:
    with pytest.raises(UnknownName, match="did you mean 'friction'"):
        SensitivityPlan(("click_bell",), ("frictoin",))
    with pytest.raises(BadValue, match="makes its own demonstrations"):
        SensitivityPlan(("click_bell",), policy="replay:data").check()
    with pytest.raises(UnknownName, match="policy"):
        SensitivityPlan(("click_bell",), policy="repaly").check()
