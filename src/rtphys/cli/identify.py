"""`rtphys identify`: which physical attributes can be inferred from what a robot senses."""

import json
from dataclasses import asdict

import typer

from rtphys.cli.derived import takes
from rtphys.cli.options import MapOutput
from rtphys.cli.stopping import Incomplete, resumable
from rtphys.cli.terminal import say
from rtphys.studies.identify.plan import IdentifyPlan


@takes(IdentifyPlan, MapOutput)
def identify(plan: IdentifyPlan, output: MapOutput) -> None:
    """Find which physics can be inferred from what a robot senses, and which signal carries it.

    The expert's episodes, without pictures, become features: statistics of
    commands, measured joints, tracking, effort and touch in each stage, and
    nothing of any object. An estimator learns each attribute from them and is
    judged on other seeds (R2; 0 says nothing, 1 all), on shuffled labels, and
    beyond the range that it learnt from. It may be interrupted: the same
    command goes on where it stopped.

    Examples:

        rtphys identify --task click_bell,lift_pot --episodes 100
        rtphys --library probes identify --task heft,rub --out identify_probes
        rtphys identify --task lift_pot --estimator python:mine.py:Mine
        rtphys compare identify/trees.json identify/Mine.json
    """
    plan.check()
    from rtphys.assets.pack import default_pack
    from rtphys.cli.identify_tables import show
    from rtphys.cli.progress import campaign_progress
    from rtphys.studies.identify.run import judge, result_file, sense

    with resumable():
        with campaign_progress("episodes") as listener:
            sense(plan, default_pack(listener.building), listener)
        with campaign_progress("scores") as listener:
            result = judge(plan, listener)
    if output.figure is not None:
        from rtphys.report.figures.task_map import READABILITY, draw_task_map

        draw_task_map(result.r2(), READABILITY, output.figure)
    if output.as_json:
        typer.echo(json.dumps(asdict(result), indent=2))
    else:
        show(result)
    say(f"all numbers are in {result_file(plan)}", err=True)
    found = {task: one.episodes for task, one in result.tasks.items()}
    if short := [f"{task} has {n}" for task, n in found.items() if n < plan.episodes]:
        raise Incomplete(f"not every task gave {plan.episodes} episodes: {', '.join(short)}")
