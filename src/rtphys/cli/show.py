"""`rtphys show`, `view` and `report`: an episode in the terminal or Rerun, a dataset as a page."""

import os
import shlex
import shutil
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from rich.text import Text

from rtphys.assets.pack import pack_with
from rtphys.cli.derived import AsJson, takes
from rtphys.cli.screen import fitting_table, print_table, progress_bar
from rtphys.cli.terminal import say, say_json
from rtphys.core.errors import BadFile, BadValue, MissingAsset, RtphysError
from rtphys.data.dataset import Dataset, Episode
from rtphys.data.files import make_folder, replace_file
from rtphys.data.jpeg import encode_png
from rtphys.data.json_text import check_spelled
from rtphys.data.layout import MANIFEST, REPORT
from rtphys.data.selection import One
from rtphys.results import read_results
from rtphys.results.evaluation import is_evaluation
from rtphys.spec.option import Option

SUFFIX = ".rrd"
VIEWER = "rerun"  # the program that shows a recording


Where = Annotated[Path, Option("A dataset folder, or any file of an episode.", positional=True)]


@dataclass(frozen=True)
class Shown:
    """Where an episode is looked for, and where its pictures go."""

    path: Where
    out: Annotated[
        Path | None, Option("Also write a contact sheet and a joint plot into this folder.")
    ] = None


@dataclass(frozen=True)
class ShownInRerun:
    """Where an episode is looked for, and where its recording goes."""

    path: Where
    out: Annotated[Path | None, Option("Write an .rrd file instead of opening the viewer.")] = None


def chosen(path: Path, which: One) -> Episode:
    """The first episode that fits; says how many others do, if it was not any that was meant."""
    first, *others = which.of_path(path)
    if others and which != One():
        text = f"the first of {len(others) + 1} that fit: {first.name}"
        say(f"{text}; --task, --config, --embodiment or --seed chooses", err=True)
    return first


@takes(Shown, One, AsJson)
def show(shown: Shown, which: One, output: AsJson) -> None:
    """Show one episode in the terminal or as a picture.

    It shows the task, physics, stages and contacts; for a kept failure, also what went wrong, and
    when.

    Examples:

        rtphys show data --episode 3 --out pictures
        rtphys show data --failure 0
        rtphys show data --task click_bell --config clean --seed 17
    """
    episode = chosen(shown.path, which)
    frames, verdict, failure = episode.frames, episode.meta.verdict, episode.failure
    moved = {
        name: float(np.ptp(pose[:, :3], axis=0).max()) for name, pose in frames.object_poses.items()
    }
    stages = _stages(episode)
    if output.as_json:
        labels = episode.meta.attributes.items()
        say_json(
            {
                "task": episode.task,
                "seed": episode.seed,
                "protocol": episode.protocol,
                "config": episode.config,
                "embodiment": episode.embodiment,
                "instructions": list(episode.instructions.seen),
                "frames": len(episode),
                "seconds": float(frames.time[-1] - frames.time[0]),
                "cameras": list(episode.cameras),
                "first_success_time": verdict.first_success_time,
                "held": verdict.held,
                "strain": verdict.strain.model_dump(),
                "failure": None if failure is None else failure.model_dump(),
                "moved": moved,
                "state_hash": episode.meta.state_hash,
                "physics": {key: label.model_dump() for key, label in labels},
                "stages": [
                    {"stage": name, "from": start, "to": end, "touched": touched}
                    for name, start, end, touched in stages
                ],
            }
        )
    else:
        _show_facts(episode, moved, stages)
    if (out := shown.out) is not None:
        from rtphys.report.pictures import contact_sheet, joint_plot

        make_folder(out)
        stem = episode.name
        sheet, plot = out / f"{stem}.png", out / f"{stem}_joints.svg"
        replace_file(sheet, encode_png(contact_sheet(episode)))
        replace_file(plot, joint_plot(episode).encode())
        say(f"{sheet}\n{plot}", err=output.as_json)


def _show_facts(episode: Episode, moved: dict[str, float], stages: "Sequence[Stage]") -> None:
    verdict, failure, time = episode.meta.verdict, episode.failure, episode.frames.time
    after = verdict.first_success_time
    rows = {
        "task": f"{episode.task}, seed {episode.seed}, {episode.config}, {episode.embodiment}",
        "says": "; ".join(episode.instructions.seen[:2]),
        "frames": f"{len(episode)}, {time[-1] - time[0]:.2f} s, 16.67 Hz",
        "cameras": ", ".join(episode.cameras),
        "success": "never" if after is None else f"after {after:.2f} s",
    }
    if after is not None:
        rows["still true"] = f"{'yes' if verdict.held else 'no'}, 0.5 s after the end"
    strain = verdict.strain
    met, joint = (f" ({name})" if name else "" for name in (strain.pair, strain.joint))
    torque = f"largest torque {100 * strain.torque:.0f} % of its motor's{joint}"
    rows["strain"] = f"largest force on a link {strain.force:.1f} N{met}, {torque}"
    if failure is not None:
        why = f"{failure.reason}: {failure.detail}" if failure.detail else failure.reason
        whose = f" of {failure.object}" if failure.object else ""
        when = f"{failure.event}{whose} at frame {failure.frame}, {failure.time:.2f} s"
        rows["failure"] = f"{why}; {when}"
    rows["moved"] = ", ".join(f"{name} {reach * 100:.1f} cm" for name, reach in moved.items())
    rows["state hash"] = episode.meta.state_hash[:16]
    table = fitting_table(["what"], ["value"])
    for key, text in rows.items():
        table.add_row(Text(key, style="bold"), text)
    print_table(table)
    table = fitting_table(["attribute"], ["value", "unit"], "\nPhysics")
    labels = episode.meta.attributes
    for key, label in labels.items():
        numbers = [] if label.value is None else [f"{v:.4g}" for v in np.ravel(label.value)]
        note = label.note and f", {label.note}"
        style = "" if label.varied and not note else "dim"
        table.add_row(key, (", ".join(numbers) or "asset's own") + note, label.unit, style=style)
    if unmeasured := [k for k, one in labels.items() if one.could_act and one.acted is None]:
        table.caption = f"not measured whether they acted: {', '.join(unmeasured)}"
    print_table(table)
    table = fitting_table(["stage"], ["from", "to", "touched"], "\nStages")
    for name, start, end, touched in stages:
        table.add_row(name, f"{start:.2f} s", f"{end:.2f} s", ", ".join(touched))
    print_table(table)


Stage = tuple[str, float, float, list[str]]


def _stages(episode: Episode) -> list[Stage]:
    """Name of each stage, when it begins and ends [s], and what was touched, with which hand."""
    frames = episode.frames
    edges = [0, *(np.flatnonzero(np.diff(frames.stage)) + 1).tolist(), len(frames)]
    return [
        (
            frames.stages[int(frames.stage[first])],
            float(frames.time[first]),
            float(frames.time[end - 1]),
            [
                f"{name} ({side})"
                for name, contact in frames.contacts.items()
                for side, column in (("left", 0), ("right", 1))
                if contact[first:end, column].any()
            ],
        )
        for first, end in pairwise(edges)
    ]


@takes(ShownInRerun, One)
def view(shown: ShownInRerun, which: One) -> None:
    """Show an episode in Rerun: cameras, 3D, forces, physics, stages.

    For a kept failure, the instant at which it went wrong is marked.

    Examples:

        rtphys view data --episode 3
        rtphys view data --failure 0 --out failure.rrd
    """
    out = shown.out
    if out is not None and out.suffix != SUFFIX:
        raise BadValue("out", str(out), f"its name ends in {SUFFIX}")
    if out is not None:  # Rerun takes no other name
        check_spelled("out", str(out), "it is not UTF-8")
    episode = chosen(shown.path, which)
    from rtphys.episode.solids import solids
    from rtphys.view import VERSION, record

    for folder in episode.paths.hdf5.parents:
        entries = Dataset(folder).task_datasets if (folder / MANIFEST).is_file() else ()
        mine = (e for e in entries if episode.paths.hdf5.is_relative_to(e.below(folder).folder))
        if (entry := next(mine, None)) is not None:  # a task may be there with two robots
            break
    else:
        raise BadFile(episode.paths.hdf5, "belongs to no dataset")
    digest = entry.resolved.assets.get("digest", "")
    if (pack := pack_with(digest)) is None:
        raise MissingAsset(f"assets of digest {digest}", shown.path, episode.task)
    scene = solids(episode, pack)
    if out is None:
        check_viewer(VERSION)
        record(episode, scene)
        return
    make_folder(out.parent)
    record(episode, scene, out)
    size = f"{out.stat().st_size / 1e6:.1f} MB"
    say(f"{out} ({size}, written by Rerun {VERSION}); to open it: rerun {shlex.quote(str(out))}")


def check_viewer(version: str) -> None:
    """Puts the viewer on PATH, where Rerun looks for it; it lies beside this Python.

    Raises `RtphysError`: there is none, or it has another version than what writes the recording.
    """
    os.environ["PATH"] = f"{Path(sys.executable).parent}{os.pathsep}{os.environ.get('PATH', '')}"
    viewer = shutil.which(VIEWER)
    if viewer is None:
        raise RtphysError(f"the viewer {VIEWER!r} is not on PATH; write a file with --out x.rrd")
    said = subprocess.run([viewer, "--version"], capture_output=True, text=True).stdout
    found = said.removeprefix("rerun-cli").split()[:1]
    if found != [version]:
        own = f"{viewer} is Rerun {' '.join(found) or '(unknown)'}"
        raise RtphysError(
            f"{own}, the recording is written by {version}; `pip install "
            f"rerun-sdk=={version}`, or write a file with --out x.rrd"
        )


def report(
    dataset: Annotated[
        Path, typer.Argument(help="A dataset, or a folder that rtphys evaluate has written.")
    ],
    out: Annotated[
        Path | None, typer.Option(help="HTML file of a dataset; default: report.html in it.")
    ] = None,
    task: Annotated[str | None, typer.Option(help="Only this task.")] = None,
) -> None:
    """Show a dataset, or an evaluation, on one HTML page.

    For a dataset: counts, acceptance, histograms of the physics, and every episode's video. For an
    evaluation: success rates, which physics breaks the policy, and each failure, with the video
    that `rtphys evaluate --video failures` wrote.

    Examples:

        rtphys report data --task click_bell
        rtphys report eval/random
    """
    if not (dataset / MANIFEST).exists() and is_evaluation(dataset):
        from rtphys.report.evaluation_page import write_evaluation_report

        for name, value in (("out", out), ("task", task)):
            if value is not None:
                allowed = "it belongs to a dataset; the page of an evaluation is report.html in it"
                raise BadValue(name, str(value), allowed)
        say(str(write_evaluation_report(read_results(dataset))))
        return
    from rtphys.report.page import write_report

    chosen = Dataset(dataset).where(task)
    page = out or chosen.path / REPORT
    with progress_bar("reading") as bar:
        write_report(chosen, page, bar)
    say(str(page))
