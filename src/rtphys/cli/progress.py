"""How a running campaign looks: a live display on a terminal, plain lines elsewhere."""

import sys
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Self

from rich.console import Group
from rich.live import Live as RichLive
from rich.padding import Padding
from rich.progress_bar import ProgressBar
from rich.table import Table
from rich.text import Text

from rtphys.campaign.series import Listener, Progress
from rtphys.cli.tables import Screen, fitting_table
from rtphys.cli.terminal import resumable, say
from rtphys.core.errors import counted

if TYPE_CHECKING:
    from rtphys.assets.pack import Pack

LINE_EVERY = 10.0  # [s] between plain lines
REFRESH = 0.5  # [s] between redraws
MAX_ROWS = 12  # series that are shown in a table of their own
MAX_REASONS = 4


def campaign_progress(noun: str) -> "Live | Lines":
    """The listener that fits where standard error goes. `noun`: what is counted, in the plural."""
    seen = sys.stderr is not None and sys.stderr.isatty()  # None: closed from the beginning
    return Live(noun) if seen else Lines(noun)


@contextmanager
def campaign(noun: str) -> "Iterator[tuple[Pack, Listener]]":
    """The default asset pack, built if need be, and who hears what becomes of a campaign."""
    from rtphys.assets.pack import default_pack

    with resumable(), campaign_progress(noun) as listener:
        yield default_pack(listener.building), listener


class _Counts(Listener):
    """Counts since the work began; rates leave out what was there before."""

    def __init__(self, noun: str) -> None:
        self.noun = noun
        self.progresses: Sequence[Progress] = []
        self.began = self._shown = time.monotonic()

    def started(self, progresses: Sequence[Progress]) -> None:
        self.progresses = progresses
        self.began = self._shown = time.monotonic()

    def due(self, every: float) -> bool:
        if time.monotonic() - self._shown < every:
            return False
        self._shown = time.monotonic()
        return True

    def totals(self) -> tuple[int, int]:
        """Results there and results wanted; more than was asked for counts as what was."""
        done = sum(min(progress.accepted, progress.wanted) for progress in self.progresses)
        return done, sum(progress.wanted for progress in self.progresses)

    def sentence(self) -> str:
        done, wanted = self.totals()
        rejected = sum((progress.rejections for progress in self.progresses), Counter[str]())
        why = f", {rejected.total()} rejected ({reasons(rejected)})" if rejected else ""
        solved = [progress.solved for progress in self.progresses if progress.solved is not None]
        attempts = sum(progress.new_attempts for progress in self.progresses)
        tried = f"{sum(solved)} solved" if solved else counted(attempts, "attempts")
        minutes = (time.monotonic() - self.began) / 60
        new = sum(progress.new_accepted for progress in self.progresses)
        rate, left = new / minutes if minutes else 0.0, "?"
        if rate:
            missing = sum(t.wanted - t.accepted for t in self.progresses if not t.stopped)
            seconds = round(60 * max(missing, 0) / rate)
            left = f"{seconds // 3600}:{seconds // 60 % 60:02d}:{seconds % 60:02d}"
        return (
            f"{done} of {wanted} {self.noun}, {tried}{why}, {rate:.1f} {self.noun}/min, {left} left"
        )


class Lines(_Counts):
    """For logs: one line when something begins, every ten seconds, and at the end."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        if self.progresses:
            say(self.sentence(), err=True)

    def building(self, done: int, total: int, name: str) -> None:
        if done == total or self.due(LINE_EVERY):
            say(f"building assets: {done} of {total}, {name}", err=True)

    def started(self, progresses: Sequence[Progress]) -> None:
        super().started(progresses)
        for one in progresses if len(progresses) <= MAX_ROWS else ():
            if one.wanted:
                there = f", {one.accepted} there already" if one.attempts else ""
                say(f"{one.name}: {counted(one.wanted, self.noun)} wanted{there}", err=True)

    def ticked(self) -> None:
        if self.due(LINE_EVERY):
            say(self.sentence(), err=True)

    def noticed(self, text: str) -> None:
        say(text, err=True)


class Live(_Counts):
    """For people: a table that follows what happens, or a bar alone where there are many series."""

    def __init__(self, noun: str) -> None:
        super().__init__(noun)
        self._console = Screen(stderr=True)
        self._live = RichLive(console=self._console, auto_refresh=False, transient=True)

    def __enter__(self) -> Self:
        self._live.start()
        self._live.update(Text("checking"), refresh=True)
        return self

    def __exit__(self, *_: object) -> None:
        self._live.stop()

    def building(self, done: int, total: int, name: str) -> None:
        bar = ProgressBar(total=total, completed=done, width=40)
        self._live.update(Group(Text(f"building assets, once: {name}"), bar), refresh=True)

    def started(self, progresses: Sequence[Progress]) -> None:
        super().started(progresses)
        self._draw()

    def ticked(self) -> None:
        if self.due(REFRESH):
            self._draw()

    def noticed(self, text: str) -> None:
        self._console.print(text, style="yellow")

    def _draw(self) -> None:
        done, wanted = self.totals()
        few = 0 < len(self.progresses) <= MAX_ROWS
        table = [summary_table(self.progresses, self.noun)] if few else []
        # Padded, because a bar alone does not end its line.
        bar = Padding(ProgressBar(total=wanted, completed=done, width=40), 0)
        self._live.update(Group(*table, bar, Text(self.sentence())), refresh=True)


def summary_table(progresses: Sequence[Progress], noun: str = "episodes") -> Table:
    """One row a series."""
    judged = any(progress.solved is not None for progress in progresses)
    # Where a failure counts as well, nearly all are accepted, which tells nothing.
    columns = (noun, "attempts", "solved" if judged else "accepted", "rejected, by reason")
    table = fitting_table(["task"], columns)
    for progress in progresses:
        tried = progress.new_attempts
        good = (progress.solved or 0) if judged else progress.new_accepted
        share = f"{100 * good / tried:.0f} %" if tried else "-"
        counts = f"{progress.accepted} / {progress.wanted}"
        table.add_row(progress.name, counts, str(tried), share, reasons(progress.rejections))
    return table


def reasons(rejections: Counter[str]) -> str:
    """`"unreachable 4, slipped 2"`, the most frequent first."""
    most = rejections.most_common(MAX_REASONS)
    words = [f"{reason} {count}" for reason, count in most]
    rest = rejections.total() - sum(count for _, count in most)
    return ", ".join([*words, f"other {rest}"] if rest else words)
