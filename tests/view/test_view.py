"""What `rtphys view` writes of synthetic episodes."""

import re
import subprocess
import sys
from pathlib import Path

import pytest
from collected import collect

pytest.importorskip("rerun", reason="the extra rtphys[view] is not installed")

from rtphys.data.dataset import Dataset
from rtphys.view import record

RERUN = Path(sys.executable).with_name("rerun")


def test_a_viewer_tells_recordings_apart(tmp_path: Path) -> None:
    """Of two datasets that have an episode of one name: it joins recordings of one id."""
    collect(tmp_path / "data", 1)
    found = set[str]()
    for name in ("one", "other"):
        record(Dataset(tmp_path / "data")[0], [], out := tmp_path / f"{name}.rrd")
        printed = subprocess.run(
            [RERUN, "rrd", "print", out], capture_output=True, text=True
        ).stdout
        found |= set(re.findall(r'Recording,\s+"rtphys",\s+"([^"]+)"', printed))
        assert "RecordingInfo:name" in printed
    assert len(found) == 2
