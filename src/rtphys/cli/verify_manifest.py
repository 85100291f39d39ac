"""`rtphys verify-manifest`: is a dataset what it claims to be?"""

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from rtphys.verify import Report, verify

HELP = "Check every file of a dataset, and derive its physics again from the seeds."


def verify_manifest(
    path: Annotated[Path, typer.Argument(help="Folder that holds manifest.json.")] = Path("data"),
    quick: Annotated[
        bool, typer.Option("--quick", help="Trust the checksums: do not decode the pictures.")
    ] = False,
) -> None:
    """Check every file of a dataset, and derive its physics again from the seeds.

    Prints one line per problem. Exit code 0: sound, 1: not.
    """
    out = path.parent if path.name == "manifest.json" else path
    report = _with_bar(out, quick=quick)
    for problem in report.problems:
        typer.echo(_printable(str(problem)))
    for note in report.notes:
        typer.echo(_printable(f"note: {note}"), err=True)
    what = f"{report.episodes} episodes, {report.files} files, {report.bytes / 1e6:.1f} MB"
    verdict = "sound" if report.sound else f"{len(report.problems)} problems"
    typer.echo(_printable(f"{out}: {verdict} ({what})"), err=not report.sound)
    raise typer.Exit(0 if report.sound else 1)


def _printable(text: str) -> str:
    """File names may hold bytes that are no UTF-8; a terminal refuses them."""
    return text.encode("utf-8", "backslashreplace").decode()


def _with_bar(out: Path, *, quick: bool) -> Report:
    columns = (TextColumn("verifying"), BarColumn(), TextColumn("{task.percentage:.0f} %"))
    console = Console(stderr=True)
    with Progress(*columns, TimeRemainingColumn(), console=console, transient=True) as bar:
        row = bar.add_task("", total=None)
        return verify(
            out,
            quick=quick,
            progress=lambda done, total: bar.update(row, completed=done, total=total),
        )
