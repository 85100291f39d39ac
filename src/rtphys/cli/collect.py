"""`rtphys collect`: verified episodes of one or more tasks."""

import shlex
import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING

import typer

from rtphys.cli.collect_options import CollectOptions
from rtphys.cli.options import taking
from rtphys.cli.stopping import Incomplete, resumable

if TYPE_CHECKING:
    from rtphys.studies.collect import CollectPlan, Summary


@taking(CollectOptions)
def collect(options: CollectOptions) -> None:
    """Collect verified episodes of one or more tasks.

    Attempts are simulated without pictures, and only successes are drawn. What comes out depends
    on the options alone, not on the number of workers or on interruptions.
    """
    plans = options.plans()
    if not (options.manifest or options.estimate):
        _collect_all(plans)
        return
    from rtphys.cli.collect_estimate import confirm, forecast

    with resumable():
        before = forecast(plans)
    if not options.estimate:
        _collect_all(plans)
        confirm(before)


def _collect_all(plans: Sequence["CollectPlan"]) -> None:
    """One after the other, also when some are given up.

    Raises:
        Incomplete: some were.
    """
    given_up: list[str] = []
    for one in plans:
        if one.config:
            typer.echo(f"{one.config}:", err=True)
        given_up += _tell(_run(one))
    if given_up:
        raise Incomplete("; ".join(given_up) + "; `rtphys check` tells why attempts fail")
    typer.echo(f"to check every file: rtphys verify-manifest {shlex.quote(str(plans[0].out))}")


def _run(plan: "CollectPlan") -> "Summary":
    from rtphys.cli.collect_progress import Lines, Live
    from rtphys.studies.collect import collect as run

    with resumable(), Live() if sys.stderr.isatty() else Lines() as shown:
        return run(plan, shown)


def _tell(summary: "Summary") -> list[str]:
    """Shows what came of a run; returns which tasks were given up, and why."""
    from rtphys.cli.collect_progress import summary_table
    from rtphys.cli.fitting import wide_console

    wide_console().print(summary_table(summary.tallies))
    minutes = summary.seconds / 60
    new = sum(tally.new_episodes for tally in summary.tallies)
    typer.echo(f"{new} new episodes in {minutes:.1f} min, in {summary.out}")
    return [f"{t.task}: {t.stopped}" for t in summary.tallies if t.stopped]
