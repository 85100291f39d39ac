"""`rtphys identify` and `sensitivity`: what a robot senses of physics, and which of it matters."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, cast

from rich.table import Table

from rtphys.analysis.identify import IdentifyPlan, Result, judge
from rtphys.cli.derived import AsJson, check_figure, takes
from rtphys.cli.screen import campaign, campaign_progress, fitting_table, print_rows, print_table
from rtphys.cli.terminal import Incomplete, resumable, say, say_json
from rtphys.core.errors import counted
from rtphys.core.untrusted import JSON
from rtphys.physics.attribute import attribute
from rtphys.spec.option import Option
from rtphys.studies.requests import SensitivityPlan

if TYPE_CHECKING:
    from rtphys.analysis.scoring import Score
    from rtphys.report.figures import Cells, Scale

MAX_ONE_BY_ONE = 6  # tasks; more are shown by attribute
GOOD = 0.8  # R2 from which an attribute counts as inferred
WEIGHTY = 0.05  # R2 that is lost without a group of signals that carries an attribute


@dataclass(frozen=True)
class MapOutput(AsJson):
    """Where a map of task by attribute goes beside the screen."""

    figure: Annotated[Path | None, Option("Also draw the map of task by attribute (PNG).")] = None

    def __post_init__(self) -> None:
        if self.figure is not None:  # before work of hours
            check_figure(self.figure)


def draw_map(cells: "Cells", scale: "Scale", path: Path) -> None:
    """Draws a map of task by attribute, unless it would be empty."""
    from rtphys.report.figures import draw_task_map

    if any(cells.values()):
        draw_task_map(cells, scale, path)
    else:
        say(f"{path}: not drawn, since nothing was measured", err=True)


@takes(IdentifyPlan, MapOutput)
def identify(plan: IdentifyPlan, output: MapOutput) -> None:
    """Find which physics can be inferred from what a robot senses.

    The expert's episodes are simulated without pictures. Their features are statistics of
    commands, measured joints, tracking, effort and touch in each stage; object states are not
    used. An estimator learns each attribute from these features. It is tested on other seeds (R2:
    0 is a guess, 1 is exact), on shuffled labels, and outside the range it was trained on. After
    an interruption, the same command continues where it stopped.

    Examples:

        rtphys identify --task click_bell,lift_pot --episodes 100
        rtphys --library probes identify --task heft,rub --out identify_probes
        rtphys identify --task lift_pot --estimator python:mine.py:Mine
        rtphys compare identify/trees.json identify/Mine.json
    """
    from rtphys.analysis.features import sense

    with campaign("episodes") as (pack, listener):
        sense(plan, pack, listener)
    with resumable(), campaign_progress("scores") as listener:
        result = judge(plan, listener)
    if output.figure is not None:
        from rtphys.report.figures import IDENTIFIABILITY

        draw_map(result.r2(), IDENTIFIABILITY, output.figure)
    if output.as_json:
        say_json(asdict(result))
    else:
        show(result)
    say(f"all numbers are in {plan.result_file}", err=True)
    counts = {task: one.episodes for task, one in result.tasks.items()}
    if short := [f"{task} has {n}" for task, n in counts.items() if n < plan.episodes]:
        wanted = counted(plan.episodes, "episodes")
        raise Incomplete(f"not every task gave {wanted}: {', '.join(short)}")


def show(result: Result) -> None:
    """Each task and attribute where tasks are few, else each attribute over all tasks."""
    if few := len(result.tasks) <= MAX_ONE_BY_ONE:
        columns = ("R2", "95 %", "shuffled", "beyond", "n", "carried by")
        table = fitting_table(["task", "attribute"], columns)
    else:
        columns = ("tasks", "mean R2", "best", f"R2 >= {GOOD}", "mean shuffled", "carried by")
        table = fitting_table(["attribute"], columns)
    for task, of in result.tasks.items() if few else ():
        for key, score in of.scores.items():
            low, high = score.interval
            beyond = "-" if score.beyond is None else f"{score.beyond.r2:.2f}"
            cells = (f"{score.r2:.2f}", f"{low:.2f} .. {high:.2f}", f"{score.shuffled:.2f}", beyond)
            table.add_row(task, key, *cells, str(score.n), carriers(score))
        table.add_section()
    for key in () if few else sorted({key for of in result.tasks.values() for key in of.scores}):
        scores = {t: f.scores[key] for t, f in result.tasks.items() if key in f.scores}
        best = max(scores, key=lambda task: scores[task].r2)
        inferred = sum(score.r2 >= GOOD for score in scores.values())
        mean = sum(score.r2 for score in scores.values()) / len(scores)
        shuffled = sum(score.shuffled for score in scores.values()) / len(scores)
        cells = (f"{mean:.2f}", f"{best} {scores[best].r2:.2f}", str(inferred), f"{shuffled:.2f}")
        table.add_row(key, str(len(scores)), *cells, carriers(scores[best]))
    print_table(table)
    for task, of in result.tasks.items():
        if of.left_out and few:
            reasons = ", ".join(f"{key} ({why})" for key, why in of.left_out.items())
            say(f"{task}: left out: {reasons}")
        for key, why in of.failed.items():
            say(f"{task}, {key}: the estimator failed: {why}", err=True)


def carriers(score: "Score") -> str:
    """The groups of signals without which R2 falls noticeably, the weightiest first."""
    weighty = sorted(score.importance.items(), key=lambda item: -item[1])
    return ", ".join(f"{group} {drop:.2f}" for group, drop in weighty if drop >= WEIGHTY) or "-"


@takes(SensitivityPlan, MapOutput)
def sensitivity(plan: SensitivityPlan, output: MapOutput) -> None:
    """Measure how far physics may be off before a task fails.

    One attribute at a time is moved away from its nominal value, on seeds that succeed nominally.
    The tolerance is the part of its range in which at least half of them still succeed. After an
    interruption, the same command continues where it stopped.

    Examples:

        rtphys sensitivity --task click_bell --only friction,table_height
        rtphys sensitivity --task '*' --out maps/replay --figure map.png
    """
    from rtphys.analysis.sensitivity import sensitivity as measure

    with campaign("tasks") as (pack, listener):
        results = measure(plan, pack, listener)
    if output.figure is not None:
        from rtphys.report.figures import SENSITIVITY, tolerated_shares

        draw_map(tolerated_shares(results), SENSITIVITY, output.figure)
    if output.as_json or any(result["attributes"] for result in results):
        print_rows(tolerances_table(results), results, output.as_json)
    if without := [str(result["task"]) for result in results if not result["seeds"]]:
        say(f"{', '.join(without)}: nothing measured, since no seed succeeds nominally", err=True)


def tolerances_table(results: Sequence[Mapping[str, JSON]]) -> Table:
    """What each task tolerates, and the counts behind it."""
    title = (
        "tolerated: with which at least half of the paired seeds succeed\n"
        "share: of the attribute's range\n"
        "at the ends: successes of the seeds at its lower and upper end, or its only one"
    )
    heads = ("tolerated", "share", "at the ends")
    table = fitting_table(["task", "attribute"], heads, title)
    for result in results:
        for key, answer in cast(Mapping[str, Any], result["attributes"]).items():
            low, high = (f"{bound:.3g}" for bound in answer["tolerance"])
            unit = attribute(key).unit
            within = f"{low} to {high}" + f" {unit}" * (unit != "1")
            ends = [side["levels"][0] for side in answer["sides"]]  # the end is tested first
            counts = ", ".join(f"{end['successes']}/{end['of']}" for end in ends)
            share = f"{100 * answer['share']:.0f} %"
            table.add_row(str(result["task"]), key, within, share, counts)
    return table
