"""`rtphys check` and `try`: what an author runs on a task."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import degrees
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rtphys.cli.derived import JsonFile, takes
from rtphys.cli.progress import campaign, reasons
from rtphys.cli.tables import fitting_table, print_table, progress_bar
from rtphys.cli.terminal import say
from rtphys.core.errors import counted
from rtphys.spec.option import Option
from rtphys.studies.requests import CheckPlan, TryPlan
from rtphys.studies.resources import check_drawable

if TYPE_CHECKING:
    from rtphys.assets.pack import Pack
    from rtphys.studies.check import Score

MAX_FAILURES = 10


@dataclass(frozen=True)
class Output(JsonFile):
    """Where the results go beside the screen."""

    sheet: Annotated[
        Path | None,
        Option("Write a contact sheet here: a .png for one task, else a folder."),
    ] = None


@takes(CheckPlan, Output)
def check(plan: CheckPlan, output: Output) -> None:
    """Try a task's expert over many seeds, without pictures.

    The expert's actions are replayed open loop; two seeds are tried a second time and must give
    the same states; the baselines idle, random and jitter, which see nothing, must fail, and try
    only where the expert solves a seed. CPU-s is the mean time of an attempt. `rtphys try` shows
    one attempt.

    Exit code 1: the expert solved no seed of a protocol, a baseline succeeded, or a
    seed gave two outcomes.

    Examples:

        rtphys check click_bell --seeds 20
        rtphys check 'stack_*' --protocol clean,phys_random --sheet sheets
    """
    output.check()
    if output.sheet is not None:
        check_drawable()
    from rtphys.studies.check import check as run_check

    with campaign("trials") as (pack, listener):
        scores = run_check(plan, pack, listener)
    _show(scores)
    output.write([score.to_json() for score in scores])
    if output.sheet is not None:
        _draw(pack, scores, output.sheet)
    if wrong := complaints(scores):
        say("\n".join(wrong), err=True)
        raise typer.Exit(1)


@takes(TryPlan)
def try_(plan: TryPlan) -> None:
    """Try a task's expert once: its stages, and where it stuck.

    Exit code 1: the attempt failed. The same episode is attempted by `rtphys collect`.

    Examples:

        rtphys try place_empty_cup --seed 3 --picture stages.png
        rtphys try click_bell --protocol phys_random --video a.mp4
    """
    from rtphys.assets.pack import default_pack
    from rtphys.data.files import make_folder, replace_file
    from rtphys.data.jpeg import encode_png
    from rtphys.episode.render import write_video
    from rtphys.plan.kinematics import check_robot
    from rtphys.report.pictures import captioned
    from rtphys.sim import renderer
    from rtphys.studies.one_attempt import stage_ends, watch
    from rtphys.task.spec import load_task

    task = load_task(plan.task)
    if plan.drawn:
        check_drawable()
        renderer.configure()
    with progress_bar("building assets") as bar:
        pack = default_pack(bar)
    check_robot(pack, plan.episode.embodiment)
    spec = replace(plan.episode, task=plan.task)
    watched = watch(spec.at(plan.seed), task, pack)
    tried = watched.attempt
    table = fitting_table(["stage"], ["from", "to"])
    for name, begin, end in watched.stages:
        table.add_row(name, f"{begin:.2f} s", f"{end:.2f} s")
    print_table(table)
    why = f"{tried.reason}: {tried.detail}" if tried.reason else "accepted"
    say(f"{plan.task}, seed {plan.seed}, {spec.variation}: {why}")
    if watched.line:
        say(f"it ended at {watched.line}")
    if tried.reason and (placed := watched.placed) is not None:
        (x, y, z), up = placed.target.p, placed.target.R[:, 2]
        axis = ", ".join(f"{value + 0.0:.2g}" for value in up.round(2))
        say(
            f"the last place asked the {placed.side} hand to bring {placed.prop} to ({x:.3f}, "
            f"{y:.3f}, {z:.3f}) m, its z along ({axis}): tilted by "
            f"{degrees(placed.tilt):.0f} degrees from how it is held"
        )
    if plan.picture is not None:
        make_folder(plan.picture.parent)
        stages, pictures = stage_ends(tried, task, pack)
        replace_file(plan.picture, encode_png(captioned(pictures, stages)))
        say(str(plan.picture))
    if plan.video is not None and tried.instance is not None and tried.recording is not None:
        write_video(tried.instance, tried.recording, pack, plan.video)
        say(str(plan.video))
    if tried.reason:
        raise typer.Exit(1)


def complaints(scores: "Sequence[Score]") -> list[str]:
    """What no task may do; an expert that fails some seeds is not among it."""
    from rtphys.studies.check import BASELINES

    found: list[str] = []
    for score in scores:
        at = _name(score)
        if (tried := score.tried("expert")) and not score.accepted:
            found.append(f"{at}: the expert solves none of {counted(len(tried), 'seeds')}")
        for name in BASELINES:
            if solved := score.solved(name):
                seeds = counted(len(score.tried(name)), "seeds")
                found.append(f"{at}: the baseline {name} solves {solved} of {seeds}")
        if not score.deterministic:
            found.append(f"{at}: a seed that was tried twice went through different states")
    return found


def _name(score: "Score") -> str:
    return f"{score.spec.task}, {score.spec.protocol}"


def _show(scores: "Sequence[Score]") -> None:
    from rtphys.studies.check import BASELINES

    columns = ("accepted", "replay", *BASELINES, "CPU-s", "rejected")
    table = fitting_table(["task", "protocol"], columns)
    for score in scores:
        rates = [score.rate(name) for name in ("expert", *BASELINES)]
        table.add_row(
            score.spec.task,
            score.spec.protocol,
            f"{len(score.accepted)} / {len(score.tried('expert'))}",
            *("-" if rate is None else f"{100 * rate:.0f} %" for rate in rates),
            f"{score.cpu_seconds:.2f}",
            reasons(score.rejected),
        )
    print_table(table)
    for score in scores:
        for seed, one in list(score.failures.items())[:MAX_FAILURES]:
            say(f"{_name(score)}, seed {seed}: {one.reason}: {one.detail}")
        if (rest := len(score.failures) - MAX_FAILURES) > 0:
            say(f"{_name(score)}: and {rest} more")


def _draw(pack: "Pack", scores: "Sequence[Score]", out: Path) -> None:
    from rtphys.data.files import make_folder, replace_file
    from rtphys.data.jpeg import encode_png
    from rtphys.report.pictures import captioned
    from rtphys.studies.check import ends

    single = len(scores) == 1 and out.suffix == ".png"
    make_folder(out.parent if single else out)
    for score in scores:
        path = out if single else out / f"{score.spec.task}_{score.spec.protocol}.png"
        seed, stages, pictures = ends(pack, score)
        replace_file(path, encode_png(captioned(pictures, stages)))
        say(f"{path}: seed {seed}")
