"""Commands that make datasets of others, check them, and write what other tools read."""

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

import typer

from rtphys.cli.derived import takes
from rtphys.cli.screen import campaign_progress, progress_bar
from rtphys.cli.terminal import Incomplete, command_line, printable, resumable, say
from rtphys.core.errors import BadValue, counted
from rtphys.data import files
from rtphys.data import verify as checking
from rtphys.data.check_episode import Effort, Problem
from rtphys.data.dataset import Dataset
from rtphys.data.layout import MANIFEST
from rtphys.data.manifest import dataset_digest, read_manifest
from rtphys.data.rewrite import convert as convert_dataset
from rtphys.data.rewrite import merge as merge_datasets
from rtphys.data.rewrite import subset as write_subset
from rtphys.data.rewrite import unfinished
from rtphys.data.selection import HOLDS, DataFolder, Selection, seed_set
from rtphys.data.state_digests import compare, find_digests
from rtphys.export.card import CardText, write_card
from rtphys.export.lerobot_plan import READERS, ExportSpec
from rtphys.spec.option import Option, Seed, Workers, checked_dataclass
from rtphys.studies.requests import RenderSpec

Folder = Annotated[Path, typer.Argument(help=HOLDS)]
SHOWN = 20  # differences of an export, at most


@takes(RenderSpec)
def render(wanted: RenderSpec) -> None:
    """Draw a dataset again, with other cameras, sizes, senses or looks.

    The states stay the same. An episode that was recorded with `--sense states` is drawn from
    them. Any other episode is simulated again from its recipe, and drawn if the states are those
    that its label names.

    Examples:

        rtphys render data --add depth,segmentation --out with_depth
        rtphys render data --look official_random --size 128x96 --out looks
    """
    from rtphys.studies.render import render as draw_again

    with resumable(), campaign_progress("episodes") as listener:
        done = draw_again(wanted, listener)
    say(f"{counted(done.episodes, 'episodes')} in {wanted.out}")
    if done.compared:
        share = f"{done.compared - done.differing} of {done.compared}"
        say(f"{share} pictures that were stored before have come out the same, byte for byte")
    if done.differing:
        say("the others differ, as with another device, driver or version of SAPIEN", err=True)
    say("to check every file: " + command_line("verify", wanted.out))


def merge(
    parts: Annotated[list[Path], typer.Argument(help="Folders of datasets, in any order.")],
    out: Annotated[Path, typer.Option(help="The new dataset's folder.")] = Path("data"),
) -> None:
    """Join datasets, such as the shards of a collection.

    All must have the same version. A task dataset that only one of them has is copied as it is.
    One that several have must have been collected with the same options and different seeds; its
    episodes are renumbered by seed. Exit code 4: joined, but some parts seem to be unfinished.

    Example:

        rtphys merge shard1 shard2 --out data
    """
    lacking = unfinished(parts)
    for clause in lacking:  # before what may take hours
        say(printable(f"unfinished: {clause}", one_line=True), err=True)
    with resumable(), progress_bar("merging") as bar:
        names = merge_datasets(parts, out, bar)
    _say_result(out, names)
    if lacking:
        many = counted(len(lacking), "task datasets")
        cure = "repeat the commands that collect them, and merge into a new folder"
        raise Incomplete(f"{many} of the parts seem to be unfinished: {cure}")


@dataclass(frozen=True)
class Cut:
    """Which part of a dataset is copied, and where to."""

    dataset: DataFolder
    out: Annotated[Path, Option("The new dataset's folder.")]
    part: Selection = field(default_factory=Selection)
    drop_seed: Annotated[str, Option("All seeds except these.")] = ""


@takes(Cut)
def subset(cut: Cut) -> None:
    """Copy a part of a dataset, and renumber its episodes.

    Nothing is simulated or drawn. The failures of the chosen seeds are copied too.

    Examples:

        rtphys subset data --out bells --task click_bell
        rtphys subset data --out small --seed 0:50
        rtphys subset data --out cleaned --drop-seed 17,23
    """
    chosen = cut.part.of(Dataset(cut.dataset))
    if cut.drop_seed:
        there = {row.seed for part in chosen.parts for row in part.rows()}
        chosen = chosen.where(seeds=there - seed_set("drop_seed", cut.drop_seed))
    with resumable(), progress_bar("copying") as bar:
        names = write_subset(chosen, cut.out, bar)
    _say_result(cut.out, names)


def _say_result(out: Path, names: list[str]) -> None:
    entries = read_manifest(out).task_datasets  # of earlier commands, too
    episodes = sum(entries[name].episodes for name in names)
    say(f"{counted(episodes, 'episodes')} in {counted(len(names), 'task datasets')}, in {out}")
    say_digest(out)
    say("to check every file: " + command_line("verify", out))


def say_digest(out: Path, err: bool = False) -> None:
    """What to publish beside a dataset, so that others can tell it from any other."""
    say(f"digest {dataset_digest(files.read(out / MANIFEST))}", err=err)


def convert(
    source: Folder,
    out: Annotated[Path, typer.Option(help="Folder for the converted dataset.")],
    to: Annotated[str, typer.Option(help="Layout to write: legacy or native.")] = "legacy",
) -> None:
    """Write a dataset again in the other official layout.

    Arrays and videos stay the same. Native files hold standard RGB JPEGs, legacy files have red
    and blue exchanged, as RoboTwin's readers expect, so pictures are decoded and encoded again.

    Example:

        rtphys convert data --out data_legacy --to legacy
    """
    with resumable(), progress_bar("converting") as bar:
        written = convert_dataset(source, out, to, bar)
    say("pictures of the other layout were encoded again, for their channel order", err=True)
    for name in written:
        say(f"{out}/{name}")


DIGEST = re.compile("sha256:[0-9a-f]{64}")


@checked_dataclass(frozen=True)
class Checks:
    """What is checked of a dataset, and against what."""

    path: DataFolder = Path("data")
    quick: Annotated[bool, Option("Check checksums and labels only; decode no pictures.")] = False
    deep: Annotated[bool, Option("Also decode videos, and check that motions are plausible.")] = (
        False
    )
    fresh: Annotated[bool, Option("Also check files that were found correct before.")] = False
    expect: Annotated[
        str, Option("What the dataset must be: a digest, or the name of a published collection.")
    ] = ""
    reproduce: Annotated[
        Seed, Option("Simulate N episodes and N rejected seeds again, and compare.")
    ] = 0
    workers: Workers = None

    def __post_init__(self) -> None:
        if self.quick and self.deep:
            raise BadValue("quick", self.quick, "`deep` is given too; choose one of them")
        if self.expect.startswith("sha256:") and not DIGEST.fullmatch(self.expect):
            raise BadValue("expect", self.expect, "`sha256:` and 64 hexadecimal digits")

    @property
    def published(self) -> str:
        """Name of a collection whose states and labels it must have; empty: of none."""
        return "" if DIGEST.fullmatch(self.expect) else self.expect


@takes(Checks)
def verify(checks: Checks) -> None:
    """Check every file, and derive the physics again from the seeds.

    Prints one line per problem. Exit code 0: correct, 1: not. docs/trust.md says what each option
    proves.

    Examples:

        rtphys verify data
        rtphys verify data --deep --reproduce 5
        rtphys verify data --expect training_v1
    """
    expected = find_digests(checks.published) if checks.published else None
    out = checks.path.parent if checks.path.name == MANIFEST else checks.path
    effort = Effort.QUICK if checks.quick else Effort.DEEP if checks.deep else Effort.NORMAL
    memory = None if checks.fresh else checking.default_path()
    with progress_bar("verifying") as bar:
        report = checking.verify(out, effort, memory=memory, progress=bar)
    doubt = "" if report.sound else "files are damaged or missing"  # what follows asks whose it is
    wrong, made = list[str](), ""
    if report.sound and not (report.episodes or report.failures):
        wrong.append("it holds no episode: the run was aborted, or no attempt was accepted")
    if expected and report.sound:
        compared = compare(Dataset(out), expected, checks.published)
        report.problems += compared.problems
        report.notes.append(str(compared))
        if not compared.tasks:
            wrong.append(f"it holds no episode of {checks.published}")
    elif checks.expect and report.digest:
        if checks.expect != report.digest:
            wrong.append(f"the dataset is {report.digest}, not the expected {checks.expect}")
        if report.newer:
            newer = counted(report.newer, "newer attempts")
            wrong.append(f"{newer} in the folder, which the digest does not cover")
    report.problems += [Problem(out / MANIFEST, text) for text in wrong]
    if checks.reproduce and report.sound:
        # Imported here: all other checks need no simulator.
        from rtphys.studies.reproduce import reproduced

        with campaign_progress("seeds") as listener:
            found = reproduced(out, checks.reproduce, checks.workers, listener)
        report.problems += found.problems
        report.notes += found.notes
        doubt = "it was not made again as it is" if found.problems else ""
        for name in (*found.episodes, *found.rejections):
            say(printable(f"made again: {name}", one_line=True), err=True)
        made = f"; {counted(len(found.episodes), 'episodes')} made again"
        made += f", {counted(len(found.rejections), 'rejected seeds')} tried again"
    for problem in report.problems:
        say(printable(str(problem), one_line=True))
    for note in report.notes:
        say(printable(f"note: {note}", one_line=True), err=True)
    if report.digest and not doubt:
        say(f"digest {report.digest}")
    elif report.digest:
        say(f"it is not the dataset {report.digest}, whose manifest it has: {doubt}")
    if report.damaged:
        cure = command_line("collect", "--repair", "--out", out)
        say(f"to make damaged and missing files again: {cure}", err=True)
    counts = [counted(report.episodes, "episodes")]
    counts += [counted(report.failures, "kept failures")] if report.failures else []
    counts += [counted(report.files, "files"), f"{report.bytes / 1e6:.1f} MB{made}"]
    verdict = "sound" if report.sound else counted(len(report.problems), "problems")
    say(f"{out}: {verdict} ({', '.join(counts)})", err=not report.sound)
    raise typer.Exit(not report.sound)


export = typer.Typer(add_completion=False, no_args_is_help=True)


@dataclass(frozen=True)
class Exported:
    """Which episodes are exported, and where to."""

    dataset: DataFolder
    out: Annotated[Path, Option("New folder to write.")]
    protocol: Annotated[
        str | None, Option("Only this protocol, with its sweeps and held values.")
    ] = None
    part: Selection = field(default_factory=Selection)


@export.command()
@takes(Exported, ExportSpec)
def lerobot(wanted: Exported, spec: ExportSpec) -> None:
    """Write a LeRobot dataset.

    Each episode's physics is in the columns phys/<attribute>. If the command is killed, the same
    command continues where it stopped.

    Examples:

        rtphys export lerobot data --out lr
        rtphys export lerobot data --version v2.1 --features physics --out lr21
    """
    # Imported here: pyarrow comes with the extra `rtphys[lerobot]`.
    from rtphys.export.lerobot import export_lerobot

    chosen = wanted.part.of(Dataset(wanted.dataset).where(protocol=wanted.protocol))
    notes = list[str]()
    with progress_bar("exporting") as bar:
        export_lerobot(chosen, wanted.out, spec, bar, notes.append)
    for note in notes:
        say(note, err=True)
    made = f"{counted(len(chosen), 'episodes')}, LeRobot {spec.version}"
    say(f"{wanted.out}: {made}, for {READERS[spec.version]}")


@dataclass(frozen=True)
class Described:
    """Which dataset gets a card."""

    dataset: DataFolder


@export.command()
@takes(Described, CardText)
def card(described: Described, text: CardText) -> None:
    """Write README.md for Hugging Face and croissant.json beside the manifest."""
    for path in write_card(Dataset(described.dataset), text):
        say(str(path))


def verify_export(
    export: Annotated[Path, typer.Argument(help="Folder that `rtphys export lerobot` wrote.")],
    dataset: Annotated[Path, typer.Argument(help="The dataset that it was made from.")],
) -> None:
    """Compare a LeRobot export with its dataset.

    It also compares every picture. Exit code 1 if something differs.

    Example:

        rtphys verify-export lr data
    """
    # Imported here: pyarrow comes with the extra `rtphys[lerobot]`.
    from rtphys.export.lerobot_verify import verify_export as compare

    with progress_bar("comparing") as bar:
        problems = compare(export, Dataset(dataset), bar)
    for problem in problems[:SHOWN]:
        say(problem)
    if problems:
        say(f"{export}: {counted(len(problems), 'differences')}", err=True)
        raise typer.Exit(1)
    say(f"{export}: every number and picture is the dataset's")
