"""`rtphys export`, `verify-export` and `robotwin-root`: what other tools read."""

from pathlib import Path
from typing import Annotated

import typer

from rtphys.cli.derived import names_in
from rtphys.cli.tables import progress_bar
from rtphys.cli.terminal import say
from rtphys.core.errors import counted

SHOWN = 20  # differences, at most

export = typer.Typer(
    add_completion=False,
    no_args_is_help=True,
    help="Write a dataset in the format of another tool.",
)
Dataset = Annotated[Path, typer.Argument(help="Folder that holds manifest.json.")]


@export.command()
def lerobot(
    dataset: Dataset,
    out: Annotated[Path, typer.Option(help="New folder to write.")],
    version: Annotated[str, typer.Option(help="v3.0, or v2.1 for openpi and GR00T.")] = "v3.0",
    task: Annotated[str | None, typer.Option(help="Only this task.")] = None,
    protocol: Annotated[str | None, typer.Option(help="Only this protocol.")] = None,
    config: Annotated[str | None, typer.Option(help="Only this configuration.")] = None,
    seed: Annotated[str, typer.Option(help="Only these seeds: 3,7 or 0:50.")] = "",
    camera_names: Annotated[
        str, typer.Option(help="aloha, robotwin, or pairs: head_camera=top,left_camera=wrist.")
    ] = "aloha",
    features: Annotated[
        list[str] | None,
        typer.Option(help="Also in each frame: physics, environment_state, contact, touch, depth."),
    ] = None,
    sentences: Annotated[
        str, typer.Option(help="Of each episode: first, all in turns, or task for the task's name.")
    ] = "first",
) -> None:
    """Write a LeRobot dataset.

    Each episode's physics is in the columns phys/<attribute>. The same command after a kill goes
    on where it ended.

    Examples:

        rtphys export lerobot data --out lr
        rtphys export lerobot data --version v2.1 --features physics --out lr21
    """
    # Imported here: pyarrow comes with the extra `rtphys[lerobot]`.
    from rtphys.data.dataset import Dataset
    from rtphys.data.selection import Selection
    from rtphys.export.lerobot import ExportSpec, export_lerobot
    from rtphys.export.lerobot_plan import READERS

    spec = ExportSpec(version, camera_names, tuple(names_in(features or [])), sentences)
    chosen = Selection(task, config, seed).of(Dataset(dataset).where(protocol=protocol))
    with progress_bar("exporting") as bar:
        export_lerobot(chosen, out, spec, bar)
    say(f"{out}: {counted(len(chosen), 'episodes')}, LeRobot {version}, for {READERS[version]}")


@export.command()
def card(
    dataset: Dataset,
    name: Annotated[str, typer.Option(help="Name of the dataset.")] = "rtphys demonstrations",
    licence: Annotated[str, typer.Option("--license", help="SPDX identifier.")] = "apache-2.0",
    url: Annotated[str, typer.Option(help="Address where it will be published.")] = "",
    published: Annotated[str, typer.Option(help="Date of publication, YYYY-MM-DD.")] = "",
) -> None:
    """Write README.md for Hugging Face and croissant.json beside the manifest."""
    from rtphys.data.dataset import Dataset
    from rtphys.export.card import CardText, write_card

    for path in write_card(Dataset(dataset), CardText(name, licence, url, published)):
        say(str(path))


def verify_export(
    export: Annotated[Path, typer.Argument(help="Folder that `rtphys export lerobot` wrote.")],
    dataset: Annotated[Path, typer.Argument(help="The dataset that it was made of.")],
) -> None:
    """Compare every number and every picture of a LeRobot export with its dataset.

    Exit code 1 if something differs.

    Example:

        rtphys verify-export lr data
    """
    # Imported here: pyarrow comes with the extra `rtphys[lerobot]`.
    from rtphys.data.dataset import Dataset
    from rtphys.export.lerobot_verify import verify_export as compare

    with progress_bar("comparing") as bar:
        problems = compare(export, Dataset(dataset), bar)
    for problem in problems[:SHOWN]:
        say(problem)
    if problems:
        say(f"{export}: {len(problems)} differences", err=True)
        raise typer.Exit(1)
    say(f"{export}: every number and picture is the dataset's")


def robotwin_root(
    folder: Annotated[Path, typer.Argument(help="New folder, or one that this command wrote.")],
) -> None:
    """Write a folder that looks like RoboTwin to its launch scripts.

    Link policies into its policy/ folder, then run inside it, for example:
    python script/eval_policy.py --config policy/NAME/deploy_policy.yml --overrides
    --task_name click_bell --task_config phys_random --policy_name NAME
    """
    from rtphys.assets.pack import default_pack
    from rtphys.robotwin_root.write import write_root

    written = write_root(folder, default_pack())
    say(f"{folder}: {counted(len(written), 'files')}; link your policies into {folder / 'policy'}")
