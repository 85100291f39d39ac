"""`rtphys certify`: which seeds a benchmark is made of."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import typer

from rtphys.cli.derived import AsJson, takes
from rtphys.cli.progress import campaign, reasons
from rtphys.cli.tables import fitting_table, print_rows
from rtphys.cli.terminal import Incomplete, say
from rtphys.core.errors import counted
from rtphys.studies.requests import CertificationRun, CertificationSpec

if TYPE_CHECKING:
    from rtphys.results.instances import InstanceList


COMMON = ("protocols", "feasible", "out", "workers")


@takes(CertificationSpec, CertificationRun, AsJson, common=COMMON)
def certify(spec: CertificationSpec, run: CertificationRun, output: AsJson) -> None:
    """Find the seeds on which policies are evaluated: those that the expert solves.

    No pictures are drawn. One list a task and protocol, with every seed that was tried. It may be
    interrupted: the same command goes on where it stopped.

    --reprove K finds no seeds: it solves the first K of each list again. After an edit of code that
    moves no state, the lists so get the present fingerprint in minutes. Exit code 1: one differs.

    Examples:

        rtphys certify click_bell --protocol clean,phys_random --out bench
        rtphys certify '*' --protocol clean --reprove 1 --out bench
    """
    from rtphys.studies.certify import certify as run_certification

    if run.reprove:
        _reprove(spec, run)
        return
    if left_out := run.left_out():
        text = f"left out, since the attribute acts on nothing there: {'; '.join(left_out)}"
        say(text, err=True)
    with campaign("feasible seeds") as (pack, listener):
        made = run_certification(spec, run, pack, listener)
    _show([one.instances for one in made], output.as_json)
    ends = [(one.progress.name, one.halted or one.progress.stopped) for one in made]
    if given_up := [f"{name}: {text}" for name, text in ends if text]:
        raise Incomplete("; ".join(given_up))


def _reprove(spec: CertificationSpec, run: CertificationRun) -> None:
    from rtphys.studies.certify import reprove

    with campaign("instances") as (pack, listener):
        studies = reprove(spec, run, pack, listener)
    for line in (line for study in studies for line in study.differences):
        typer.echo(line)
    renewed = sum(study.renewed for study in studies)
    stale = sum(study.stale and not study.renewed for study in studies)
    solved = sum(study.solved for study in studies)
    held = sum(not study.differences for study in studies)
    typer.echo(
        f"{held} of {counted(len(studies), 'lists')} hold "
        f"({counted(solved, 'instances')} solved again); {renewed} have a new header, "
        f"{stale} stay stale"
    )
    if held < len(studies):
        raise typer.Exit(1)


def _show(lists: "Sequence[InstanceList]", as_json: bool) -> None:
    def share(flags: Sequence[bool | None]) -> str:
        known = [flag for flag in flags if flag is not None]
        return f"{sum(known)} / {len(known)}" if known else "-"

    columns = (
        "feasible",
        "attempts",
        "replay",
        "open-loop replay of clean",
        "reasons for infeasibility",
    )
    table, rows = fitting_table(["task", "protocol"], columns), list[dict[str, object]]()
    for made in lists:
        replayed = [one.replay for one in made.feasible]
        twin = [one.twin for one in made.feasible]
        counts = (str(len(made.feasible)), str(made.attempts), share(replayed), share(twin))
        table.add_row(made.task, made.protocol, *counts, reasons(made.rejected))
        rows.append(
            {
                "task": made.task,
                "protocol": made.protocol,
                "feasible": [one.seed for one in made.feasible],
                "attempts": made.attempts,
                "rejected": dict(made.rejected),
                "replayed": replayed,
                "twin": twin,
            }
        )
    print_rows(table, rows, as_json)
