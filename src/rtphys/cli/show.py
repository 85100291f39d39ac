"""`rtphys show`: one episode, in the terminal and as pictures."""

from itertools import pairwise
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from rich.table import Table
from rich.text import Text

from rtphys.cli.screen import Screen
from rtphys.cli.terminal import say
from rtphys.core.errors import BadFile, BadValue
from rtphys.data import jpeg
from rtphys.data.dataset import Dataset, Episode, find_episode
from rtphys.data.files import make_folder, replace_file
from rtphys.report.joint_plot import joint_plot
from rtphys.report.sheet import contact_sheet


def show(
    path: Annotated[Path, typer.Argument(help="Any file of an episode, or a dataset folder.")],
    number: Annotated[int, typer.Option(help="Which episode of a dataset folder.")] = 0,
    out: Annotated[
        Path | None, typer.Option(help="Also write a contact sheet and a joint plot here.")
    ] = None,
) -> None:
    """What an episode holds: task, physics, stages, contacts; with --out its pictures too."""
    episode = _episode(path, number)
    console = Screen()
    console.print(_summary(episode))
    console.print(_physics(episode))
    console.print(_stages(episode))
    if out is not None:
        for written in _pictures(episode, out):
            say(str(written))


def _episode(path: Path, number: int) -> Episode:
    if not path.is_dir():
        return find_episode(path)
    dataset = Dataset(path)
    if not len(dataset):
        raise BadFile(path, "the dataset holds no episode")
    if not 0 <= number < len(dataset):
        raise BadValue("number", number, f"the dataset holds episodes 0 to {len(dataset) - 1}")
    return dataset[number]


def _summary(episode: Episode) -> Table:
    frames, verdict = episode.frames, episode.meta.verdict
    moved = {
        name: float(np.ptp(pose[:, :3], axis=0).max()) for name, pose in frames.object_poses.items()
    }
    rows = {
        "task": f"{episode.task}, seed {episode.seed}, {episode.protocol}",
        "says": "; ".join(episode.instructions.seen[:2]),
        "frames": f"{len(episode)}, {frames.time[-1] - frames.time[0]:.2f} s, 16.67 Hz",
        "cameras": ", ".join(episode.cameras),
        "success": f"after {verdict.first_success_time} s, held: {verdict.held}",
        "moved": ", ".join(f"{name} {reach * 100:.1f} cm" for name, reach in moved.items()),
        "state hash": episode.meta.state_hash[:16],
    }
    table = Table(show_header=False, box=None)
    for key, text in rows.items():
        table.add_row(Text(key, style="bold"), text)
    return table


def _physics(episode: Episode) -> Table:
    table = Table("attribute", "value", "unit", title="Physics")
    for key, label in episode.meta.attributes.items():
        value = label.value
        numbers = [] if value is None else [f"{v:.4g}" for v in np.ravel(value)]
        table.add_row(
            key,
            (", ".join(numbers) or "asset's own") + ("" if label.acts else ", acts on nothing"),
            label.unit,
            style="" if label.varied and label.acts else "dim",
        )
    return table


def _stages(episode: Episode) -> Table:
    frames = episode.frames
    table = Table("stage", "from", "to", "touched", title="Stages")
    edges = [0, *(np.flatnonzero(np.diff(frames.stage)) + 1).tolist(), len(frames)]
    for first, end in pairwise(edges):
        touched = [
            f"{name} ({side})"
            for name, contact in frames.contacts.items()
            for side, column in (("left", 0), ("right", 1))
            if contact[first:end, column].any()
        ]
        table.add_row(
            frames.stages[int(frames.stage[first])],
            f"{frames.time[first]:.2f} s",
            f"{frames.time[end - 1]:.2f} s",
            ", ".join(touched),
        )
    return table


def _pictures(episode: Episode, out: Path) -> list[Path]:
    make_folder(out)
    stem = f"{episode.task}_{episode.protocol}_{episode.number}"
    sheet, plot = out / f"{stem}.png", out / f"{stem}_joints.svg"
    replace_file(sheet, jpeg.encode_png(contact_sheet(episode)))
    replace_file(plot, joint_plot(episode).encode())
    return [sheet, plot]
