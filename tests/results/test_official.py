"""RoboTwin's result files, as public scripts read them."""

import json
from pathlib import Path

import pytest

from rtphys.results.official import COUNTS, result_folder, write_result


@pytest.mark.parametrize(
    ("protocol", "counts", "name"),
    [
        ("phys_random_all", (50, 57, 41), "_result_random.txt"),
        ("clean", (3, 4, 3), "_result_clean.txt"),
        ("clean", (0, 0, 0), "_result_clean.txt"),
        ("phys_random", (2, None, 1), "_result_random.txt"),  # nobody tried others under it
    ],
)
def test_both_files_give_the_successes_back(
    protocol: str, counts: tuple[int, int | None, int], name: str, tmp_path: Path
) -> None:
    """The last line is successes over episodes; infeasible seeds stand beside it."""
    folder, (rollouts, tried, successes) = result_folder(tmp_path, "t", "idle", protocol), counts
    path = write_result(folder, protocol, "unseen", counts)
    text = path.read_text()
    assert path.name == name and text == (folder / "_result.txt").read_text()
    assert "Instruction Type: unseen" in text
    assert round(float(text.splitlines()[-1]) * rollouts) == successes
    known = json.loads((folder / COUNTS).read_text())
    assert known == {"rollouts": rollouts, "tried": tried, "successes": successes}
