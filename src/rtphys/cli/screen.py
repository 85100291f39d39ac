"""Tables, bars and the display of a running campaign, on a terminal of any width or in a log."""

import sys
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import Self

from rich.cells import cell_len
from rich.console import (
    Console,
    ConsoleOptions,
    Group,
    HighlighterType,
    JustifyMethod,
    OverflowMethod,
)
from rich.console import RenderableType as Drawn
from rich.live import Live as RichLive
from rich.padding import Padding
from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeRemainingColumn
from rich.progress import Progress as ProgressBars
from rich.progress_bar import ProgressBar
from rich.segment import Segment
from rich.style import Style
from rich.table import Column, Table
from rich.text import Text

from rtphys.assets.pack import Pack, default_pack
from rtphys.campaign.series import Listener, Progress
from rtphys.cli.terminal import printable, resumable, say, say_json
from rtphys.core.errors import counted

ONE_LINE = 10_000  # [characters] wide enough for a row of any table here
GAP = 2  # [characters] between two columns
NARROWEST = 8  # [characters] of a column that breaks words
UNBROKEN = 16  # [characters] of a word that stays whole, if need be at the cost of the names


class Screen(Console):
    """Shows every text as it is: without markup, emoji codes and control characters of its own."""

    def __init__(self, *, stderr: bool = False, width: int | None = None) -> None:
        super().__init__(stderr=stderr, width=width, markup=False, emoji=False, highlight=False)

    def render_str(
        self,
        text: str,
        *,
        style: str | Style = "",
        justify: JustifyMethod | None = None,
        overflow: OverflowMethod | None = None,
        emoji: bool | None = None,
        markup: bool | None = None,
        highlight: bool | None = None,
        highlighter: HighlighterType | None = None,
    ) -> Text:
        """Spelled before a column's width follows from it; markup is not read, even on request."""
        return Text(printable(text), style, justify=justify, overflow=overflow)

    def render(self, renderable: Drawn, options: ConsoleOptions | None = None) -> Iterable[Segment]:
        """Here all that is drawn comes by, whatever it was before."""
        for text, style, control in super().render(renderable, options):
            yield Segment(text if control else printable(text), style, control)


def fitting_table(
    names: Sequence[str],
    columns: Sequence[str],
    title: str | None = None,
    justify: JustifyMethod = "left",
) -> Table:
    """A table whose first columns, `names`, keep their words in one piece where they can.

    Args:
        justify: the side on which `columns` are flush; "right" for plain numbers.
    """
    table = Table(
        title=title,
        box=None,
        pad_edge=False,
        padding=(0, GAP, 0, 0),
        title_justify="left",
        caption_justify="left",
    )
    for name in names:
        table.add_column(name, no_wrap=True)
    for column in columns:
        table.add_column(column, justify=justify, overflow="fold")
    return table


def print_table(table: Table) -> None:
    """Prints to standard output: within a terminal's width, and one line a row in a pipe."""
    if sys.stdout is not None and sys.stdout.isatty():  # None: closed from the beginning
        print_within(Screen(), table)
    else:
        Screen(width=ONE_LINE).print(table, no_wrap=True, crop=False, overflow="ignore")


def print_parts(table: Table) -> None:
    """Prints a table of which no cell wraps: columns without room follow beside the names again."""
    kept = [column for column in table.columns if column.no_wrap]
    others = [column for column in table.columns if not column.no_wrap]
    seen = sys.stdout is not None and sys.stdout.isatty()
    width = Screen().width if seen else ONE_LINE
    space = width - sum(_widest(column, str.splitlines) + GAP for column in kept)
    parts, room = list[list[Column]](), 0
    for column in others:
        wide = _widest(column, str.splitlines) + GAP
        if wide > room + GAP:
            parts.append([])
            room = space
        parts[-1].append(column)
        room -= wide
    for number, part in enumerate(parts):
        heads = ([str(column.header) for column in columns] for columns in (kept, part))
        title = None if number else str(table.title)
        shown = fitting_table(*heads, title=title, justify=part[0].justify)
        for row in zip(*(column.cells for column in [*kept, *part]), strict=True):
            shown.add_row(*row)
        print_table(shown)


def print_rows(table: Table, rows: object, as_json: bool) -> None:
    """Prints a table, or its rows for programs."""
    if as_json:
        say_json(rows)
    else:
        print_table(table)


def print_within(screen: Screen, table: Table) -> None:
    """Prints a table in a screen's width: words stay whole as long as they can."""
    columns = table.columns
    widths = [_widest(column, str.splitlines) for column in columns]
    cells = [_widest(column, str.splitlines, head=False) for column in columns]
    words = [_widest(column, str.split) for column in columns]
    heads = [*map(max, words, cells)]
    short, shorter = ([min(word, most) for word in words] for most in (UNBROKEN, NARROWEST))
    named = [
        word if column.no_wrap else least
        for column, word, least in zip(columns, words, short, strict=True)
    ]
    room = screen.width - GAP * (len(columns) - 1)
    for floor in (heads, words, named, short, shorter):  # heads wrap first, names break last
        while sum(widths) > room and (wide := [i for i, w in enumerate(widths) if w > floor[i]]):
            widths[max(wide, key=widths.__getitem__)] -= 1
    for column, column.width in zip(columns, widths, strict=True):
        column.no_wrap, column.overflow = False, "fold"
    screen.print(table)


def _widest(column: Column, parts: Callable[[str], list[str]], head: bool = True) -> int:
    texts = map(str, [*([column.header] if head else []), *column.cells])
    return max((cell_len(part) for text in texts for part in parts(text)), default=0)


@contextmanager
def progress_bar(verb: str) -> Iterator[Callable[..., None]]:
    """A bar on standard error, from the first call on; it is called with what is done, with all,
    and perhaps a name."""
    columns = (TextColumn(verb), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    name_column, screen = TextColumn("{task.description}"), Screen(stderr=True)
    bars = ProgressBars(*columns, name_column, console=screen, transient=True)
    bars.disable = not screen.is_terminal  # rich would write an empty line into a log
    with bars as shown:
        row = shown.add_task("", total=None, visible=False)  # perhaps there is nothing to do

        def tell(done: int, total: int, name: str = "") -> None:
            shown.update(row, completed=done, total=total, description=name, visible=True)

        yield tell


def pack_in_use() -> Pack:
    """The default asset pack, built if need be."""
    with progress_bar("building assets") as bar:
        return default_pack(bar)


LINE_EVERY = 10.0  # [s] between plain lines
REFRESH = 0.5  # [s] between redraws
MAX_ROWS = 12  # series that are shown in a table of their own
MAX_REASONS = 4


def campaign_progress(noun: str) -> "Live | Lines":
    """The listener that fits where standard error goes. `noun`: what is counted, in the plural."""
    seen = sys.stderr is not None and sys.stderr.isatty()  # None: closed from the beginning
    return Live(noun) if seen else Lines(noun)


@contextmanager
def campaign(noun: str) -> Iterator[tuple[Pack, Listener]]:
    """The default asset pack, built if need be, and who hears what becomes of a campaign."""
    with resumable(), campaign_progress(noun) as listener:
        yield default_pack(listener.building), listener


class _Counts(Listener):
    """Counts since the work began; rates leave out what was there before, `solved` does not."""

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

    def sentence(self, at_work: bool = False) -> str:
        """What is there. `at_work`: although nothing is missing, as where baselines are run."""
        done, wanted = self.totals()
        rejected = sum((progress.rejections for progress in self.progresses), Counter[str]())
        why = f", {rejected.total()} rejected ({reasons(rejected)})" if rejected else ""
        solved = [progress.solved for progress in self.progresses if progress.solved is not None]
        attempts = sum(progress.new_attempts for progress in self.progresses)
        tried = f"{sum(solved)} solved" if solved else counted(attempts, "attempts")
        by = next((f"{progress.by}: " for progress in self.progresses if progress.by), "")
        if not attempts and done >= wanted > 0:
            was = f"{tried}, " if solved else ""
            more = ", now measured further" if at_work else ""
            return f"{by}{done} of {wanted} {self.noun}, {was}all there already{more}"
        minutes = (time.monotonic() - self.began) / 60
        new = sum(progress.new_accepted for progress in self.progresses)
        rate, left = new / minutes if minutes else 0.0, "?"
        if rate:
            missing = sum(t.wanted - t.accepted for t in self.progresses if not t.stopped)
            seconds = round(60 * max(missing, 0) / rate)
            left = f"{seconds // 3600}:{seconds // 60 % 60:02d}:{seconds % 60:02d}"
        return (
            f"{by}{done} of {wanted} {self.noun}, {tried}{why}, {rate:.1f} {self.noun}/min, "
            f"{left} left"
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
            say(self.sentence(at_work=True), err=True)

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
            self._draw(at_work=True)

    def noticed(self, text: str) -> None:
        self._console.print(text, style="yellow")

    def _draw(self, at_work: bool = False) -> None:
        done, wanted = self.totals()
        few = 0 < len(self.progresses) <= MAX_ROWS
        table = [summary_table(self.progresses, self.noun)] if few else []
        # Padded, because a bar alone does not end its line.
        bar = Padding(ProgressBar(total=wanted, completed=done, width=40), 0)
        self._live.update(Group(*table, bar, Text(self.sentence(at_work))), refresh=True)


def summary_table(progresses: Sequence[Progress], noun: str = "episodes") -> Table:
    """One row a series."""
    judged = any(progress.solved is not None for progress in progresses)
    # Where a failure counts as well, nearly all are accepted, which tells nothing.
    heads = ("solved",) if judged else ("accepted", "rejected, by reason")
    table = fitting_table(["task"], (noun, "attempts", *heads))
    for progress in progresses:
        tried = progress.accepted if judged else progress.new_attempts
        good = (progress.solved or 0) if judged else progress.new_accepted
        share = f"{100 * good / tried:.0f} %" if tried else "-"
        counts = f"{progress.accepted} / {progress.wanted}"
        why = () if judged else (reasons(progress.rejections),)
        table.add_row(progress.name, counts, str(tried), share, *why)
    return table


def reasons(rejections: Counter[str]) -> str:
    """`"unreachable 4, slipped 2"`, the most frequent first."""
    most = rejections.most_common(MAX_REASONS)
    words = [f"{reason} {count}" for reason, count in most]
    rest = rejections.total() - sum(count for _, count in most)
    return ", ".join([*words, f"other {rest}"] if rest else words)
