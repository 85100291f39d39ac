"""`rtphys bench`: what an episode costs on this machine."""

import json
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

from rtphys.cli.assets import BuildBar
from rtphys.cli.fitting import fitting_table, wide_console
from rtphys.cli.options import expand, split
from rtphys.core.errors import BadFile
from rtphys.studies.bench import ATTEMPT, PICTURES, BenchPlan, Cost, means
from rtphys.studies.bench import bench as measure


def bench(
    task: Annotated[
        list[str] | None, typer.Option(help="Tasks or patterns, by commas or repeated.")
    ] = None,
    protocol: Annotated[str, typer.Option(help="Several with commas.")] = "clean,phys_random_all",
    episodes: Annotated[int, typer.Option(help="Attempts of each task and protocol.")] = 2,
    first_seed: Annotated[int, typer.Option(help="Where to start.")] = 0,
    pictures: Annotated[bool, typer.Option(help="Draw and write what is accepted.")] = True,
    json_file: Annotated[
        Path | None, typer.Option("--json", help="Also write the numbers here.")
    ] = None,
) -> None:
    """CPU-seconds of an episode by phase, for each task and protocol.

    CPU time is what two machines of a kind agree on. Wall time, in the JSON, compares phases of
    one run at most; other jobs on the machine lengthen it.
    """
    plan = BenchPlan(expand(task or ["*"]), split(protocol), episodes, first_seed, pictures)
    plan.check()
    if json_file is not None and not os.access(json_file.absolute().parent, os.W_OK):
        raise BadFile(json_file, "its folder cannot be written, or does not exist")
    from rtphys.assets.pack import default_pack

    with BuildBar() as building:
        pack = default_pack(building)
    console = Console(stderr=True)
    costs = measure(plan, pack, lambda cost: console.print(_line(cost), highlight=False))
    wide_console().print(_attempts(costs))
    if pictures:
        wide_console().print(_pictures(costs))
    if json_file is not None:
        content = {"means": means(costs), "rows": [cost.to_json() for cost in costs]}
        json_file.write_text(json.dumps(content, indent=2) + "\n")


def _line(cost: Cost) -> str:
    attempt = cost.attempts.cpu_s()["sum"]
    return f"{cost.task}, {cost.protocol}: {attempt:.2f} CPU-s an attempt"


def _attempts(costs: Sequence[Cost]) -> Table:
    table = _table("CPU-seconds of an attempt, without pictures", (*ATTEMPT, "sum"))
    for cost in costs:
        spent = cost.attempts.cpu_s()
        counts = f"{cost.accepted} / {cost.attempts.count}"
        cells = (f"{spent[phase]:.3f}" for phase in (*ATTEMPT, "sum"))
        table.add_row(cost.task, cost.protocol, counts, *cells)
    for protocol, mean in means(costs).items():
        blank = [""] * len(ATTEMPT)
        table.add_row("mean", protocol, "", *blank, f"{mean['attempt_cpu_s']:.3f}", style="bold")
    return table


def _pictures(costs: Sequence[Cost]) -> Table:
    columns = (*PICTURES, "sum", "all, ms an image", "outside")
    table = _table("CPU-seconds of an accepted episode's pictures", columns)
    for cost in costs:
        spent = cost.pictures.cpu_s()
        cells = (f"{spent[phase]:.2f}" for phase in (*PICTURES, "sum"))
        last = _milliseconds(cost.image_cpu_ms), f"{100 * cost.outside:.1f} %"
        table.add_row(cost.task, cost.protocol, str(cost.pictures.count), *cells, *last)
    for protocol, mean in means(costs).items():
        blank = [""] * (len(PICTURES) + 1)
        last = _milliseconds(mean.get("image_cpu_ms")), f"{100 * mean['outside']:.1f} %"
        table.add_row("mean", protocol, "", *blank, *last, style="bold")
    return table


def _table(title: str, columns: Sequence[str]) -> Table:
    return fitting_table(["task", "protocol"], ("episodes", *columns), title, justify="right")


def _milliseconds(value: float | None) -> str:
    return "-" if value is None else f"{value:.1f}"
