"""`rtphys domains`: what may vary for a task, where each rule comes from, and one's own file."""

import json
from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table

from rtphys.cli.screen import Screen
from rtphys.cli.terminal import say
from rtphys.core import library
from rtphys.core.errors import UnknownName
from rtphys.physics import Domain, attributes, domain_for_task, load_domain
from rtphys.physics.auxiliary import AUXILIARY

app = typer.Typer(no_args_is_help=True, help="Ranges of the physical attributes.")

AsJson = Annotated[bool, typer.Option("--json", help="Plain JSON instead of a table.")]


@app.command()
def show(
    task: Annotated[str, typer.Argument(help="A task, a domain, or a domain file.")],
    as_json: AsJson = False,
) -> None:
    """The resolved ranges of a task, by attribute, and the file that each comes from."""
    domain = domain_named(task)
    if as_json:
        typer.echo(json.dumps(domain.to_json(), indent=2, ensure_ascii=False))
    else:
        Screen().print(_table(domain))


@app.command()
def check(file: Annotated[Path, typer.Argument(help="A domain file (YAML).")]) -> None:
    """Read a domain file, or say what is wrong with it."""
    domain = load_domain(file)
    Screen().print(_table(domain))
    own = [key for key, source in domain.sources.items() if source == file.stem]
    say(f"{file}: good; it sets {', '.join(own) or 'nothing'}. digest {domain.digest[:12]}")


@app.command("list")
def list_() -> None:
    """Names of all domains."""
    for name in library.names("domains"):
        say(name)


def domain_named(name: str) -> Domain:
    """The domain of a task, a domain by its own name, or a domain file.

    Raises:
        UnknownName: neither a task nor a domain; names the nearest match.
    """
    domains, tasks = library.names("domains"), library.names("tasks")
    if name in domains or name.endswith((".yaml", ".yml")):
        return load_domain(name)
    if name not in tasks:
        raise UnknownName("task or domain", name, {*tasks, *domains})
    return domain_for_task(name)


def _table(domain: Domain) -> Table:
    known = attributes()
    table = Table(title=f"domain {domain.name}", box=None)
    for column in ("attribute", "range", "unit", "nominal", "from"):
        table.add_column(column, no_wrap=column in ("attribute", "from"))
    for key in [*domain.keys, *(k for k in AUXILIARY if k in domain.rules)]:
        rule, attribute = domain.rules[key], known.get(key)
        nominal = attribute.nominal if attribute else ""
        table.add_row(
            key,
            str(rule),
            attribute.unit if attribute else "",
            "the asset's" if nominal is None else str(nominal),
            domain.sources.get(key, domain.name),
        )
    for key in sorted(known.keys() - set(domain.keys)):
        nominal = known[key].nominal
        table.add_row(key, "held nominal", known[key].unit, str(nominal or "the asset's"), "")
    return table
