"""`rtphys physics`: draw values, prove the laws, audit a dataset's labels."""

import json
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

from rtphys.cli.domains import AsJson, domain_named
from rtphys.physics import Physics, Value, attributes, parse_overrides

app = typer.Typer(no_args_is_help=True, help="The physical attributes.")


@app.command()
def sample(
    task: Annotated[str, typer.Option(help="A task, a domain, or a domain file.")],
    seed: Annotated[int, typer.Option(min=0, help="The first episode seed.")] = 0,
    episodes: Annotated[int, typer.Option(min=1, help="How many seeds, upward.")] = 1,
    only: Annotated[str, typer.Option(help="Vary only these (comma-separated).")] = "",
    held: Annotated[list[str] | None, typer.Option("--set", help="key=value, repeatable.")] = None,
    as_json: AsJson = False,
) -> None:
    """The values that an episode draws.

    The centre of mass is as drawn from the domain; an episode redraws it while it lies outside
    one of the task's own bodies.
    """
    domain = domain_named(task)
    wanted = [key for key in only.split(",") if key] or None
    overrides = parse_overrides(held or [])
    drawn = {
        s: domain.sample(s, only=wanted, overrides=overrides) for s in range(seed, seed + episodes)
    }
    if as_json:
        rows = [{"seed": s, "domain": domain.name, **p.to_json()} for s, p in drawn.items()]
        typer.echo(json.dumps(rows, ensure_ascii=False))
    else:
        Console().print(_table(domain.name, drawn))


def _table(name: str, drawn: dict[int, Physics]) -> Table:
    known = attributes()
    keys = [*known, "camera_mode", "camera_direction"]
    table = Table("attribute", "unit", title=f"domain {name}")
    for seed in drawn:
        table.add_column(f"seed {seed}", justify="right")
    for key in keys:
        cells = [_cell(physics[key], key in physics.varied) for physics in drawn.values()]
        table.add_row(key, known[key].unit if key in known else "", *cells)
    return table


def _cell(value: Value, varied: bool) -> str:
    if value is None:
        return "-"
    if isinstance(value, tuple):
        text = " ".join(f"{x:+.4f}" for x in value)
    else:
        text = value if isinstance(value, str) else f"{value:.4g}"
    return text if varied or isinstance(value, str) else f"({text})"
