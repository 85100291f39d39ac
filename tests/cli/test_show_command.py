"""What `rtphys show` prints of an episode and of a failure."""

import json
from pathlib import Path

import pytest
import synthetic
from collected import collect

from pages import ran
from rtphys.data.dataset import Dataset


@pytest.mark.parametrize("succeeded", [0.12, None])
def test_what_never_was_true_is_not_called_no_longer_true(
    tmp_path: Path, succeeded: float | None
) -> None:
    collect(tmp_path, 9, synthetic.header(keep_failures="all"), attempts=3)
    (failure,) = Dataset(tmp_path).failures()
    path = failure.paths.phys_meta
    meta = json.loads(path.read_text())
    meta["verdict"] |= {"first_success_time": succeeded, "held": False}
    path.write_text(json.dumps(meta))
    words = ["show", str(tmp_path), "--failure", "0"]
    done = ran(words, columns=120)
    shown = " ".join(done.stdout.split())
    assert ("success never" in shown) is (succeeded is None)
    assert ("still true no, 0.5 s after the end" in shown) is (succeeded is not None)


def test_json_stands_alone_on_standard_output(tmp_path: Path) -> None:
    collect(data := tmp_path / "data", 1)
    words = ["show", str(data), "--json", "--out", str(tmp_path / "pictures")]
    done = ran(words)
    assert json.loads(done.stdout)["frames"] > 0
    assert len(done.stderr.splitlines()) == len([*(tmp_path / "pictures").iterdir()]) == 2
