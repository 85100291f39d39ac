"""Commands for authors: what there is, new tasks, and what tries them."""

import json
import re
import shlex
import sys
from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from math import degrees
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast

import typer
from rich.table import Table

from rtphys.cli.derived import AsJson, Json, names_in, takes
from rtphys.cli.screen import (
    Screen,
    campaign,
    fitting_table,
    pack_in_use,
    print_rows,
    print_table,
    reasons,
)
from rtphys.cli.terminal import say, say_json
from rtphys.core import library
from rtphys.core.errors import BadValue, Infeasible, RtphysError, UnknownName, counted
from rtphys.core.untrusted import dump_yaml
from rtphys.data.files import make_folder, replace_file
from rtphys.data.jpeg import encode_png
from rtphys.physics import Domain, Value, attributes, domain_for_task, load_domain
from rtphys.physics.attribute import attribute
from rtphys.physics.domain import AUXILIARY
from rtphys.spec import protocol
from rtphys.studies.rates import rates
from rtphys.studies.requests import CheckPlan, TryPlan
from rtphys.studies.resources import check_drawable, mistakes_named, props_of
from rtphys.task.props import Articulated, Mesh
from rtphys.task.spec import load_task

if TYPE_CHECKING:
    from rtphys.studies.check import Score


DOMAIN = "A task, a domain, or a domain file."  # what `domain_named` takes
PROTOCOLS = ("clean", "phys_random")
MAX_FAILURES = 10  # of a task that `check` lists
WIDE = 120  # [characters] a row with all columns fits
COLUMNS = ("task", "arms", "mechanism", "objects", "step_limit", "domain", *PROTOCOLS)

TEMPLATE = '''"""Put the block on the pad.

Success: the block rests on the pad, and both hands are open.
"""

from rtphys.task import (
    BLUE,
    Aim,
    Box,
    Draw,
    Placing,
    Robot,
    Task,
    at_rest,
    clear_of,
    hands_open,
    points_meet,
)

ONTO = Placing(pre=0.06, gap=0.0, along="point")


def layout(draw: Draw):
    """What stands where; depends on the seed alone."""
    pad = draw.spot("pad", x=(0.05, 0.25), y=(-0.2, 0.0))
    yield Box(
        name="pad", half_size=(0.04, 0.04, 0.0005), colour=BLUE, pose=pad.pose(), fixed=True,
        phrase="blue pad",
    )  # fmt: skip
    free = clear_of((pad, 0.12))
    spot = draw.spot("block", x=(0.05, 0.28), y=(-0.15, 0.05), yaw=(-0.7, 0.7), where=free)
    yield Box(name="block", half_size=(0.025,) * 3, pose=spot.pose(), phrase="red block")


def script(robot: Robot) -> None:
    """The expert: verbs of `robot.left` and `robot.right`, carried out by `robot.do`."""
    arm, target = robot.nearest("block"), robot.scene.functional("pad", 1)
    robot.do(arm.grasp("block", aim=Aim(target, 0, ONTO)))
    robot.do(arm.lift(0.07))
    robot.do(arm.place("block", target, point=0, how=ONTO))
    robot.do(arm.retreat(0.07))


task = Task(
    layout=layout,
    script=script,
    success=points_meet("block", 0, "pad", 1, within=(0.03, 0.03, 0.01))
    & at_rest("block")
    & hands_open(),
    step_limit=400,
    mechanism="pick, place",
    info={"A": "block", "B": "pad", "a": "arm:block"},
)
'''


domains = typer.Typer(add_completion=False, no_args_is_help=True)


def tasks(
    pattern: Annotated[str, typer.Argument(help="Only names that match, such as 'stack_*'.")] = "*",
    as_json: Json = False,
) -> None:
    """List the tasks: arms, mechanism, objects, domain, rates.

    The rates are those of the expert in the certified lists.

    Examples:

        rtphys tasks
        rtphys tasks 'place_*' --json
    """
    rows = list[dict[str, object]]()
    for name in library.matching("tasks", names_in([pattern])):
        try:
            task = load_task(name)
            props = props_of(task, 1)  # of one layout
        except RtphysError as problem:  # one broken file must not hide the others
            rows.append({"task": name, "mechanism": f"broken: {problem}"})
            continue
        objects = [
            prop.category if isinstance(prop, Mesh | Articulated) else prop.phrase or prop.name
            for prop in props
        ]
        rows.append(
            {
                "task": name,
                "arms": task.arms,
                "mechanism": task.mechanism,
                "objects": ", ".join(dict.fromkeys(objects)),
                "step_limit": task.step_limit,
                "domain": name if name in library.names("domains") else "global",
                **{key: str(rate) for key, rate in rates().get(name, {}).items()},
            }
        )
    # A pipe has room for all; a terminal for what fits, and --json has the rest.
    terminal = sys.stdout is not None and sys.stdout.isatty()
    narrow = terminal and Screen().width < WIDE
    shown = [key for key in COLUMNS if not (narrow and key in ("objects", "domain"))]
    table = fitting_table(["task"], [key.replace("step_limit", "steps") for key in shown[1:]])
    for row in rows:
        cells = {key: str(row.get(key, "")) for key in shown}
        if terminal:  # without out of how many a rate is
            cells |= {key: cells[key].partition(" of ")[0] for key in PROTOCOLS}
        table.add_row(*cells.values())
    if terminal:
        table.caption = "--json also has " + ("objects, domain and " if narrow else "") + "counts"
    print_rows(table, rows, as_json)


def new_task(
    name: Annotated[str, typer.Argument(help="verb_object, such as place_spoon.")],
    folder: Annotated[
        Path, typer.Option("--in", help="The library that gets tasks/NAME.py.")
    ] = Path(),
) -> None:
    """Write a task file to start from; it already runs.

    The file goes into a library, a folder of your own; the second command tries the task.

    Examples:

        rtphys new-task place_spoon --in my_lab
        rtphys --library my_lab check place_spoon
    """
    if not re.fullmatch(r"[a-z][a-z0-9]*(_[a-z0-9]+)*", name):
        raise BadValue("name", name, "a name is words of a-z and 0-9 joined by _")
    path = folder / "tasks" / f"{name}.py"
    if name in library.names("tasks", None) or path.exists():
        raise BadValue("name", name, "there is a task of that name already", path)
    make_folder(path.parent)
    replace_file(path, TEMPLATE.encode())
    check = ("rtphys", "--library", str(folder), "check", name, "--seeds", "20")
    say(f"{path}\ntry it: {shlex.join(check)}")


def protocols(as_json: Json = False) -> None:
    """Show what each protocol varies between episodes.

    The layout always varies. Libraries may add protocols.

    The JSON also holds the attributes that vary, the width of their ranges, and each look's rules.
    """
    table, rows = fitting_table(["protocol"], ("physics", "look", "what")), list[object]()
    for row in protocol.protocols().values():
        varied = ("varied" if part else "nominal" for part in (row.physics, row.visual))
        table.add_row(row.name, *varied, row.what)
        rows.append({**asdict(row), "visual": row.visual and row.visual.to_json()})
    print_rows(table, rows, as_json)


@domains.command()
def show(
    task: Annotated[str, typer.Argument(help=DOMAIN)],
    as_json: Json = False,
    as_yaml: Annotated[
        bool, typer.Option("--yaml", help="A domain file to copy and change, without `extends`.")
    ] = False,
) -> None:
    """Show the resolved ranges of a task, by attribute, and the file that each comes from.

    A domain may also be given, by its name or its file.

    Examples:

        rtphys domains show grab_roller
        rtphys domains show global --yaml
    """
    domain = domain_named(task)
    if not as_yaml:
        print_rows(_ranges(domain), domain.to_json(), as_json)
        return
    if as_json:
        raise BadValue("yaml", as_yaml, "`json` is given too; choose one of them")
    say(f"why: {json.dumps(domain.why, ensure_ascii=False)}\nphysics:")
    for key, rule in domain.rules.items():
        say(f"  {key}: {_flow(rule.to_json())}")


@domains.command("check")
def check_domain(
    file: Annotated[Path, typer.Argument(help="A domain file (YAML).")], as_json: Json = False
) -> None:
    """Read a domain file, or say what is wrong with it."""
    domain = load_domain(file)
    print_rows(_ranges(domain), domain.to_json(), as_json)
    own = [key for key, source in domain.sources.items() if source == file.stem]
    if not as_json:
        say(f"{file}: good; it sets {', '.join(own) or 'nothing'}. digest {domain.digest[:12]}")


@domains.command("list")
def list_() -> None:
    """List the names of all domains."""
    for name in library.names("domains"):
        say(name)


def _flow(rule: object) -> str:
    """A rule as YAML in one line."""
    if isinstance(rule, Mapping):
        pairs = cast(Mapping[str, object], rule).items()
        return f"{{{', '.join(f'{key}: {_flow(value)}' for key, value in pairs)}}}"
    if isinstance(rule, list):
        return f"[{', '.join(map(_flow, cast(list[object], rule)))}]"
    if isinstance(rule, str):
        return rule if re.fullmatch(r"[a-z_]+", rule) else json.dumps(rule)
    return dump_yaml(rule).splitlines()[0]  # JSON's 1e-05 is a name in YAML


def domain_named(name: str) -> Domain:
    """The domain of a task, a domain by its own name, or a domain file.

    Raises `UnknownName`: neither a task nor a domain; names the nearest match.
    """
    known, of_tasks = library.names("domains"), library.names("tasks", None)
    if name in known or name.endswith((".yaml", ".yml")):
        return load_domain(name)
    if name not in of_tasks:
        raise UnknownName("task or domain", name, {*of_tasks, *known})
    return domain_for_task(name)


def _ranges(domain: Domain) -> Table:
    known = attributes()
    columns = ("range", "unit", "nominal", "from")
    table = fitting_table(["attribute"], columns, f"domain {domain.name}")
    for key in [*domain.keys, *(k for k in AUXILIARY if k in domain.rules)]:
        one = attribute(key) if key not in AUXILIARY else None
        about = (one.unit, value_text(one.nominal)) if one else ("", "")
        source = domain.sources.get(key, domain.name)
        table.add_row(key, str(domain.rules[key]), *about, source)
    for key in sorted(known.keys() - set(domain.keys)):
        table.add_row(key, "held nominal", known[key].unit, value_text(known[key].nominal), "")
    return table


def value_text(value: Value, form: str = "g") -> str:
    """A value in one cell or sentence; `form` formats its numbers."""
    if value is None:
        return "the asset's"
    if isinstance(value, tuple):
        return f"({', '.join(format(x, form) for x in value)})"
    return value if isinstance(value, str) else format(value, form)


@takes(CheckPlan, AsJson)
def check(plan: CheckPlan, output: AsJson) -> None:
    """Try a task's expert over many seeds, without pictures.

    The expert's actions are replayed open loop. Two seeds are tried a second time and must give
    the same states. The baselines idle, random and jitter, which see nothing, must fail; they run
    only if the expert solves a seed. CPU-s is the mean time of an attempt. `rtphys try` shows
    one attempt.

    Exit code 1: the expert solved no seed of a protocol, a baseline succeeded, or a
    seed gave two outcomes.

    Examples:

        rtphys check click_bell --seeds 20
        rtphys check 'stack_*' --protocol clean,phys_random
    """
    from rtphys.studies.check import check as run_check

    with campaign("episodes") as (pack, listener):
        scores = run_check(plan, pack, listener)
    if output.as_json:
        say_json([score.to_json() for score in scores])
    else:
        _show_scores(scores)
    if wrong := complaints(scores):
        say("\n".join(wrong), err=True)
        raise typer.Exit(1)


@takes(TryPlan)
def try_(plan: TryPlan) -> None:
    """Try a task's expert once; show its stages and where it got stuck.

    Exit code 1: the attempt failed. `rtphys collect` attempts the same episode.

    Examples:

        rtphys try place_empty_cup --seed 3 --picture stages.png
        rtphys try click_bell --protocol phys_random --video a.mp4
    """
    from rtphys.episode.render import write_video
    from rtphys.plan.kinematics import check_robot
    from rtphys.report.pictures import captioned
    from rtphys.sim import renderer
    from rtphys.studies.check import stage_ends, watch
    from rtphys.task.instructions import check_sentences

    task = load_task(plan.task)
    check_sentences(task)
    if plan.picture or plan.video:
        check_drawable()
        renderer.configure()
    pack = pack_in_use()
    check_robot(pack, plan.episode.embodiment)
    spec = replace(plan.episode, task=plan.task)
    with mistakes_named(task):
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
        try:
            stages, pictures = stage_ends(tried, task, pack)
            replace_file(plan.picture, encode_png(captioned(pictures, stages)))
            say(str(plan.picture))
        except Infeasible as problem:
            say(f"{plan.picture}: not drawn, {problem}", err=True)
    if plan.video is not None:
        if tried.instance is not None and tried.recording is not None:
            write_video(tried.instance, tried.recording, pack, plan.video)
            say(str(plan.video))
        else:
            say(f"{plan.video}: not drawn, nobody moved", err=True)
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
            found.append(f"{at}: a seed that was tried twice had two outcomes")
    return found


def _name(score: "Score") -> str:
    return f"{score.spec.task}, {score.spec.protocol}"


def _show_scores(scores: "Sequence[Score]") -> None:
    from rtphys.studies.check import BASELINES

    columns = ("accepted", "replay", *BASELINES, "CPU-s", "rejected")
    table = fitting_table(["task", "protocol"], columns)
    for score in scores:
        counts = [(score.solved(name), score.played(name)) for name in ("expert", *BASELINES)]
        table.add_row(
            score.spec.task,
            score.spec.protocol,
            f"{len(score.accepted)} / {len(score.tried('expert'))}",
            *(f"{solved} / {played}" if played else "-" for solved, played in counts),
            "-" if (spent := score.cpu_seconds) is None else f"{spent:.2f}",
            reasons(score.rejected),
        )
    print_table(table)
    for score in scores:
        for seed, one in list(score.failures.items())[:MAX_FAILURES]:
            say(f"{_name(score)}, seed {seed}: {one.reason}: {one.detail}")
        if (rest := len(score.failures) - MAX_FAILURES) > 0:
            say(f"{_name(score)}: and {rest} more")
