"""The summary of an evaluation as tables."""

from rich.table import Table

from rtphys.cli.fitting import fitting_table, wide_console
from rtphys.results.statistics import Rate
from rtphys.results.summary import Counts, Summary

TELLING = 5  # attributes of a protocol that are shown


def show(summary: Summary) -> None:
    """Rates of tasks and protocols, paired differences, the most telling attributes."""
    console = wide_console()
    console.print(rates_table(summary))
    if summary.pairs:
        console.print(pairs_table(summary))
    if any(summary.breaks.values()):
        console.print(attributes_table(summary))


def rates_table(summary: Summary) -> Table:
    """Success of each task and protocol."""
    columns = ("of feasible", "of all slots", "held", "reasons")
    table = fitting_table(["protocol", "task"], columns, "success, with 95 % intervals")
    for row in summary.tasks:
        reasons = ", ".join(f"{name} {count}" for name, count in row.reasons.items())
        table.add_row(row.protocol, row.task, *_three(row.counts), reasons)
    table.add_section()
    for total in summary.overall:
        if total.tasks > 1:
            mean = total.mean_of_tasks
            told = "all" if mean is None else f"all, mean {_percent(mean)} %"
            table.add_row(total.protocol, told, *_three(total.counts))
    return table


def _three(counts: Counts) -> tuple[str, str, str]:
    held = Rate(counts.held, counts.rollouts)
    return _rate(counts.of_feasible), _rate(counts.of_slots), _rate(held)


def _rate(rate: Rate | None) -> str:
    if rate is None or rate.value is None:
        return "-"
    low, high = map(_percent, rate.interval)
    return f"{_percent(rate.value)} % [{low}, {high}] {rate.successes}/{rate.trials}"


def _percent(share: float) -> str:
    return f"{100 * share:.1f}".removesuffix(".0")


def pairs_table(summary: Summary) -> Table:
    """Every two protocols on the seeds that both have."""
    title = "the same seeds under two protocols (McNemar, exact)"
    columns = ("seeds", "both", "only first", "only second", "p")
    table = fitting_table(["first", "second"], columns, title)
    for row in summary.pairs:
        one = row.outcome
        counts = (one.trials, one.both, one.only_first, one.only_second)
        table.add_row(row.first, row.second, *map(str, counts), f"{one.p:.2g}")
    return table


def attributes_table(summary: Summary) -> Table:
    """Success against the attributes that tell most."""
    title = "which physics breaks it: log-odds of success from lowest to highest"
    columns = ("attribute", "range", "log-odds", "p", "p (Holm)")
    table = fitting_table(["protocol"], columns, title)
    for protocol, found in summary.breaks.items():
        for one in found[:TELLING]:
            curve = one.curve
            span = f"{curve.low:.3g} to {curve.high:.3g} {one.unit}"
            slope = f"{curve.slope:+.2f} ± {curve.error:.2f}"
            p = f"{curve.p:.2g}", f"{one.p_holm:.2g}"
            table.add_row(protocol, ", ".join([one.key, *one.same]), span, slope, *p)
    return table
