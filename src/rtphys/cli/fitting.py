"""Tables for narrow terminals: long cells wrap, where rich would cut them off with dots."""

import sys
from collections.abc import Sequence

from rich.console import JustifyMethod
from rich.table import Table

from rtphys.cli.screen import Screen


def fitting_table(
    names: Sequence[str],
    columns: Sequence[str],
    title: str | None = None,
    justify: JustifyMethod = "left",
) -> Table:
    """A table whose first columns, `names`, keep their words in one piece.

    Args:
        justify: the side on which `columns` are flush; "right" for plain numbers.
    """
    table = Table(title=title)
    for name in names:
        table.add_column(name, no_wrap=True)
    for column in columns:
        table.add_column(column, justify=justify, overflow="fold")
    return table


def wide_console() -> Screen:
    """For tables on standard output; a file or a pipe has no width of its own."""
    seen = sys.stdout is not None and sys.stdout.isatty()  # None: closed from the beginning
    return Screen() if seen else Screen(width=200)
