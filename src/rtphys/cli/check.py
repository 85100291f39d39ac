"""`rtphys check`: what an author runs on a task."""

import json
import os
import sys
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rtphys.campaign.workers.local import cores
from rtphys.cli.options import domain_of, expand, split
from rtphys.core.errors import BadFile, NoRenderer

if TYPE_CHECKING:
    from rtphys.studies.check import CheckPlan, Score

Tasks = Annotated[list[str], typer.Argument(help="Tasks or patterns.")]
Protocols = Annotated[str, typer.Option(help="clean, phys_random; several with commas.")]
Baselines = Annotated[
    int, typer.Option(help="Seeds for the idle and the random robot, which cost the most.")
]
MOST_FAILURES = 10


def check(
    tasks: Tasks,
    seeds: Annotated[int, typer.Option(help="How many, of each task and protocol.")] = 20,
    protocol: Protocols = "clean",
    domain: Annotated[
        str, typer.Option(help="Draw from this domain (name or file), not from the task's own.")
    ] = "",
    first_seed: Annotated[int, typer.Option(help="Where to start.")] = 0,
    robots: Baselines = 20,
    workers: Annotated[int | None, typer.Option(help="Processes; default one a core.")] = None,
    json_file: Annotated[
        Path | None, typer.Option("--json", help="Also write the numbers here.")
    ] = None,
    sheet: Annotated[
        Path | None,
        typer.Option(help="Write a contact sheet here: a .png for one task, else a folder."),
    ] = None,
) -> None:
    """Try a task's expert over many seeds, without pictures.

    The expert's actions are replayed open loop; an idle robot and one that moves at random must
    fail. Exit code 1: a robot that sees nothing succeeded, or a seed gave two outcomes.
    """
    names = expand(tasks)
    from rtphys.studies.check import CheckPlan

    workers = cores() if workers is None else workers
    ranges = domain_of(domain)
    plan = CheckPlan(names, split(protocol), seeds, first_seed, robots, workers, ranges)
    plan.check()
    _check_outputs(json_file, sheet)
    scores = _run(plan)
    _show(scores)
    if json_file is not None:
        text = json.dumps([score.to_json() for score in scores], indent=2)
        json_file.write_text(text + "\n")
    if sheet is not None:
        _draw(plan, scores, sheet)
    if wrong := complaints(scores):
        typer.echo("\n".join(wrong), err=True)
        raise typer.Exit(1)


def _check_outputs(json_file: Path | None, sheet: Path | None) -> None:
    """Minutes of work must not end at a folder that cannot be written, or without a renderer."""
    from rtphys.doctor import check_renderer

    if json_file is not None and not os.access(json_file.absolute().parent, os.W_OK):
        raise BadFile(json_file, "its folder cannot be written, or does not exist")
    if sheet is not None and (finding := check_renderer()).status == "fail":
        raise NoRenderer(f"no pictures can be drawn: {finding.detail}; cure: {finding.cure}")


def complaints(scores: "Sequence[Score]") -> list[str]:
    """What is wrong with the task itself, not with its expert."""
    found = []
    for score in scores:
        at = f"{score.task}, {score.protocol}"
        found += [
            f"{at}: the {kind} robot solves {score.solved[kind]} of {score.tried[kind]} seeds"
            for kind in ("idle", "random")
            if score.solved[kind]
        ]
        if not score.deterministic:
            found.append(f"{at}: a seed that was tried twice went through different states")
    return found


def _run(plan: "CheckPlan") -> "list[Score]":
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    from rtphys.assets.pack import default_pack
    from rtphys.cli.assets import BuildBar
    from rtphys.studies.check import check

    with BuildBar() as building:
        pack = default_pack(building)
    total = len(list(plan.jobs()))
    columns = (TextColumn("{task.description}"), BarColumn(), TimeRemainingColumn())
    console = Console(stderr=True)
    with Progress(*columns, console=console, transient=True, disable=not sys.stderr.isatty()) as p:
        row = p.add_task("checking", total=total)

        def told(scores: "list[Score]", left: int) -> None:
            accepted = sum(score.accepted for score in scores)
            tried = sum(score.tried["expert"] for score in scores)
            text = f"{accepted} of {tried} accepted"
            p.update(row, completed=total - left, description=text)

        return check(plan, pack, told)


def _show(scores: "Sequence[Score]") -> None:
    from rtphys.cli.fitting import fitting_table, wide_console

    columns = ("accepted", "replay", "idle", "random", "CPU-s", "rejected")
    table = fitting_table(["task", "protocol"], columns)
    for score in scores:
        table.add_row(
            score.task,
            score.protocol,
            f"{score.accepted} / {score.seeds}",
            *(_percent(score.rate(kind)) for kind in ("expert", "idle", "random")),
            f"{sum(score.cpu) / len(score.cpu):.2f}",
            _reasons(score.rejected),
        )
    wide_console().print(table)
    for score in scores:
        for seed, reason, detail in score.failures[:MOST_FAILURES]:
            typer.echo(f"{score.task}, {score.protocol}, seed {seed}: {reason}: {detail}")
        if (rest := len(score.failures) - MOST_FAILURES) > 0:
            typer.echo(f"{score.task}, {score.protocol}: and {rest} more")


def _percent(rate: float | None) -> str:
    return "-" if rate is None else f"{100 * rate:.0f} %"


def _reasons(rejected: Counter[str]) -> str:
    return ", ".join(f"{reason} {count}" for reason, count in rejected.most_common())


def _draw(plan: "CheckPlan", scores: "Sequence[Score]", out: Path) -> None:
    from rtphys.assets.pack import default_pack
    from rtphys.data.files import make_folder, replace_file
    from rtphys.studies.check import sheet

    single = len(scores) == 1 and out.suffix == ".png"
    make_folder(out.parent if single else out)
    for score in scores:
        path = out if single else out / f"{score.task}_{score.protocol}.png"
        seed, picture = sheet(plan, default_pack(), score)
        replace_file(path, picture)
        typer.echo(f"{path}: seed {seed}")
