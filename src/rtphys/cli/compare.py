"""`rtphys compare`: a table of several evaluations, and paired tests between them."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table

from rtphys.cli.fitting import fitting_table, print_table
from rtphys.cli.terminal import say
from rtphys.report.figures.rates import draw_rates
from rtphys.results import read_results
from rtphys.results.comparison import (
    Column,
    PairedComparison,
    columns_of,
    paired_comparisons,
)
from rtphys.results.published import PROTOCOLS, per_task, settings
from rtphys.results.statistics import Rate


def compare(
    folders: Annotated[
        list[Path] | None, typer.Argument(help="Folders that rtphys evaluate has written.")
    ] = None,
    protocol: Annotated[str | None, typer.Option(help="Only this protocol.")] = None,
    paper: Annotated[
        bool, typer.Option("--paper", help="Add the five methods that the paper reports.")
    ] = False,
    figure: Annotated[Path | None, typer.Option(help="Also draw the rates into this PNG.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Plain JSON, not tables.")] = False,
) -> None:
    """Success by task and policy with 95 % intervals, and a paired test on common seeds.

    Without a folder, --paper shows the paper's tables.
    """
    if not folders and not paper:
        raise typer.BadParameter("name a result folder, or say --paper")
    evaluations = [read_results(folder) for folder in folders or []]
    columns = columns_of(evaluations, protocol) if evaluations else []
    tasks = list(dict.fromkeys(task for column in columns for task in column.rates))
    if paper and protocol in (None, PROTOCOLS["physical_random"]):
        columns += per_task()
        tasks = tasks or sorted(columns[-1].rates)
    pairs = [p for p in paired_comparisons(evaluations) if protocol in (None, p.protocol)]
    if as_json:
        typer.echo(json.dumps(_json(columns, tasks, pairs), indent=2))
    else:
        print_table(_rates(columns, tasks))
        if paper:
            print_table(_settings())
        if pairs:
            print_table(_paired(pairs))
    if figure is not None:
        rates = [(f"{c.label}, {c.protocol}", c.rates) for c in columns]
        draw_rates(rates, tasks, "success among feasible seeds, 95 % intervals", figure)
        say(str(figure), err=True)


def _rates(columns: Sequence[Column], tasks: Sequence[str]) -> Table:
    heads = [f"{column.label}, {column.protocol}" for column in columns]
    title = "success [%], in brackets its 95 % interval"
    table = fitting_table(["task"], heads, title, justify="right")
    for task in tasks:
        table.add_row(task, *(_cell(column.rates.get(task)) for column in columns))
    table.add_section()
    table.add_row("mean of these tasks", *(_percent(column.mean(tasks)) for column in columns))
    table.add_row("all their rollouts", *(_cell(column.total(tasks)) for column in columns))
    return table


def _cell(rate: Rate | None) -> str:
    if rate is None or rate.value is None:
        return "-"
    low, high = rate.interval
    return f"{100 * rate.value:.0f} ({100 * low:.0f}-{100 * high:.0f})"


def _percent(value: float | None) -> str:
    return "-" if value is None else f"{100 * value:.2f}"


def _settings() -> Table:
    title = "the paper's Table 1: mean success [%] over 50 tasks"
    table = fitting_table(["method"], list(PROTOCOLS.values()), title, justify="right")
    for method, means in settings().items():
        table.add_row(method, *(f"{means[name]:.2f}" for name in PROTOCOLS.values()))
    table.caption = (
        "Means of the 50 tasks of its Table 3: Motus 39.56, pi0.5 31.50 (as printed: 39.60, 31.60)."
    )
    return table


def _paired(pairs: Sequence[PairedComparison]) -> Table:
    title = "on the same seeds (p: McNemar's exact test)"
    columns = ("seeds", "only first", "only second", "second - first", "p")
    table = fitting_table(["first", "second", "protocol"], columns, title, justify="right")
    for pair in pairs:
        outcome = pair.outcome
        gap = f"{100 * (outcome.difference or 0):+.1f} points"
        counts = map(str, (outcome.trials, outcome.only_first, outcome.only_second))
        table.add_row(pair.first, pair.second, pair.protocol, *counts, gap, f"{outcome.p:.2g}")
    return table


def _json(
    columns: Sequence[Column], tasks: Sequence[str], pairs: Sequence[PairedComparison]
) -> dict[str, object]:
    return {
        "columns": [
            {
                "policy": column.label,
                "protocol": column.protocol,
                "mean": column.mean(tasks),
                "tasks": {t: column.rates[t].to_json() for t in tasks if t in column.rates},
            }
            for column in columns
        ],
        "same_seeds": [
            {"first": p.first, "second": p.second, "protocol": p.protocol, **p.outcome.to_json()}
            for p in pairs
        ],
    }
