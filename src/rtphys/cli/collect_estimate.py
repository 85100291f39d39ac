"""What `rtphys collect` says of time and disk, before and after."""

import resource
import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import typer

from rtphys.cli.collect_progress import Lines
from rtphys.cli.fitting import fitting_table, wide_console
from rtphys.studies.collect import Estimate, bytes_below, estimate, probe, size_of

if TYPE_CHECKING:
    from rtphys.studies.collect import CollectPlan


@dataclass(frozen=True)
class Forecast:
    """What was said beforehand, and where the clocks stood."""

    plans: Sequence["CollectPlan"]
    cpu: float  # [s]
    wall: float  # [s]
    bytes: float
    began: float  # [s] wall clock
    spent: float  # [s] CPU of ended child processes
    held: int  # [bytes] in the folder


def forecast(plans: Sequence["CollectPlan"]) -> Forecast:
    """Probes every plan and says what they will take.

    Raises:
        RtphysError: what `collect` would refuse.
    """
    began = time.monotonic()
    typer.echo("probing what it will take", err=True)
    found = []
    for plan in plans:
        with Lines() as shown:
            measured = probe(plan, shown)
        found.append(estimate(plan, measured, size_of(plan)))
    _show(plans, found)
    cpu = sum(one.total.cpu for one in found)
    wall = sum(one.wall for one in found)
    size = sum(one.total.bytes for one in found)
    episodes = sum(one.total.episodes for one in found)
    probed = time.monotonic() - began
    typer.echo(
        f"estimate: {episodes} episodes, {_hours(cpu)} of CPU, {_hours(wall)} with "
        f"{found[0].workers} workers, {size / 1e9:.2f} GB (probed for {_hours(probed)})"
    )
    out = plans[0].out
    held = bytes_below(out) if out.is_dir() else 0
    return Forecast(plans, cpu, wall, size, time.monotonic(), children_cpu(), held)


def confirm(before: Forecast) -> None:
    """Says how right it was. CPU is left out where the workers were other machines'."""
    wall = time.monotonic() - before.began
    cpu = children_cpu() - before.spent
    size = bytes_below(before.plans[0].out) - before.held
    told = [f"{_hours(wall)} ({_off(wall, before.wall)})"]
    if before.plans[0].runner == "local":
        told.insert(0, f"{_hours(cpu)} of CPU ({_off(cpu, before.cpu)})")
    told.append(f"{size / 1e9:.2f} GB ({_off(size, before.bytes)})")
    typer.echo(f"it took {', '.join(told)}; in brackets, against the estimate")


def children_cpu() -> float:
    """CPU-seconds of child processes that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _show(plans: Sequence["CollectPlan"], found: Sequence[Estimate]) -> None:
    columns = ("episodes", "attempts", "CPU-s an episode", "MB")
    table = fitting_table(["task", "configuration"], columns, justify="right")
    for plan, one in zip(plans, found, strict=True):
        for task, cost in one.tasks.items():
            each = f"{cost.cpu / cost.episodes:.1f}" if cost.episodes else "-"
            counts = (str(cost.episodes), f"{cost.attempts:.0f}", each, f"{cost.bytes / 1e6:.1f}")
            table.add_row(task, plan.config or plan.protocol, *counts)
    wide_console().print(table)


def _off(was: float, said: float) -> str:
    return f"{100 * (was / said - 1):+.0f} %" if said else "nothing was estimated"


def _hours(seconds: float) -> str:
    if seconds < 90:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.1f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"
