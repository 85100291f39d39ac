"""`rtphys sensitivity`: which physics breaks a task, and how far from nominal."""

import json
from collections.abc import Mapping, Sequence
from typing import cast

import typer

from rtphys.cli.derived import takes
from rtphys.cli.options import MapOutput
from rtphys.cli.stopping import resumable
from rtphys.cli.terminal import say
from rtphys.data.episode import JSON
from rtphys.studies.sensitivity.plan import SensitivityPlan


@takes(SensitivityPlan, MapOutput)
def sensitivity(plan: SensitivityPlan, output: MapOutput) -> None:
    """Measure how far each physical attribute may be from nominal before a task is lost.

    One attribute at a time is held away from its nominal value, on seeds that succeed nominally.
    The tolerance is the part of its range in which at least half of them still succeed. It may be
    interrupted: the same command goes on where it stopped.

    Examples:

        rtphys sensitivity --task click_bell --only friction,table_height
        rtphys sensitivity --task '*' --out maps/replay --figure map.png
    """
    from rtphys.assets.pack import default_pack
    from rtphys.cli.progress import campaign_progress
    from rtphys.studies.sensitivity.run import sensitivity as measure

    plan.check()
    with resumable(), campaign_progress("tasks") as listener:
        found = measure(plan, default_pack(listener.building), listener)
    if output.figure is not None:
        from rtphys.report.figures.task_map import TOLERANCE, draw_task_map
        from rtphys.results.quarters import tolerated_shares

        draw_task_map(tolerated_shares(found), TOLERANCE, output.figure)
    if output.as_json:
        typer.echo(json.dumps(found, indent=2))
        return
    _show(found)
    if without := [str(result["task"]) for result in found if not result["seeds"]]:
        say(f"{', '.join(without)}: nothing measured, since no seed succeeds nominally", err=True)


def _show(found: Sequence[Mapping[str, JSON]]) -> None:
    from rtphys.cli.fitting import fitting_table, print_table
    from rtphys.physics.registry import attribute

    table = fitting_table(["task", "attribute"], ("from", "to", "of its range", "unit"))
    for result in found:
        attributes = result["attributes"]
        assert isinstance(attributes, Mapping)
        for key, answer in attributes.items():
            assert isinstance(answer, Mapping)
            (low, high), share = cast(list[float], answer["tolerance"]), answer["share"]
            bounds = f"{low:.3g}", f"{high:.3g}", f"{100 * cast(float, share):.0f} %"
            table.add_row(str(result["task"]), key, *bounds, attribute(key).unit)
    print_table(table)
