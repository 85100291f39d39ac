"""`rtphys render`, `merge`, `subset` and `convert`: a new dataset made of others."""

from pathlib import Path
from typing import Annotated

import typer

from rtphys.cli.derived import names_in, takes
from rtphys.cli.progress import campaign_progress
from rtphys.cli.tables import progress_bar
from rtphys.cli.terminal import command_line, resumable, say
from rtphys.core.errors import counted
from rtphys.studies.requests import RenderSpec

Dataset = Annotated[Path, typer.Argument(help="Folder that holds manifest.json.")]


@takes(RenderSpec)
def render(wanted: RenderSpec) -> None:
    """Draw a dataset again: other cameras, sizes, senses or looks, the same states.

    An episode that was recorded with `--sense states` is drawn from them. Any other is simulated
    again from its recipe, and drawn if that gives the very states that its label names.

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
    """Join datasets of one version: the shards of a collection, or any others.

    A task dataset that only one of them has is taken over as it is. Those that several have must
    have been collected alike, with different seeds; their episodes are numbered anew, by seed.

    Example:

        rtphys merge shard1 shard2 --out data
    """
    from rtphys.data.rewrite import merge as merge_datasets

    with resumable():
        names = merge_datasets(parts, out)
    _say_result(out, names)


def subset(
    dataset: Dataset,
    out: Annotated[Path, typer.Option(help="The new dataset's folder.")],
    task: Annotated[list[str] | None, typer.Option(help="Only these tasks.")] = None,
    config: Annotated[list[str] | None, typer.Option(help="Only these configurations.")] = None,
    seeds: Annotated[str, typer.Option(help="Only these seeds: 3,7 or 0:50.")] = "",
    drop_seeds: Annotated[str, typer.Option(help="All seeds but these.")] = "",
) -> None:
    """Copy a part of a dataset, its episodes numbered anew.

    Examples:

        rtphys subset data --out bells --task click_bell
        rtphys subset data --out small --seeds 0:50
        rtphys subset data --out cleaned --drop-seeds 17,23
    """
    from rtphys.data.attempts import Accepted
    from rtphys.data.dataset import Dataset
    from rtphys.data.manifest import TaskEntry
    from rtphys.data.rewrite import subset as write_subset
    from rtphys.data.selection import seed_set

    known = Dataset(dataset)
    tasks, configs = names_in(task or ()), names_in(config or ())
    for name in tasks:
        known.where(task=name)  # refuses a name that it lacks
    for name in configs:
        known.where(config=name)
    only, not_these = seed_set("seeds", seeds), seed_set("drop_seeds", drop_seeds)

    def chosen(entry: TaskEntry) -> bool:
        task_fits = not tasks or entry.spec.episode.task in tasks
        return task_fits and (not configs or entry.spec.name in configs)

    def kept(row: Accepted) -> bool:
        return (not seeds or row.seed in only) and row.seed not in not_these

    with resumable():
        names = write_subset(known.path, out, chosen, kept if seeds or drop_seeds else None)
    _say_result(out, names)


def _say_result(out: Path, names: list[str]) -> None:
    from rtphys.data.manifest import read_manifest

    episodes = sum(entry.episodes for entry in read_manifest(out).task_datasets.values())
    say(f"{counted(episodes, 'episodes')} in {counted(len(names), 'task datasets')}, in {out}")
    say_digest(out)
    say("to check every file: " + command_line("verify", out))


def say_digest(out: Path, err: bool = False) -> None:
    """What to publish beside a dataset, so that others can tell it from any other."""
    from rtphys.data import files
    from rtphys.data.layout import MANIFEST
    from rtphys.data.manifest import dataset_digest

    say(f"digest {dataset_digest(files.read(out / MANIFEST))}", err=err)


def convert(
    source: Dataset,
    out: Annotated[Path, typer.Option(help="Folder for the converted dataset.")],
    to: Annotated[str, typer.Option(help="Layout to write: legacy or native.")] = "legacy",
) -> None:
    """Write a dataset again in the other official layout.

    Arrays and videos stay the same. Native files hold standard RGB JPEGs, legacy files have red and
    blue exchanged, as RoboTwin's readers want them: so pictures are decoded and encoded again.

    Example:

        rtphys convert data --out data_legacy --to legacy
    """
    from rtphys.data.rewrite import convert as convert_dataset

    with progress_bar("converting") as bar:
        written = convert_dataset(source, out, to, bar)
    say("pictures of the other layout were encoded again, for their channel order", err=True)
    for name in written:
        say(f"{out}/{name}")
