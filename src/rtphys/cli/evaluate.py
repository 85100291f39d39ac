"""`rtphys evaluate`: a policy on certified instances."""

from typing import TYPE_CHECKING

import typer
from rich.table import Table

from rtphys.cli.derived import AsJson, takes
from rtphys.cli.progress import campaign
from rtphys.cli.tables import fitting_table, print_table
from rtphys.cli.terminal import say, say_json
from rtphys.results.evaluation import EvaluationSpec
from rtphys.studies.requests import EvaluationRun

if TYPE_CHECKING:
    from rtphys.results.evaluation import Results
    from rtphys.results.statistics import Rate
    from rtphys.results.summary import Counts, Summary

SHOWN = 5  # attributes per protocol, those with the smallest p-values


COMMON = ("policy", "protocols", "episodes", "out", "workers", "video", "record")


@takes(EvaluationSpec, EvaluationRun, AsJson, common=COMMON)
def evaluate(spec: EvaluationSpec, run: EvaluationRun, output: AsJson) -> None:
    """Run a policy on certified instances and say how often it succeeds.

    Nothing is searched for: the instances are those of a list that `rtphys certify` has made. The
    same policy gives the same records, with any number of workers. It may be interrupted: the
    same command goes on where it stopped. The exit code is 1 if the policy raised an error in
    every episode.

    Examples:

        rtphys evaluate click_bell --policy expert --protocol clean
        rtphys evaluate '*' --policy python:mine.py:load --protocol clean
        rtphys evaluate lift_pot --policy lerobot:act --protocol phys_random
    """
    run.check(spec)
    from rtphys.results import read_results
    from rtphys.studies.evaluate import evaluate as run_evaluation

    with campaign("episodes") as (pack, listener):
        summary = run_evaluation(spec, run, pack, listener)
    if output.as_json:
        say_json(summary.to_json())
    else:
        _show(summary)
    out = run.folder(spec.policy)
    broken, every = errors_of(read_results(out))
    if broken:
        say(broken, err=True)
    written = "records, summary and figures" if any(out.glob("*.png")) else "records and summary"
    say(f"{written} are in {out}", err=output.as_json)
    if every:
        raise typer.Exit(1)


def errors_of(results: "Results") -> tuple[str, bool]:
    """What the policy raised first, in one line, and where to read on; whether it always raised."""
    from rtphys.results.evaluation import ledger_file

    played = [record for records in results.records.values() for record in records]
    broken = [record for record in played if record.reason == "policy_error"]
    if not broken:
        return "", False
    first = broken[0]
    raised = first.detail.strip().splitlines()[-1]
    where = ledger_file(results.path, first.protocol, first.task)
    rest = f"the traceback is `detail` of its line in {where}"
    return f"policy_error of seed {first.seed}: {raised}; {rest}", len(broken) == len(played)


def _show(summary: "Summary") -> None:
    """Prints success rates, paired differences, and the attributes with the largest effect."""
    print_table(rates_table(summary))
    for row in summary.tasks:
        if row.language:
            say(f"{row.protocol}, {row.task}: {row.language}")
    print_table(loads_table(summary))
    if summary.pairs:
        print_table(pairs_table(summary))
    if any(summary.breaks.values()):
        print_table(attributes_table(summary))


def rates_table(summary: "Summary") -> Table:
    """Success rates of each task and protocol."""
    columns = ("of benchmark instances", "of all seeds tried", "still true after 0.5 s", "failures")
    table = fitting_table(["protocol", "task"], columns, "success, with 95 % intervals")
    for row in summary.tasks:
        reasons = ", ".join(f"{name} {count}" for name, count in row.reasons.items())
        table.add_row(row.protocol, row.task, *_rates(row.counts), reasons)
    table.add_section()
    for total in summary.overall:
        if total.tasks > 1:
            mean = total.mean_of_tasks
            name = "all" if mean is None else f"all, mean {_percent(mean)} %"
            table.add_row(total.protocol, name, *_rates(total.counts))
    return table


def loads_table(summary: "Summary") -> Table:
    """Largest force and torque of the successful episodes, and how many were rough."""
    title = "what the robot suffered in successful episodes: median, 90 %, largest"
    columns = ("force on a link [N]", "torque [of the motor's]", "rough")
    table = fitting_table(["protocol", "task"], columns, title)
    rough = [(row.protocol, row.task, row.loads) for row in summary.tasks if row.loads.rough]
    for protocol, task, loads in rough + [(t.protocol, "all", t.loads) for t in summary.overall]:
        force = ", ".join(f"{x:.1f}" for x in loads.force or ()) or "-"
        torque = ", ".join(f"{x:.2f}" for x in loads.torque or ()) or "-"
        table.add_row(protocol, task, force, torque, str(loads.rough))
    return table


def _rates(counts: "Counts") -> tuple[str, str, str]:
    from rtphys.results.statistics import Rate

    held = Rate(counts.held, counts.rollouts)
    # One interval a row fits into 80 columns; summary.json holds the others.
    return _rate(counts.of_feasible, bounds=True), _rate(counts.of_tried), _rate(held)


def _rate(rate: "Rate | None", bounds: bool = False) -> str:
    if rate is None or rate.value is None:
        return "-"
    low, high = map(_percent, rate.interval)
    between = f" [{low}, {high}]" if bounds else ""
    return f"{_percent(rate.value)} %{between} {rate.successes}/{rate.trials}"


def _percent(share: float) -> str:
    return f"{100 * share:.1f}".removesuffix(".0")


def pairs_table(summary: "Summary") -> Table:
    """Comparison of every two protocols on their common seeds."""
    title = "the same seeds under two protocols (McNemar, exact)"
    columns = ("seeds", "both", "only first", "only second", "p")
    table = fitting_table(["first", "second"], columns, title)
    for row in summary.pairs:
        outcome = row.outcome
        counts = (outcome.trials, outcome.both, outcome.only_first, outcome.only_second)
        table.add_row(row.first, row.second, *map(str, counts), f"{outcome.p:.2g}")
    return table


def attributes_table(summary: "Summary") -> Table:
    """Effects of the attributes with the smallest p-values on success."""
    title = "which physics breaks the policy: log-odds of success from lowest to highest"
    columns = ("attribute", "range", "log-odds", "p", "p (Holm)")
    table = fitting_table(["protocol"], columns, title)
    for protocol, effects in summary.breaks.items():
        for effect in effects[:SHOWN]:
            curve = effect.curve
            span = f"{curve.low:.3g} to {curve.high:.3g} {effect.unit}"
            slope = f"{curve.slope:+.2f} ± {curve.error:.2f}"
            p = f"{curve.p:.2g}", f"{effect.p_holm:.2g}"
            table.add_row(protocol, ", ".join([effect.key, *effect.same]), span, slope, *p)
    return table
