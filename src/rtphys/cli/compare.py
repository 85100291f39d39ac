"""`rtphys compare`: a table of several evaluations, and paired tests between them."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rtphys.cli.derived import Json
from rtphys.cli.tables import fitting_table, print_table
from rtphys.cli.terminal import say, say_json
from rtphys.core.errors import counted

if TYPE_CHECKING:
    from rtphys.analysis.compare import Column, Comparison
    from rtphys.analysis.identify import Result
    from rtphys.results.statistics import Rate

MAX_NAMED = 3  # evaluations whose names fit above their columns
TITLE = "success among feasible seeds, 95 % intervals"


def compare(
    folders: Annotated[
        list[Path] | None,
        typer.Argument(
            help="Folders that rtphys evaluate has written, or files of rtphys identify."
        ),
    ] = None,
    protocol: Annotated[str | None, typer.Option(help="Only this protocol.")] = None,
    paper: Annotated[
        bool, typer.Option("--paper", help="Add the five methods that the paper reports.")
    ] = False,
    figure: Annotated[Path | None, typer.Option(help="Also draw the rates into this PNG.")] = None,
    as_json: Json = False,
) -> None:
    """Success by task and policy with 95 % intervals, and a paired test on common seeds.

    A second table tells how alike two policies rank the tasks.

    Without a folder, --paper shows the paper's tables. Result files of `rtphys identify` (.json)
    are shown side by side instead: the mean R2 of each attribute.

    Examples:

        rtphys compare eval/one eval/other --protocol phys_random
        rtphys compare eval/one --paper --figure rates.png
    """
    from rtphys.analysis import compare as analysis
    from rtphys.analysis.figures import draw_rates
    from rtphys.analysis.identify import read_result
    from rtphys.results import read_results

    if not folders and not paper:
        raise typer.BadParameter("name a result folder, or say --paper")
    if folders and all(path.suffix == ".json" for path in folders):
        _show_identified([read_result(path) for path in folders])
        return
    evaluations = [read_results(folder) for folder in folders or []]
    comparison = analysis.compare(evaluations, protocol, paper)
    columns, tasks = comparison.columns, comparison.tasks
    if figure is not None:
        draw_rates([(f"{c.label}, {c.protocol}", c.rates) for c in columns], tasks, TITLE, figure)
        say(str(figure), err=True)
    if as_json:
        say_json(comparison.to_json())
        return
    _show_rates(columns, tasks)
    if paper:
        _show_paper()
        for sentence in analysis.limits_of_comparison(evaluations):
            say(sentence)
    _show_pairs(comparison)


def _show_rates(columns: "Sequence[Column]", tasks: Sequence[str]) -> None:
    from rtphys.analysis.compare import unfinished

    def cell(rate: "Rate | None", partial: bool) -> str:
        if rate is None or rate.value is None:
            return "-"
        low, high = rate.interval
        return f"{100 * rate.value:.0f} ({100 * low:.0f}-{100 * high:.0f})" + "*" * partial

    heads = [f"{column.label}, {column.protocol}" for column in columns]
    title = "success [%], in brackets its 95 % interval"
    if len(heads) > MAX_NAMED:
        title += "".join(f"\n[{number}] {head}" for number, head in enumerate(heads, start=1))
        heads = [f"[{number}]" for number in range(1, len(heads) + 1)]
    table = fitting_table(["task"], heads, title, justify="right")
    for task in tasks:
        table.add_row(task, *(cell(c.rates.get(task), task in c.unfinished) for c in columns))
    table.add_section()
    means = [column.mean(tasks) for column in columns]
    shown = ["-" if mean is None else f"{100 * mean:.2f}" for mean in means]
    table.add_row("mean of these tasks", *shown)
    totals = [cell(column.total(tasks), bool(column.unfinished)) for column in columns]
    table.add_row("all their rollouts", *totals)
    print_table(table)
    for clause in unfinished(columns):
        say(f"* unfinished: {clause}")


def _show_paper() -> None:
    from rtphys.analysis.compare import PAPER_PROTOCOLS, paper_means

    title = "the paper's Table 1: mean success [%] over 50 tasks"
    protocols = list(PAPER_PROTOCOLS.values())
    table = fitting_table(["method"], protocols, title, justify="right")
    for method, means in paper_means().items():
        table.add_row(method, *(f"{means[name]:.2f}" for name in protocols))
    table.caption = (
        "Means of the 50 tasks of its Table 3: Motus 39.56, pi0.5 31.50 (as printed: 39.60, 31.60)."
    )
    print_table(table)


def _show_pairs(comparison: "Comparison") -> None:
    names = ["first", "second", "protocol"]
    if comparison.pairs:
        title = "on the same instances (p: McNemar's exact test)"
        columns = ("instances", "only first", "only second", "second - first", "p")
        table = fitting_table(names, columns, title, justify="right")
        for pair in comparison.pairs:
            outcome = pair.outcome
            gap = "-" if outcome.difference is None else f"{100 * outcome.difference:+.1f} points"
            counts = map(str, (outcome.trials, outcome.only_first, outcome.only_second))
            table.add_row(pair.first, pair.second, pair.protocol, *counts, gap, f"{outcome.p:.2g}")
        print_table(table)
    for pair in comparison.pairs:
        for reason in pair.unpaired:
            say(f"not paired: {pair.first}, {pair.second}, {pair.protocol}, {reason}")
    if comparison.ranks:
        title = "how alike they rank the tasks (Spearman's rho; 1: the same order, 0: unrelated)"
        table = fitting_table(names, ("tasks", "rho", "p"), title, justify="right")
        for rank in comparison.ranks:
            rho = "-" if rank.rho is None else f"{rank.rho:+.2f}"
            p = "-" if rank.p is None else f"{rank.p:.2g}"
            table.add_row(rank.first, rank.second, rank.protocol, str(rank.tasks), rho, p)
        print_table(table)


def _show_identified(results: "Sequence[Result]") -> None:
    """Mean R2 by attribute and estimator over the tasks that all of them have."""
    from rtphys.analysis.estimators import short_name

    tasks = [t for t in results[0].tasks if all(t in result.tasks for result in results)]
    names = [short_name(result.estimator) for result in results]
    if len({result.protocol for result in results}) > 1:
        names = [f"{n}, {result.protocol}" for n, result in zip(names, results, strict=True)]
    columns = [f"{name}{where}" for where in ("", ", beyond") for name in names]
    title = f"mean R2 over {counted(len(tasks), 'tasks')} of all"
    table = fitting_table(["attribute"], columns, title=title, justify="right")
    for key in sorted({key for r in results for of in r.tasks.values() for key in of.scores}):
        means = [r.mean(key, tasks, beyond) for beyond in (False, True) for r in results]
        if any(mean is not None for mean in means):
            table.add_row(key, *("-" if mean is None else f"{mean:.2f}" for mean in means))
    print_table(table)
    for name, result in zip(names, results, strict=True):
        failed = sum(len(result.tasks[task].failed) for task in tasks)
        if failed:
            say(f"{name} failed on {counted(failed, 'attributes')} of these tasks; left out")
