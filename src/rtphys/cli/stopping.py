"""How long commands end before they are done: given up, Ctrl-C, or a polite kill."""

import shlex
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

from rtphys.core.errors import RtphysError


class Incomplete(RtphysError):
    """Tasks were given up before they had what was asked for."""

    exit_code = 4


class Interrupted(RtphysError):
    """Ctrl-C or a polite kill."""

    exit_code = 130


@contextmanager
def resumable() -> Iterator[None]:
    """Within: what stops the command says that the same command goes on.

    Raises:
        Interrupted: by Ctrl-C or SIGTERM.
    """
    signal.signal(signal.SIGTERM, _as_interrupt)
    try:
        yield
    except KeyboardInterrupt:
        same = shlex.join(["rtphys", *sys.argv[1:]])
        told = f"stopped; what is there is whole. To go on, repeat: {same}"
        raise Interrupted(told) from None


def _as_interrupt(_: int, __: FrameType | None) -> None:
    raise KeyboardInterrupt
