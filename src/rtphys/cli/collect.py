"""`rtphys collect`: verified episodes of one or more tasks."""

import time
from collections.abc import Sequence
from dataclasses import fields
from typing import Annotated

import typer

from rtphys.assets.pack import default_pack
from rtphys.cli.datasets import say_digest
from rtphys.cli.derived import AsJson, refuse_others, takes
from rtphys.cli.screen import (
    campaign_progress,
    fitting_table,
    print_rows,
    print_table,
    progress_bar,
    summary_table,
)
from rtphys.cli.terminal import Incomplete, command_line, printable, resumable, say, say_json
from rtphys.core.errors import BadValue, RtphysError, counted
from rtphys.data.layout import TaskDataset
from rtphys.data.manifest import entries_there
from rtphys.senses import drawn
from rtphys.spec.collection import CollectionSpec
from rtphys.spec.option import Option, Tasks, checked_dataclass
from rtphys.spec.varies import what_varies
from rtphys.studies.rates import MOST, expected
from rtphys.studies.requests import (
    Run,
    find_collection,
    read_specs,
    room_needed,
    shard_of,
    specs_for,
)


@checked_dataclass(frozen=True)
class Request(AsJson):
    """What is collected, and whether it is."""

    tasks: Tasks = ()
    manifest: Annotated[
        str, Option("A file that says what to collect, or its name in a library.")
    ] = ""
    sweep: Annotated[
        str, Option("key=value,value: a task dataset for each value, with the same seeds.")
    ] = ""
    dry_run: Annotated[
        bool, Option("Only say what would be collected and where; nothing is simulated.")
    ] = False
    repair: Annotated[
        bool, Option("Collect nothing; make damaged and missing files of a dataset again.")
    ] = False


COMMON = (
    "tasks", "protocol", "episodes", "only", "overrides", "senses", "out", "workers",
    "keep_failures", "sweep", "manifest", "dry_run", "repair",
)  # fmt: skip


@takes(Request, CollectionSpec, Run, typer.Context, common=COMMON)
def collect(request: Request, template: CollectionSpec, run: Run, context: typer.Context) -> None:
    """Collect verified episodes of one or more tasks.

    Attempts are simulated without pictures, and only successes are drawn. The result depends only
    on the options, not on the number of workers or on interruptions.

    Examples:

        rtphys collect click_bell --episodes 100
        rtphys collect 'stack_*' --protocol clean --sense depth,touch
        rtphys collect lift_pot --only friction --episodes 20
        rtphys collect --manifest training_v1 --shard 1/4 --dry-run
        rtphys collect --repair --out data
    """
    from rtphys.studies.collect import collect as run_collection
    from rtphys.studies.collect import without_effect

    if request.repair:
        allowed = "the dataset says that; beside `repair` stand only `out` and `workers`"
        refuse_others(context, {"repair", "out", "workers"}, allowed)
        _repair(run)
        return
    if request.manifest:
        beside = {"manifest", "dry_run", "as_json", *(field.name for field in fields(Run))}
        allowed = "the manifest says that; edit a copy of it, or leave `manifest` out"
        refuse_others(context, beside, allowed)
        specs = read_specs(find_collection(request.manifest))
    elif request.tasks:
        specs = specs_for(template, request.tasks, request.sweep)
        for line in what_varies(specs):
            say(line, err=request.as_json)
    else:
        allowed = "name at least one task, or a `manifest`; `rtphys tasks` lists them"
        raise BadValue("task", None, allowed)
    for sentence in without_effect(specs):
        say(sentence, err=True)
    if request.dry_run:
        _show_specs(shard_of(specs, run.shard), run, request.as_json)
        return
    began = time.monotonic()
    with resumable(), campaign_progress("episodes") as listener:
        done = run_collection(specs, run, listener)
    if request.as_json:
        names = ("name", "wanted", "accepted", "attempts", "new_accepted", "new_attempts")
        counts = [{name: getattr(one, name) for name in names} for one in done]
        ends = [{"rejected": dict(one.rejections), "stopped": one.stopped} for one in done]
        say_json([count | end for count, end in zip(counts, ends, strict=True)])
    else:
        print_table(summary_table(done))
    new = sum(progress.made for progress in done)
    minutes = (time.monotonic() - began) / 60
    made = counted(new, "new episodes")
    say(f"{made} in {minutes:.1f} min, in {run.out}", err=request.as_json)
    say_digest(run.out, err=request.as_json)
    if given_up := [f"{one.name}: {one.stopped}" for one in done if one.stopped]:
        why = "`--keep-failures 5` keeps some, which `rtphys report` shows"
        if any(spec.keep_failures for spec in specs):
            why = f"`{command_line('report', run.out)}` shows failures that were kept"
        raise Incomplete("; ".join([*given_up, why]))
    say("to check every file: " + command_line("verify", run.out), err=request.as_json)


def _repair(run: Run) -> None:
    from rtphys.studies.reproduce import damage, repair

    with progress_bar("comparing") as bar:
        damaged = damage(run.out, bar)
    with resumable(), campaign_progress("episodes") as listener:
        done = repair(run.out, damaged, run.workers, listener)
    for path in done.files:
        say(f"made again: {path}")
    for problem in done.problems:
        say(printable(str(problem), one_line=True), err=True)
    say(f"{counted(len(done.files), 'files')} made again, all others were left as they are")
    say("to check every file: " + command_line("verify", run.out))
    if done.problems:
        raise Incomplete(f"{counted(len(done.problems), 'files')} could not be made again")


def _show_specs(specs: Sequence[CollectionSpec], run: Run, as_json: bool) -> None:
    """Prints each task dataset, what is there already, and what this machine would refuse."""
    from rtphys.plan.kinematics import check_robot
    from rtphys.studies.collect import check, check_machine, missing

    check(specs, run)
    for robot in dict.fromkeys(spec.episode.embodiment for spec in specs):
        check_robot(default_pack(), robot)
    table = fitting_table(["folder"], ("episodes", "there", "seeds from", "cameras", "domain"))
    rows, there = list[dict[str, object]](), entries_there(run.out)
    sides = [side for spec in specs for side in spec.sides]
    for side in sides:
        name = TaskDataset.of(run.out, side).name
        rows.append(
            {
                "folder": name,
                "episodes": side.episodes,
                "there": there[name].episodes if name in there else 0,
                "first_seed": side.first_seed,
                "cameras": ", ".join(side.recording.cameras),
                "domain": side.episode.domain.name,
            }
        )
        table.add_row(*map(str, rows[-1].values()))
    print_rows(table, rows, as_json)
    workers = run.workers or 0
    try:
        workers = check_machine(specs, run)
    except RtphysError as problem:
        say(f"here and now it would be refused: {problem}", err=True)
    left = missing(specs, run.out)
    cpu, unknown = expected(left)
    room = room_needed([one for one in left if one.episode.task not in unknown])
    apart = f", not counting {', '.join(unknown)}" if unknown else ""
    wall = f" ({_seconds(cpu / workers)} with {counted(workers, 'workers')})" if workers else ""
    takes = (
        f"what is missing takes about {_seconds(cpu)} of CPU{wall} and {_bytes(room)} by the "
        f"tables in docs/scale.md{apart}"
    )
    if unknown and not cpu:
        have = "this task has" if len(unknown) == 1 else "these tasks have"
        takes = f"no cost estimate: {have} not been measured"
    if any(one.recording.size or drawn(one.recording.senses) for one in left):
        takes += "; its CPU time is that of pictures of 320x240 without depth and segmentation"
    say(
        f"{counted(sum(side.episodes for side in sides), 'episodes')} in {run.out}, at most "
        f"{_bytes(room_needed(specs, MOST))}; {takes}; nothing was collected",
        err=as_json,
    )


def _seconds(number: float) -> str:
    if number < 60:
        return f"{number:.0f} s"
    return f"{number / 3600:.1f} h" if number >= 3600 else f"{number / 60:.1f} min"


def _bytes(number: float) -> str:
    return f"{number / 1e9:.1f} GB" if number >= 1e9 else f"{number / 1e6:.0f} MB"
