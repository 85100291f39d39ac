"""Peak memory of an export does not follow the number of episodes."""

import re
import subprocess
import sys
from pathlib import Path

import pytest
import sensing

from rtphys.data.dataset import Dataset

pytest.importorskip("pyarrow", reason="the extra rtphys[lerobot] is not installed")

from rtphys.export import lerobot

SENSES = ("depth", "touch")
FEATURES = ("physics", "contact", "touch", "depth")
FEW, MANY, FRAMES = 4, 12, 80
GROWTH = 25.0  # [MB] in 8 more episodes; each has 6 MB of pictures and depths


def main(dataset: str, out: str) -> None:
    """Export, and print the peak memory of this process [kB].

    Files of v3.0 end at a size that no test reaches; until then a video grows in memory.
    """
    lerobot.VIDEO_MB = lerobot.DATA_MB = 1
    lerobot.export_lerobot(Dataset(dataset), Path(out), lerobot.ExportSpec(features=FEATURES))
    # Not `ru_maxrss`, which a child has from its parent.
    status = Path("/proc/self/status").read_text()
    print(re.findall(r"VmHWM:\s+(\d+) kB", status)[0])


@pytest.mark.slow
def test_memory_does_not_follow_the_number_of_episodes(tmp_path: Path) -> None:
    """With depth and touch, which take the most."""
    peaks: list[float] = []
    for episodes in (FEW, MANY):
        data, out = tmp_path / str(episodes), tmp_path / f"out{episodes}"
        sensing.collect(data, episodes, FRAMES, SENSES)
        code = f"import sys; sys.path[:0] = {sys.path!r}; import rtphys, test_export_memory as test"
        call = f"test.main({str(data)!r}, {str(out)!r})"
        run = [sys.executable, "-c", f"{code}; {call}"]
        done = subprocess.run(run, check=True, capture_output=True, text=True)
        peaks.append(int(done.stdout) / 1024)
    few, many = peaks
    assert many - few < GROWTH, f"{few:.0f} MB for {FEW} episodes, {many:.0f} for {MANY}"
