"""Few processes draw on a GPU at once, because they take turns on it and each change costs time."""

import fcntl
import os
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import sapien

AT_ONCE = 4  # an H200 drew 1,512 pictures a second for 4 processes, and 1,338 for 16
FLAGS = os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW
PAUSE = 0.01  # [s] between two tries
CPU_DRIVERS = ("llvmpipe", "SwiftShader")  # how the names of their devices begin


@contextmanager
def turn(scene: sapien.Scene) -> Iterator[None]:
    """Waits until few enough processes of this user draw on the scene's GPU; on a CPU, does not.

    The kernel ends the turn of a process that dies.
    """
    device = scene.render_system.device
    if device is None or device.name.startswith(CPU_DRIVERS):
        yield
        return
    name = f"rtphys-{os.getuid()}-{(device.pci_string or 'gpu').replace(':', '-')}"
    with _held(Path(tempfile.gettempdir()) / name):
        yield


@contextmanager
def _held(stem: Path) -> Iterator[None]:
    """One of `AT_ONCE` locks beside `stem`; none where no file can be locked: turns save time."""
    place = _acquired(stem)
    try:
        yield
    finally:
        if place is not None:
            os.close(place)


def _acquired(stem: Path) -> int | None:
    while True:
        for number in range(AT_ONCE):
            try:
                place = os.open(f"{stem}-{number}.lock", FLAGS, 0o600)
            except OSError:
                return None
            try:
                fcntl.flock(place, fcntl.LOCK_EX | fcntl.LOCK_NB)
                return place
            except BlockingIOError:
                os.close(place)
            except OSError:
                os.close(place)
                return None
        time.sleep(PAUSE)
