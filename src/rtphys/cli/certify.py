"""`rtphys certify`: which seeds a benchmark is made of."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rtphys.campaign.workers.local import cores
from rtphys.cli.options import expand, split, taking
from rtphys.cli.progress import progress_bar
from rtphys.cli.stopping import Incomplete, resumable

if TYPE_CHECKING:
    from rtphys.studies.certify import CertifyPlan, Order


@dataclass(frozen=True)
class CertifyOptions:
    """One command line, not yet checked."""

    task: Annotated[list[str], typer.Option(help="Tasks or patterns, by commas or repeated.")]
    protocol: Annotated[str, typer.Option(help="clean, phys_random; several with commas.")]
    out: Annotated[Path, typer.Option(help="The benchmark's folder.")]
    feasible: Annotated[int, typer.Option(help="Feasible seeds of each task and protocol.")] = 100
    first_seed: Annotated[
        int | None, typer.Option(help="Where to begin; default: the benchmark's own.")
    ] = None
    baselines: Annotated[
        str,
        typer.Option(
            help="Of replay, twin, comma-separated; or none. Each doubles the work. "
            "A list that lacks one gains it, and keeps what it has."
        ),
    ] = "replay,twin"
    max_attempts: Annotated[int, typer.Option(help="Seeds to try for one list.")] = 1000
    workers: Annotated[int | None, typer.Option(help="Processes; default one a core.")] = None

    def plan(self) -> "CertifyPlan":
        """Raises UnknownName, BadValue, BadFile: before any work is done."""
        names = expand(self.task)
        from rtphys.results.instances import FIRST_SEED
        from rtphys.studies.certify import CertifyPlan

        plan = CertifyPlan(
            tasks=names,
            protocols=split(self.protocol),
            out=self.out,
            feasible=self.feasible,
            first_seed=FIRST_SEED if self.first_seed is None else self.first_seed,
            baselines=() if self.baselines.strip() == "none" else split(self.baselines),
            most_attempts=self.max_attempts,
            workers=cores() if self.workers is None else self.workers,
        )
        plan.check()
        return plan


@taking(CertifyOptions)
def certify(options: CertifyOptions) -> None:
    """Find the seeds on which policies are evaluated: those that the expert solves.

    No pictures are drawn. One list a task and protocol, with every seed that was tried. It may be
    interrupted: the same command goes on where it stopped.
    """
    orders = _run(options.plan())
    _show(orders)
    why = [(order, order.halted or order.stopped) for order in orders]
    if given_up := [f"{order.task}, {order.protocol}: {text}" for order, text in why if text]:
        raise Incomplete("; ".join(given_up))


def _run(plan: "CertifyPlan") -> "list[Order]":
    from rtphys.assets.pack import default_pack
    from rtphys.cli.assets import BuildBar
    from rtphys.studies.certify import certify

    with BuildBar() as building:
        pack = default_pack(building)
    total = plan.feasible * len(plan.tasks) * len(plan.protocols)
    with resumable(), progress_bar() as shown:

        def told(orders: "Sequence[Order]") -> None:
            found = sum(order.feasible for order in orders)
            tried = sum(len(order.slots) for order in orders)
            lacking = sum(order.lacking for order in orders)
            words = f"{found} of {tried} seeds feasible"
            words += f", {lacking} lack a baseline" if lacking else ""
            shown(found - lacking, total, words)

        return certify(plan, pack, told)


def _show(orders: "Sequence[Order]") -> None:
    from rtphys.cli.collect_progress import reasons
    from rtphys.cli.fitting import fitting_table, wide_console

    columns = ("feasible", "attempts", "replay", "twin", "infeasible, by reason")
    table = fitting_table(["task", "protocol"], columns)
    for order in orders:
        good = [slot for slot in order.slots if slot.feasible]
        table.add_row(
            order.task,
            order.protocol,
            str(len(good)),
            str(len(order.slots)),
            _share([slot.replay for slot in good]),
            _share([slot.twin for slot in good]),
            reasons(Counter(slot.reason for slot in order.slots if not slot.feasible)),
        )
    wide_console().print(table)


def _share(flags: "Sequence[bool | None]") -> str:
    known = [flag for flag in flags if flag is not None]
    return f"{sum(known)} / {len(known)}" if known else "-"
