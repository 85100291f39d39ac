"""How a running collection looks: a live table on a terminal, plain lines elsewhere."""

import time
from collections import Counter
from collections.abc import Sequence

import typer
from rich.console import Console, Group
from rich.live import Live as RichLive
from rich.progress_bar import ProgressBar
from rich.table import Table
from rich.text import Text

from rtphys.cli.fitting import fitting_table
from rtphys.studies.collect import Listener, Tally

LINE_EVERY = 10.0  # [s] between plain lines
REFRESH = 0.5  # [s] between redraws
MOST_REASONS = 4


class _Clock(Listener):
    """Remembers when the work began; rates leave out what was there before."""

    def __init__(self) -> None:
        self.tallies: list[Tally] = []
        self.began = self._shown = time.monotonic()

    def started(self, tallies: list[Tally]) -> None:
        self.tallies = tallies
        self.began = self._shown = time.monotonic()

    def due(self, every: float) -> bool:
        if time.monotonic() - self._shown < every:
            return False
        self._shown = time.monotonic()
        return True

    @property
    def per_minute(self) -> float:
        minutes = (time.monotonic() - self.began) / 60
        return sum(tally.new_episodes for tally in self.tallies) / minutes if minutes else 0.0

    @property
    def time_left(self) -> str:
        missing = sum(t.wanted - t.episodes for t in self.tallies if not t.stopped)
        if not self.per_minute:
            return "?"
        minutes, seconds = divmod(round(60 * max(missing, 0) / self.per_minute), 60)
        hours, minutes = divmod(minutes, 60)
        return f"{hours}:{minutes:02d}:{seconds:02d}"


class Lines(_Clock):
    """For logs: one line when something begins, every ten seconds, and at the end."""

    def __enter__(self) -> "Lines":
        return self

    def __exit__(self, *_: object) -> None:
        if self.tallies:
            self._say()

    def building(self, done: int, total: int, name: str) -> None:
        if done == total or self.due(LINE_EVERY):
            typer.echo(f"building assets: {done} of {total}, {name}", err=True)

    def started(self, tallies: list[Tally]) -> None:
        super().started(tallies)
        for tally in tallies:
            found = f", {tally.found_episodes} there already" if tally.found_attempts else ""
            typer.echo(f"{tally.task}: {tally.wanted} episodes wanted{found}", err=True)

    def ticked(self) -> None:
        if self.due(LINE_EVERY):
            self._say()

    def noticed(self, text: str) -> None:
        typer.echo(text, err=True)

    def _say(self) -> None:
        done, wanted, attempts = totals(self.tallies)
        rejected = sum((tally.rejections for tally in self.tallies), Counter())
        why = f" ({reasons(rejected)})" if rejected else ""
        typer.echo(
            f"{done} of {wanted} episodes, {attempts} attempts, {rejected.total()} rejected{why}, "
            f"{self.per_minute:.1f} episodes/min, {self.time_left} left",
            err=True,
        )


class Live(_Clock):
    """For people: a table that follows what happens."""

    def __init__(self) -> None:
        super().__init__()
        self._console = Console(stderr=True)
        self._live = RichLive(console=self._console, auto_refresh=False, transient=True)

    def __enter__(self) -> "Live":
        self._live.start()
        self._live.update(Text("checking"), refresh=True)
        return self

    def __exit__(self, *_: object) -> None:
        self._live.stop()

    def building(self, done: int, total: int, name: str) -> None:
        bar = ProgressBar(total=total, completed=done, width=40)
        self._live.update(Group(Text(f"building assets, once: {name}"), bar), refresh=True)

    def started(self, tallies: list[Tally]) -> None:
        super().started(tallies)
        self._draw()

    def ticked(self) -> None:
        if self.due(REFRESH):
            self._draw()

    def noticed(self, text: str) -> None:
        self._console.print(text, style="yellow")

    def _draw(self) -> None:
        done, wanted, attempts = totals(self.tallies)
        bar = ProgressBar(total=wanted, completed=done, width=40)
        told = (
            f"{done} of {wanted} episodes, {attempts} attempts, "
            f"{self.per_minute:.1f} episodes/min, {self.time_left} left"
        )
        self._live.update(Group(summary_table(self.tallies), bar, Text(told)), refresh=True)


def totals(tallies: Sequence[Tally]) -> tuple[int, int, int]:
    """Episodes there, episodes wanted, attempts of this run."""
    done = sum(min(tally.episodes, tally.wanted) for tally in tallies)
    return done, sum(tally.wanted for tally in tallies), sum(t.new_attempts for t in tallies)


def summary_table(tallies: Sequence[Tally]) -> Table:
    """One row a task."""
    columns = ("episodes", "attempts", "accepted", "rejected, by reason")
    table = fitting_table(["task"], columns)
    for tally in tallies:
        tried = tally.new_attempts
        share = f"{100 * tally.new_episodes / tried:.0f} %" if tried else "-"
        episodes = f"{tally.episodes} / {tally.wanted}"
        table.add_row(tally.task, episodes, str(tried), share, reasons(tally.rejections))
    return table


def reasons(rejections: Counter[str]) -> str:
    """`"unreachable 4, slipped 2"`, the most frequent first."""
    told = [f"{reason} {count}" for reason, count in rejections.most_common(MOST_REASONS)]
    rest = rejections.total() - sum(count for _, count in rejections.most_common(MOST_REASONS))
    return ", ".join([*told, f"other {rest}"] if rest else told)
