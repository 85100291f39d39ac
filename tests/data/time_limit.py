"""A time limit for a block of a test, that no reader of files can swallow."""

import signal
from collections.abc import Iterator
from contextlib import contextmanager


class Hang(BaseException):
    """No `Exception`, which a reader might catch, nor the `OSError` that `TimeoutError` is."""


@contextmanager
def at_most(seconds: int) -> Iterator[None]:
    """Raise `Hang` in the block where it takes longer; for the main thread alone."""

    def stop(*_: object) -> None:
        raise Hang(f"no answer after {seconds} s")

    before = signal.signal(signal.SIGALRM, stop)
    signal.alarm(seconds)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)
