"""`rtphys protocols`: one row for each protocol, with what may differ between its episodes."""

import json
from typing import Annotated

import typer

from rtphys.cli.fitting import fitting_table, print_table
from rtphys.setting.protocol import Protocol, VisualRules
from rtphys.setting.protocol import protocols as known


def protocols(
    as_json: Annotated[bool, typer.Option("--json", help="Plain JSON instead of a table.")] = False,
) -> None:
    """What may differ between episodes, beside the layout. Libraries may add rows of their own."""
    rows = known().values()
    if as_json:
        typer.echo(json.dumps([_plain(row) for row in rows], indent=2))
        return
    table = fitting_table(["protocol"], ("physics", "look", "what"))
    for row in rows:
        physics = "the task's domain" if row.physics else "nominal"
        table.add_row(row.name, physics, _look(row.visual), row.what)
    print_table(table)


def _plain(row: Protocol) -> dict[str, object]:
    visual = row.visual.to_json() if row.visual else None
    return {"name": row.name, "physics": row.physics, "visual": visual, "what": row.what}


def _look(rules: VisualRules | None) -> str:
    varied = rules.to_json() if rules else {}
    rules_text = [
        key if value is True else f"{key} {value:g}" for key, value in varied.items() if value
    ]
    return ", ".join(rules_text).replace("_", " ") or "as in clean"
