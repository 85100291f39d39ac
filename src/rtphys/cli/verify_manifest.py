"""`rtphys verify-manifest`: is a dataset what it claims to be?"""

from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from rtphys.core.errors import BadValue
from rtphys.data.check_episode import Effort
from rtphys.data.dataset import Dataset
from rtphys.data.verified import default_path
from rtphys.data.verify import Problem, Report, verify
from rtphys.setting.setting import Recipe


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
        raise BadValue("--quick", "--deep", "choose one of them")
    if replay < 0:
        raise BadValue("--replay", replay, "0 or more")
    out = path.parent if path.name == "manifest.json" else path
    effort = Effort.QUICK if quick else Effort.DEEP if deep else Effort.NORMAL
    report = _with_bar(out, effort, None if fresh else default_path())
    if replay and report.sound:
        report.problems += _replayed(Dataset(out), replay)
    for problem in report.problems:
        typer.echo(_printable(str(problem)))
    for note in report.notes:
        typer.echo(_printable(f"note: {note}"), err=True)
    again = f", {replay} simulated again" if replay else ""
    what = f"{report.episodes} episodes, {report.files} files, {report.bytes / 1e6:.1f} MB{again}"
    verdict = "sound" if report.sound else f"{len(report.problems)} problems"
    typer.echo(_printable(f"{out}: {verdict} ({what})"), err=not report.sound)
    raise typer.Exit(0 if report.sound else 1)


def _printable(text: str) -> str:
    """File names may hold bytes that are no UTF-8; a terminal refuses them."""
    return text.encode("utf-8", "backslashreplace").decode()


def _with_bar(out: Path, effort: Effort, memory: Path | None) -> Report:
    columns = (TextColumn("verifying"), BarColumn(), TextColumn("{task.percentage:.0f} %"))
    console = Console(stderr=True)
    with Progress(*columns, TimeRemainingColumn(), console=console, transient=True) as bar:
        row = bar.add_task("", total=None)
        return verify(
            out,
            effort,
            memory=memory,
            progress=lambda done, total: bar.update(row, completed=done, total=total),
        )


def _replayed(dataset: Dataset, count: int) -> list[Problem]:
    """Makes episodes anew from their recipes, spread evenly over the dataset."""
    # Imported here: all other checks need no simulator.
    from rtphys.assets.pack import default_pack, pack_with
    from rtphys.episode.generate import attempt
    from rtphys.task.spec import load_task

    usual = default_pack()
    digests = {leaf.assets.get("digest", "") for leaf in dataset.leaves}
    packs = {digest: pack_with(digest) or usual for digest in digests}
    picked = np.unique(np.linspace(0, len(dataset) - 1, min(count, len(dataset))).astype(int))
    found = []
    for episode in (dataset[int(n)] for n in picked):
        meta = episode.meta
        try:
            recipe = Recipe.from_json(meta.recipe)
        except (KeyError, ValueError) as error:
            found.append(Problem(episode.paths.phys_meta, f"its recipe is not whole ({error})"))
            continue
        made = next(leaf.assets for leaf in dataset.leaves if leaf.task == meta.task)
        pack = packs[made.get("digest", "")]
        tried = attempt(recipe, load_task(recipe.task), pack)
        told = tried.recording.hash if tried.accepted and tried.recording else tried.reason
        if told != meta.state_hash:
            where = "" if made.get("digest") == pack.digest else ", with other assets than today's"
            text = f"simulated again it gives {told}, not state_hash {meta.state_hash}{where}"
            found.append(Problem(episode.paths.phys_meta, text))
    return found
