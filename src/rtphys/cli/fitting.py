"""Tables for any width: long cells wrap, where rich would cut them off with dots."""

import sys
from collections.abc import Sequence

from rich.console import JustifyMethod
from rich.table import Table

from rtphys.cli.screen import Screen

ONE_LINE = 10_000  # [characters] wide enough for a row of any table here
NARROWEST = 8  # [characters] of a column that wraps, before names wrap too


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
    table = Table(title=title, box=None, pad_edge=False, padding=(0, 2, 0, 0), title_justify="left")
    for name in names:
        table.add_column(name, no_wrap=True)
    for column in columns:
        table.add_column(column, justify=justify, overflow="fold")
    return table


def print_table(table: Table) -> None:
    """Prints to standard output: within a terminal's width, and one line a row in a pipe."""
    if sys.stdout is None or not sys.stdout.isatty():  # None: closed from the beginning
        Screen(width=ONE_LINE).print(table, no_wrap=True, crop=False, overflow="ignore")
        return
    screen = Screen()
    print_within(screen, table)


def print_within(screen: Screen, table: Table) -> None:
    """Prints a table in a screen's width. Where the names alone would fill it, they wrap too."""
    kept = [column for column in table.columns if column.no_wrap]
    widths = [max(len(str(cell)) for cell in (c.header, *c.cells)) + 2 for c in kept]
    if sum(widths) + NARROWEST * (len(table.columns) - len(kept)) > screen.width:
        for column in kept:
            column.no_wrap, column.overflow = False, "fold"
    screen.print(table)
