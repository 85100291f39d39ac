"""Turns on a GPU, with processes in the place of ones that draw."""

import errno
import subprocess
import sys
import threading
from pathlib import Path
from types import SimpleNamespace
from typing import cast

import pytest
import sapien

from rtphys.sim import turns

pytestmark = pytest.mark.sim
HOLDER = """import sys, time
from pathlib import Path
from rtphys.sim import turns
with turns._held(Path(sys.argv[1])):
    print("in", flush=True)
    time.sleep(60)
"""


def scene(name: str) -> sapien.Scene:
    device = SimpleNamespace(name=name, pci_string="0000:01:00.0")
    return cast(sapien.Scene, SimpleNamespace(render_system=SimpleNamespace(device=device)))


def test_a_turn_begins_when_one_of_the_others_ends(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(turns.tempfile, "gettempdir", lambda: str(tmp_path))
    monkeypatch.setattr(turns, "AT_ONCE", 1)
    begun = threading.Event()

    def draw() -> None:
        with turns.turn(scene("NVIDIA H200")):
            begun.set()

    with turns.turn(scene("NVIDIA H200")):
        other = threading.Thread(target=draw)
        other.start()
        assert not begun.wait(0.2)
        with turns.turn(scene("llvmpipe (LLVM 15.0.6, 256 bits)")):
            pass  # nobody waits for a CPU
    assert begun.wait(5)
    other.join()


def test_the_turn_of_a_process_that_is_killed_ends(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(turns, "AT_ONCE", 1)
    line = [sys.executable, "-c", HOLDER.replace("with", "turns.AT_ONCE = 1\nwith", 1)]
    with subprocess.Popen([*line, str(tmp_path / "gpu")], stdout=subprocess.PIPE) as holder:
        assert holder.stdout is not None and holder.stdout.readline() == b"in\n"
        holder.kill()
    with turns._held(tmp_path / "gpu"):
        pass


@pytest.mark.parametrize("call", ["fcntl.flock", "os.open"])
def test_where_no_file_can_be_locked_nobody_waits(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, call: str
) -> None:
    def fail(*_: object) -> None:
        raise OSError(errno.ENOLCK, "No locks available")

    monkeypatch.setattr(call, fail)
    with pytest.raises(ValueError, match="of who draws"), turns._held(tmp_path / "gpu"):
        raise ValueError("of who draws")
