"""What is there already needs no more space, and a run that is refused leaves it as it was."""

import re
import shutil
from collections import namedtuple
from dataclasses import replace
from pathlib import Path

import pytest
import synthetic
from collected import keep
from collecting import complete, content
from robotless import plans

from rtphys.campaign.series import LOOKAHEAD, Listener
from rtphys.core.errors import RtphysError
from rtphys.data.faults import DatasetMismatch
from rtphys.data.layout import STAGING
from rtphys.spec.recording import RecordingSpec
from rtphys.studies.collect import collect, missing
from rtphys.studies.requests import Run, room_needed

pytestmark = pytest.mark.usefixtures("without_robot")
FREE = namedtuple("Usage", "total used free")(10**12, 10**12 - 10**9, 10**9)


def test_space_is_needed_for_what_is_missing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    large = RecordingSpec(size="1280x960")
    specs = [replace(spec, recording=large, twin="phys_random") for spec in plans(2)]
    nearly = [replace(spec, episodes=spec.episodes - 1) for spec in specs]
    assert complete(collect(nearly, Run(tmp_path / "begun", workers=1)))
    assert room_needed(specs) / specs[0].episodes < FREE.free < room_needed(specs)
    monkeypatch.setattr(shutil, "disk_usage", lambda _: FREE)
    said = re.escape(f"{room_needed(specs) / 1e9:.1f} GB are needed and 1.0 GB are free")
    with pytest.raises(RtphysError, match=said):
        collect(specs, Run(tmp_path / "new", workers=1))
    assert complete(collect(specs, Run(tmp_path / "begun", workers=1)))


@pytest.mark.parametrize(("kept", "expected"), [("3", 1), ("2", 0), ("all", 1)])
def test_failures_that_are_there_need_no_more_space(
    kept: str, expected: int, tmp_path: Path
) -> None:
    keep(tmp_path, kept)  # five episodes, and two failures at most
    spec = synthetic.header(keep_failures=kept, episodes=6).spec
    (left,) = missing([spec], tmp_path)
    assert (left.episodes, left.failures_expected) == (1, expected)


class Disk(Listener):
    """Counts the attempts whose files wait for their number."""

    def __init__(self, out: Path) -> None:
        self.out, self.waiting = out, 0

    def ticked(self) -> None:
        folders = [len(list(folder.iterdir())) for folder in self.out.glob(f"*/*/*/{STAGING}")]
        self.waiting = max([self.waiting, *folders])


def test_a_twin_that_is_made_again_leaves_nothing_on_the_disk_of_the_other(tmp_path: Path) -> None:
    specs, workers = [replace(spec, twin="phys_random") for spec in plans(1, 40)], 2
    out, whole = tmp_path / "data", tmp_path / "whole"
    for folder in (out, whole):
        assert complete(collect(specs, Run(folder, workers=workers)))
    shutil.rmtree(out / "clean.twin=phys_random")
    assert complete(collect(specs, Run(out, workers=workers), disk := Disk(out)))
    assert content(out) == content(whole)
    assert 0 < disk.waiting <= LOOKAHEAD * workers


def test_a_refused_run_begins_none_of_its_task_datasets(tmp_path: Path) -> None:
    """Of which the last was collected otherwise."""
    first, second = plans(2, 2)
    assert complete(collect([second], Run(tmp_path, workers=1)))
    before = content(tmp_path)
    with pytest.raises(DatasetMismatch, match="first_seed was 3, now 50"):
        collect([replace(one, first_seed=50) for one in (first, second)], Run(tmp_path, workers=1))
    assert content(tmp_path) == before
    assert complete(collect([first, second], Run(tmp_path, workers=1)))
