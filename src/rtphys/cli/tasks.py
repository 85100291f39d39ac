"""`rtphys tasks`: the tasks, their objects, and how often the expert succeeds."""

import json
import sys
from typing import Annotated

import typer

from rtphys.cli.fitting import fitting_table, print_table
from rtphys.cli.screen import Screen
from rtphys.core import library
from rtphys.core.errors import RtphysError
from rtphys.task.props import Articulated, Mesh, Prop
from rtphys.task.rates import rates
from rtphys.task.spec import Task, load_task

PROTOCOLS = ("clean", "phys_random")
WIDE = 120  # [characters] a row with all columns fits
COLUMNS = {
    "task": "task",
    "arms": "arms",
    "mechanism": "mechanism",
    "objects": "objects",
    "step_limit": "steps",
    "domain": "domain",
    **{name: name for name in PROTOCOLS},
}  # key of a row -> its heading


def tasks(
    pattern: Annotated[str, typer.Argument(help="Only names that match, such as 'stack_*'.")] = "*",
    as_json: Annotated[bool, typer.Option("--json", help="Plain JSON, one row a task.")] = False,
) -> None:
    """List the tasks: arms, mechanism, objects, step limit, domain, measured rates.

    The rates are those of the expert in the certified lists.

    Examples:

        rtphys tasks
        rtphys tasks 'place_*' --json
    """
    from rtphys.cli.options import expand

    rows = [_row(name) for name in expand([pattern])]
    if as_json:
        typer.echo(json.dumps(rows, indent=2))
        return
    # A pipe has room for all; a terminal for what fits, and --json has the rest.
    terminal = sys.stdout is not None and sys.stdout.isatty()
    narrow = terminal and Screen().width < WIDE
    shown = [key for key in COLUMNS if not (narrow and key in ("objects", "domain"))]
    table = fitting_table(["task"], [COLUMNS[key] for key in shown[1:]])
    for row in rows:
        table.add_row(*(_cell(row, key, short=terminal) for key in shown))
    if terminal:
        table.caption = "--json also has " + ("objects, domain and " if narrow else "") + "counts"
    print_table(table)


def _cell(row: dict[str, object], key: str, *, short: bool) -> str:
    """A value of a row; `short` leaves out of how many a rate is."""
    text = str(row.get(key, ""))
    return text.partition(" of ")[0] if short and key in PROTOCOLS else text


def _row(name: str) -> dict[str, object]:
    measured = {key: str(rate) for key, rate in rates().get(name, {}).items()}
    try:
        task = load_task(name)
    except RtphysError as problem:  # one broken file must not hide the others
        return {"task": name, "mechanism": f"broken: {problem}"}
    return {
        "task": name,
        "arms": task.arms,
        "mechanism": task.mechanism,
        "objects": ", ".join(_objects(task)),
        "step_limit": task.step_limit,
        "domain": name if name in library.names("domains") else "global",
        **measured,
    }


def _objects(task: Task) -> list[str]:
    """What one layout puts on the table."""
    return list(dict.fromkeys(_kind(prop) for prop in task.props(0)))


def _kind(prop: Prop) -> str:
    return prop.category if isinstance(prop, Mesh | Articulated) else prop.phrase or prop.name
