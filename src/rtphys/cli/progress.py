"""Progress of a long command: a bar on a terminal, elsewhere a line every few seconds."""

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import typer

LINE_EVERY = 10.0  # [s] between plain lines

Report = Callable[[int, int, str], None]  # how many are done, of how many, and a few words


@contextmanager
def progress_bar() -> Iterator[Report]:
    """Yields the function that reports progress."""
    if sys.stderr.isatty():
        with _bar() as report:
            yield report
    else:
        yield _lines()


@contextmanager
def _bar() -> Iterator[Report]:
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (TextColumn("{task.description}"), BarColumn(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as shown:
        row = shown.add_task("starting", total=None)

        def report(done: int, total: int, words: str) -> None:
            shown.update(row, completed=done, total=total, description=words)

        yield report


def _lines() -> Report:
    last = time.monotonic()

    def report(done: int, total: int, words: str) -> None:
        nonlocal last
        if time.monotonic() - last >= LINE_EVERY:
            last = time.monotonic()
            typer.echo(f"{done} of {total} done, {words}", err=True)

    return report
