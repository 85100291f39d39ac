"""Commands for policies: certified lists, evaluations, and comparisons of them."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table

from rtphys.analysis import compare as analysis
from rtphys.analysis.compare import Column, Comparison, PairedComparison, RankAgreement, unfinished
from rtphys.analysis.estimators import short_name
from rtphys.analysis.identify import Result, read_result
from rtphys.assets.pack import default_pack
from rtphys.cli.derived import NAMED, AsJson, Json, check_figure, refuse_others, takes
from rtphys.cli.screen import campaign, fitting_table, print_parts, print_rows, print_table, reasons
from rtphys.cli.terminal import Incomplete, say, say_json
from rtphys.core.errors import BadValue, counted, shortened
from rtphys.results import read_results
from rtphys.results.breaks import TOGETHER, drawn_together, without_evidence
from rtphys.results.evaluation import EvaluationSpec, Results, ledger_file
from rtphys.results.statistics import Rate, percent, rate_text
from rtphys.results.summary import Counts, Summary
from rtphys.studies.requests import CertificationRun, CertificationSpec, EvaluationRun

SHOWN = 5  # attributes per protocol, those with the smallest p-values


@takes(
    *(CertificationSpec, CertificationRun, AsJson, typer.Context),
    common=("protocols", "feasible", "out", "workers"),
)
def certify(
    spec: CertificationSpec, run: CertificationRun, output: AsJson, context: typer.Context
) -> None:
    """Find the seeds that the expert solves, to evaluate policies on.

    It writes one list for each task and protocol, with every seed that was tried, and draws no
    pictures. After an interruption, the same command continues where it stopped.

    --reprove K finds no seeds; it solves the first K instances of each list again. After a code
    change that leaves states unchanged, this gives the lists the current fingerprint within
    minutes. Exit code 1: a list differs.

    Examples:

        rtphys certify click_bell --protocol clean,phys_random --out bench
        rtphys certify '*' --protocol clean --reprove 1 --out bench
    """
    from rtphys.studies.certify import certify as run_certification

    if run.reprove:
        names = {field.name for kind in (CertificationRun, AsJson) for field in fields(kind)}
        refuse_others(context, {*names, NAMED, "embodiment"}, "with `reprove` the lists say that")
        _reprove(spec, run, output.as_json)
        return
    if left_out := run.left_out():
        text = f"left out, since the attribute could not act there: {'; '.join(left_out)}"
        say(text, err=True)
    with campaign("feasible seeds") as (pack, listener):
        made = run_certification(spec, run, pack, listener)

    def share(flags: Sequence[bool | None]) -> str:
        known = [flag for flag in flags if flag is not None]
        return f"{sum(known)} / {len(known)}" if known else "-"

    heads = ("feasible", "attempts", "replay", "open-loop replay of clean")
    table = fitting_table(["task", "protocol"], (*heads, "reasons for infeasibility"))
    rows = list[dict[str, object]]()
    for found in (one.instances for one in made):
        replayed = [one.replay for one in found.feasible]
        twin = [one.twin for one in found.feasible]
        counts = (str(len(found.feasible)), str(found.attempts), share(replayed), share(twin))
        table.add_row(found.task, found.protocol, *counts, reasons(found.rejected))
        rows.append(
            {
                "task": found.task,
                "protocol": found.protocol,
                "feasible": [one.seed for one in found.feasible],
                "attempts": found.attempts,
                "rejected": dict(found.rejected),
                "replayed": replayed,
                "twin": twin,
            }
        )
    print_rows(table, rows, output.as_json)
    ends = [(one.progress.name, one.halted or one.progress.stopped) for one in made]
    if given_up := [f"{name}: {text}" for name, text in ends if text]:
        raise Incomplete("; ".join(given_up))


def _reprove(spec: CertificationSpec, run: CertificationRun, as_json: bool) -> None:
    from rtphys.studies.certify import reprove

    with campaign("instances") as (pack, listener):
        studies = reprove(spec, run, pack, listener)
    if as_json:
        rows = [
            {
                "task": study.listed.task,
                "protocol": study.listed.protocol,
                "solved": study.solved,
                "renewed": study.renewed,
                "stale": study.stale and not study.renewed,
                "differences": study.differences,
            }
            for study in studies
        ]
        say_json(rows)
    for line in (line for study in studies for line in study.differences if not as_json):
        say(line)
    renewed = sum(study.renewed for study in studies)
    stale = sum(study.stale and not study.renewed for study in studies)
    solved = sum(study.solved for study in studies)
    held = sum(not study.differences for study in studies)
    say(
        f"{held} of {counted(len(studies), 'lists')} hold "
        f"({counted(solved, 'instances')} solved again); {renewed} have a new header, "
        f"{stale} stay stale",
        err=as_json,
    )
    if held < len(studies):
        raise typer.Exit(1)


@takes(
    *(EvaluationSpec, EvaluationRun, AsJson),
    common=("policy", "protocols", "episodes", "out", "workers", "video", "record"),
)
def evaluate(spec: EvaluationSpec, run: EvaluationRun, output: AsJson) -> None:
    """Say how often a policy succeeds on certified instances.

    It searches for no seeds: the instances are those of a list that `rtphys certify` has made. The
    same policy gives the same records, with any number of workers. After an interruption, the same
    command continues where it stopped. The exit code is 1 if the policy raised an error in every
    episode.

    Examples:

        rtphys evaluate click_bell --policy expert --protocol clean
        rtphys evaluate '*' --policy python:mine.py:load --protocol clean
        rtphys evaluate lift_pot --policy lerobot:act --protocol phys_random
    """
    run.check(spec)
    from rtphys.studies.evaluate import evaluate as run_evaluation

    with campaign("episodes") as (pack, listener):
        summary = run_evaluation(spec, run, pack, listener)
    if output.as_json:
        say_json(summary.to_json())
    else:
        print_table(rates_table(summary))
        if summary.stale:
            say(summary.stale)
        if any(row.reasons for row in summary.tasks):
            print_table(failures_table(summary))
        for row in summary.tasks:
            if row.language:
                say(f"{row.protocol}, {row.task}: {row.language}")
            if rough := row.loads.rough:
                many = f"{rough} of the {row.counts.successes} successes"
                say(f"{row.protocol}, {row.task}: {many} press or strain too hard (`rough`)")
        if summary.pairs:
            print_table(pairs_table(summary))
            for pair in summary.pairs:
                if pair.caution:
                    say(pair.caution)
        if any(summary.breaks.values()):
            print_table(attributes_table(summary))
            notes = without_evidence(summary.breaks)
            for line in [*notes, *left_out_of(summary), *drawn_together_in(summary), TOGETHER]:
                say(line)
    out = run.folder(spec.policy)
    played = [(row.protocol, row.task) for row in summary.tasks]
    broken, every = errors_of(read_results(out), played)
    if broken:
        say(broken, err=True)
    written = "records, summary and figures" if any(out.glob("*.png")) else "records and summary"
    say(f"{written} are in {out}", err=output.as_json)
    if every:
        raise typer.Exit(1)


def errors_of(results: Results, keys: Iterable[tuple[str, str]]) -> tuple[str, bool]:
    """What the policy raised first, in one line, and where to read on; whether it always raised.

    `keys`: protocol and task of what counts; others in the folder are of earlier commands.
    """
    played = [record for key in keys for record in results.records[key]]
    broken = [record for record in played if record.reason == "policy_error"]
    if not broken:
        return "", False
    first = broken[0]
    where = ledger_file(results.path, first.protocol, first.task)
    rest = f"the traceback is `detail` of its line in {where}"
    text = f"policy_error of seed {first.seed}: {shortened(first.raised)}; {rest}"
    return text, len(broken) == len(played)


def rates_table(summary: Summary) -> Table:
    """Success rates of each task and protocol."""
    first = "of benchmark instances" if summary.certified else "of these seeds"
    columns = (first, "of all seeds tried", "still true after 0.5 s")
    table = fitting_table(["protocol", "task"], columns, "success, with 95 % intervals")
    for row in summary.tasks:
        table.add_row(row.protocol, row.task, *_rates(row.counts))
    for total in summary.overall:
        if total.tasks > 1:
            mean = total.mean_of_tasks
            name = "all" if mean is None else f"all, mean {percent(mean)} %"
            table.add_row(total.protocol, name, *_rates(total.counts))
    return table


def failures_table(summary: Summary) -> Table:
    """Number of failures by reason, of each task and protocol that has any."""
    table = fitting_table(["protocol", "task"], ["failures"])
    for row in summary.tasks:
        if row.reasons:
            reasons = ", ".join(f"{name} {count}" for name, count in row.reasons.items())
            table.add_row(row.protocol, row.task, reasons)
    return table


def _rates(counts: Counts) -> tuple[str, str, str]:
    held = Rate(counts.held, counts.rollouts)
    # One interval a row fits into 80 columns; summary.json holds the others.
    return rate_text(counts.of_feasible, bounds=True), rate_text(counts.of_tried), rate_text(held)


def pairs_table(summary: Summary) -> Table:
    """Comparison of every two protocols on their common seeds."""
    title = "the same seeds under two protocols (McNemar, exact)"
    columns = ("seeds", "both", "only first", "only second", "p")
    table = fitting_table(["first", "second"], columns, title)
    for row in summary.pairs:
        outcome = row.outcome
        counts = (outcome.trials, outcome.both, outcome.only_first, outcome.only_second)
        p = "-" if outcome.p is None else f"{outcome.p:.2g}"
        table.add_row(row.first, row.second, *map(str, counts), p)
    return table


def attributes_table(summary: Summary) -> Table:
    """Effects of the attributes with the smallest p-values on success."""
    title = "which physics breaks the policy: log-odds of success from lowest to highest"
    columns = ("attribute", "range", "log-odds", "p", "p (Holm)")
    table = fitting_table(["protocol"], columns, title)
    for protocol, effects in summary.breaks.items():
        for effect in effects[:SHOWN]:
            curve = effect.curve
            slope = f"{curve.slope:+.2f} ± {curve.error:.2f}"
            p = f"{curve.p:.2g}", f"{effect.p_holm:.2g}"
            table.add_row(protocol, effect.names, effect.span, slope, *p)
    return table


def left_out_of(summary: Summary) -> list[str]:
    """A line for each protocol of which `attributes_table` does not show every attribute."""
    return [
        f"{protocol}: {counted(len(effects) - SHOWN, 'more attributes')} in summary.json and "
        f"attributes_{protocol}.png"
        for protocol, effects in summary.breaks.items()
        if len(effects) > SHOWN
    ]


def drawn_together_in(summary: Summary) -> list[str]:
    """A line for each row of `attributes_table` with several attributes: how to part them."""
    shown = [effect for effects in summary.breaks.values() for effect in effects[:SHOWN]]
    return [
        f"drawn together: {', '.join(keys)}; `rtphys sensitivity --only {','.join(keys)}` tells "
        "them apart"
        for keys in drawn_together(shown)
    ]


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
    """Compare evaluations with each other and with the paper.

    It shows success by task and policy with 95 % intervals, and a paired test on common seeds.
    A second table says how similarly two policies rank the tasks.

    Without a folder, --paper shows the paper's tables. Result files of `rtphys identify` (.json)
    are shown side by side instead: the mean R2 of each attribute.

    Examples:

        rtphys compare eval/one eval/other --protocol phys_random
        rtphys compare eval/one --paper --figure rates.png
    """
    if not folders and not paper:
        raise typer.BadParameter("name a result folder, or say --paper")
    if folders and all(path.suffix == ".json" for path in folders):
        for name, value in (("protocol", protocol), ("paper", paper), ("figure", figure)):
            if value:
                raise BadValue(name, value, "it belongs to evaluations, not to `rtphys identify`")
        _show_identified({path: read_result(path) for path in folders}, as_json)
        return
    if figure is not None:
        check_figure(figure)
    evaluations = [read_results(folder) for folder in dict.fromkeys(folders or ())]
    comparison = analysis.compare(evaluations, protocol, paper)
    columns, tasks = comparison.columns, comparison.tasks
    if figure is not None:
        from rtphys.report.figures import draw_rates

        title = "success among feasible seeds, 95 % intervals"
        draw_rates([(f"{c.label}, {c.protocol}", c.rates) for c in columns], tasks, title, figure)
        say(str(figure), err=True)
    if as_json:
        say_json(comparison.to_json())
        return
    differ = _show_rates(columns, tasks)
    if paper:
        title = "the paper's Table 1: mean success [%] over 50 tasks"
        protocols = list(analysis.PAPER_PROTOCOLS.values())
        table = fitting_table(["method"], protocols, title, justify="right")
        for method, means in analysis.paper_means().items():
            table.add_row(method, *(f"{means[name]:.2f}" for name in protocols))
        print_table(table)
        say("By its Table 3 the means are 39.56 (Motus) and 31.50 (pi0.5), not as printed.")
        say("docs/benchmark.md says which of its numbers can be compared with an evaluation.")
    if differ and comparison.pairs:
        say("Not all were run on the same instances; the next table compares those they share.")
    _show_pairs(comparison)


def _show_rates(columns: Sequence[Column], tasks: Sequence[str]) -> bool:
    """Success by task and column; whether some were run on more instances than others."""

    def cell(rate: Rate | None, partial: bool) -> str:
        if rate is None or rate.value is None:
            return "-"
        low, high = rate.interval
        return f"{100 * rate.value:.0f} ({100 * low:.0f}-{100 * high:.0f})" + "*" * partial

    title = "success [%], in brackets its 95 % interval"
    heads = [f"[{number}]" for number in range(1, len(columns) + 1)]
    for head, column in zip(heads, columns, strict=True):
        title += f"\n{head} {column.label}, {column.protocol}"
    table, differ = fitting_table(["task"], heads, title, justify="right"), False
    for task in tasks:
        rates = [column.rates.get(task) for column in columns]
        table.add_row(task, *(cell(c.rates.get(task), task in c.unfinished) for c in columns))
        if len({rate.trials for rate in rates if rate is not None}) > 1:
            table.add_row(
                "  instances", *("-" if rate is None else str(rate.trials) for rate in rates)
            )
            differ = True

    def mean_of(column: Column) -> str:
        if (mean := column.mean(tasks)) is None:
            return "-"
        count = sum(task in column.rates and column.rates[task].trials > 0 for task in tasks)
        return f"{100 * mean:.2f}" + f" ({count} of {len(tasks)})" * (count < len(tasks))

    table.add_row("mean of these tasks", *map(mean_of, columns))
    totals = [cell(column.total(tasks), bool(column.unfinished)) for column in columns]
    table.add_row("all their rollouts", *totals)
    print_parts(table)
    for clause in unfinished(columns):
        say(f"* unfinished: {clause}")
    return differ


def _show_pairs(comparison: Comparison) -> None:
    """Policies by the numbers of their columns in the table of rates."""
    shown = [(column.label, column.protocol) for column in comparison.columns]
    names = ["first", "second", "protocol"]

    def numbers(pair: PairedComparison | RankAgreement) -> list[str]:
        return [f"[{shown.index((one, pair.protocol)) + 1}]" for one in (pair.first, pair.second)]

    if comparison.pairs:
        title = "on the same instances (p: McNemar's exact test)"
        columns = ("instances", "only first", "only second", "second - first", "p")
        table = fitting_table(names, columns, title, justify="right")
        for pair in comparison.pairs:
            outcome = pair.outcome
            gap = "-" if outcome.difference is None else f"{100 * outcome.difference:+.1f} points"
            counts = map(str, (outcome.trials, outcome.only_first, outcome.only_second))
            p = "-" if outcome.p is None else f"{outcome.p:.2g}"
            table.add_row(*numbers(pair), pair.protocol, *counts, gap, p)
        print_table(table)
    for pair in comparison.pairs:
        for reason in pair.unpaired:
            say(f"not paired: {pair.first}, {pair.second}, {pair.protocol}, {reason}")
    if comparison.ranks:
        title = "how alike they rank the tasks (Spearman's rho)"
        table = fitting_table(names, ("tasks", "rho", "p"), title, justify="right")
        for rank in comparison.ranks:
            rho = "-" if rank.rho is None else f"{rank.rho:+.2f}"
            p = "-" if rank.p is None else f"{rank.p:.2g}"
            table.add_row(*numbers(rank), rank.protocol, str(rank.tasks), rho, p)
        print_table(table)


def _show_identified(files: Mapping[Path, Result], as_json: bool) -> None:
    """Mean R2 by attribute and estimator over the tasks that all of them have."""
    results = list(files.values())
    tasks = [t for t in results[0].tasks if all(t in result.tasks for result in results)]
    several = len({result.protocol for result in results}) > 1
    ends = [f", {result.protocol}" if several else "" for result in results]
    estimators = [short_name(r.estimator) + end for r, end in zip(results, ends, strict=True)]
    names = analysis.told_apart(estimators, files)
    keys = sorted({key for r in results for task in tasks for key in r.tasks[task].scores})
    if as_json:
        columns = [
            {
                "file": str(path),
                "estimator": result.estimator,
                "protocol": result.protocol,
                "r2": {key: result.mean(key, tasks) for key in keys},
                "beyond": {key: result.mean(key, tasks, beyond=True) for key in keys},
                "failed": {task: result.tasks[task].failed for task in tasks},
            }
            for path, result in files.items()
        ]
        say_json({"tasks": tasks, "columns": columns})
        return
    heads = [f"{name}{where}" for where in ("", ", beyond") for name in names]
    title = f"mean R2 over {counted(len(tasks), 'tasks')} that all files have"
    table = fitting_table(["attribute"], heads, title=title, justify="right")
    for key in keys:
        means = [r.mean(key, tasks, beyond) for beyond in (False, True) for r in results]
        table.add_row(key, *("-" if mean is None else f"{mean:.2f}" for mean in means))
    print_table(table)
    for name, result in zip(names, results, strict=True):
        failed = sum(len(result.tasks[task].failed) for task in tasks)
        if failed:
            say(f"{name} failed on {counted(failed, 'attributes')} of these tasks; left out")


def robotwin_root(
    folder: Annotated[Path, typer.Argument(help="New folder, or one that this command wrote.")],
) -> None:
    """Write a folder in which RoboTwin's launch scripts run.

    Link policies into its policy/ folder, then run a script inside it.

    Example:

        ln -s ~/mine DIR/policy/mine && cd DIR
        python script/eval_policy.py --config policy/mine/deploy_policy.yml \\
            --overrides --task_name click_bell --task_config phys_random \\
            --policy_name mine
    """
    from rtphys.robotwin_root.write import write_root

    written = write_root(folder, default_pack())
    say(f"{folder}: {counted(len(written), 'files')}; link your policies into {folder / 'policy'}")
