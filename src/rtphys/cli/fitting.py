"""Tables for a terminal of any width: a cell wraps where there is no room; nothing is cut off."""

import sys
from collections.abc import Sequence

from rich.console import Console
from rich.table import Table


def fitting_table(names: Sequence[str], columns: Sequence[str], title: str | None = None) -> Table:
    """A table whose first columns, `names`, keep their words in one piece."""
    table = Table(title=title)
    for name in names:
        table.add_column(name, no_wrap=True)
    for column in columns:
        table.add_column(column, overflow="fold")  # rich would end a long word with dots
    return table


def wide_console() -> Console:
    """For tables on standard output; a file or a pipe has no width of its own."""
    return Console() if sys.stdout.isatty() else Console(width=200)
