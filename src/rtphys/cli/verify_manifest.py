"""`rtphys verify-manifest`: checks a dataset against its manifest."""

from pathlib import Path
from typing import Annotated

import typer
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from rtphys.cli.screen import Screen
from rtphys.cli.terminal import printable, say
from rtphys.core.errors import BadValue
from rtphys.data.check_episode import Effort
from rtphys.data.dataset import Dataset
from rtphys.data.verified import default_path
from rtphys.data.verify import Problem, Report, verify


def verify_manifest(
    path: Annotated[Path, typer.Argument(help="Folder that holds manifest.json.")] = Path("data"),
    quick: Annotated[
        bool, typer.Option("--quick", help="Trust the checksums: do not decode the pictures.")
    ] = False,
    deep: Annotated[
        bool, typer.Option("--deep", help="Decode the videos too; does it make physical sense?")
    ] = False,
    replay: Annotated[
        int, typer.Option(help="Simulate so many episodes again and compare their state hashes.")
    ] = 0,
    fresh: Annotated[
        bool, typer.Option("--fresh", help="Look again into what was found sound before.")
    ] = False,
) -> None:
    """Check every file of a dataset, and derive its physics again from the seeds.

    Prints one line per problem. Exit code 0: sound, 1: not.
    """
    if quick and deep:
        raise BadValue("quick", quick, "`deep` is given too; choose one of them")
    if replay < 0:
        raise BadValue("replay", replay, "0 or more")
    out = path.parent if path.name == "manifest.json" else path
    effort = Effort.QUICK if quick else Effort.DEEP if deep else Effort.NORMAL
    report = _with_bar(out, effort, None if fresh else default_path())
    if replay and report.sound:
        # Imported here: all other checks need no simulator.
        from rtphys.episode.prove import replayed

        report.problems += replayed(Dataset(out), replay)
    if report.sound and not report.episodes:
        empty = "it holds no episode: the run was aborted, or no attempt was accepted"
        report.problems.append(Problem(out / "manifest.json", empty))
    for problem in report.problems:
        say(printable(str(problem), one_line=True))
    for note in report.notes:
        say(printable(f"note: {note}", one_line=True), err=True)
    again = f", {replay} simulated again" if replay else ""
    what = f"{report.episodes} episodes, {report.files} files, {report.bytes / 1e6:.1f} MB{again}"
    verdict = "sound" if report.sound else f"{len(report.problems)} problems"
    say(f"{out}: {verdict} ({what})", err=not report.sound)
    raise typer.Exit(0 if report.sound else 1)


def _with_bar(out: Path, effort: Effort, memory: Path | None) -> Report:
    columns = (TextColumn("verifying"), BarColumn(), TextColumn("{task.percentage:.0f} %"))
    console = Screen(stderr=True)
    with Progress(*columns, TimeRemainingColumn(), console=console, transient=True) as bar:
        row = bar.add_task("", total=None)
        return verify(
            out,
            effort,
            memory=memory,
            progress=lambda done, total: bar.update(row, completed=done, total=total),
        )
