"""Commands for this machine: assets, what an episode costs, and what is lacking."""

import fnmatch
import json
import tempfile
from contextlib import nullcontext
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.text import Text

from rtphys.assets.build import build as build_pack
from rtphys.assets.check import check_pack
from rtphys.assets.identity import source_digest
from rtphys.assets.model import read_json
from rtphys.assets.pack import STAMP, Pack, cache_folder, chosen_pack
from rtphys.cli.derived import AsJson, Json, takes
from rtphys.cli.screen import (
    Screen,
    fitting_table,
    pack_in_use,
    print_rows,
    print_table,
    progress_bar,
)
from rtphys.cli.terminal import say, say_json
from rtphys.core import library
from rtphys.core.cache import reading_cache, writing_cache
from rtphys.core.errors import BadValue, MissingAsset, RtphysError, UnknownName, counted
from rtphys.data.files import make_folder
from rtphys.data.json_text import check_spelled
from rtphys.studies.requests import BenchPlan
from rtphys.studies.resources import props_of
from rtphys.task.props import Articulated, Mesh
from rtphys.task.spec import load_task, task_names

if TYPE_CHECKING:
    from rtphys.studies.cost import Cost


PICTURES = (".png", ".jpg")  # how the name of a contact sheet ends
STYLE = {"ok": "green", "note": "yellow", "fail": "red"}


@takes(BenchPlan, AsJson)
def bench(plan: BenchPlan, output: AsJson) -> None:
    """Measure what an episode costs on this machine.

    It prints the CPU-seconds of an episode by phase, for each task and protocol.

    CPU time can be compared between machines of the same kind. Wall time, in the
    JSON, compares only the phases of one run, because other jobs on the machine lengthen it.

    Example:

        rtphys bench --task click_bell --protocol clean --episodes 5
    """
    from rtphys.studies.cost import ATTEMPT, PICTURES, means
    from rtphys.studies.cost import bench as measure

    pack = pack_in_use()
    console = Screen(stderr=True)

    def tell(cost: "Cost") -> None:
        attempt = cost.attempts.cpu_s()["sum"]
        console.print(f"{cost.task}, {cost.protocol}: {attempt:.2f} CPU-s an attempt")

    costs = measure(plan, pack, tell)
    if output.as_json:
        say_json({"means": means(costs), "rows": [cost.to_json() for cost in costs]})
        return
    names, columns = ["task", "protocol"], ("episodes", *ATTEMPT, "sum")
    table = fitting_table(names, columns, "CPU-seconds of an attempt, without pictures", "right")
    for cost in costs:
        spent, counts = cost.attempts.cpu_s(), f"{cost.accepted} / {cost.attempts.count}"
        cells = (f"{spent[phase]:.3f}" for phase in (*ATTEMPT, "sum"))
        table.add_row(cost.task, cost.protocol, counts, *cells)
    for protocol, mean in means(costs).items():
        cells = [*[""] * len(ATTEMPT), f"{mean['attempt_cpu_s']:.3f}"]
        table.add_row("mean", protocol, "", *cells, style="bold")
    print_table(table)
    if not plan.pictures:
        return
    columns = ("episodes", *PICTURES, "sum")
    title = "CPU-seconds of an accepted episode's pictures"
    table = fitting_table(names, columns, title, "right")
    for cost in costs:
        spent = cost.pictures.cpu_s()
        cells = (f"{spent[phase]:.2f}" for phase in (*PICTURES, "sum"))
        table.add_row(cost.task, cost.protocol, str(cost.pictures.count), *cells)
    print_table(table)


def doctor(
    out: Annotated[Path, typer.Option(help="Folder for datasets.")] = Path("data"),
    as_json: Json = False,
) -> None:
    """Find what does not work on this machine, and how to fix it.

    It looks at renderer, packages, disk space, assets and tasks.

    Exit code 0 when all is well, else the code of the first cause: 10-17 renderer, 20-21 disk,
    22-23 packages, 24 assets, 25 task library, 26 cache, 27 a file in the way, 28 a failed check.

    Example:

        rtphys doctor --json
    """
    from rtphys.doctor import CAUSES, examine, exit_code, to_json

    findings = examine(out)
    table = fitting_table(["", "check"], ["what was found"])
    for finding in findings:
        style = STYLE[finding.status]
        table.add_row(Text(finding.status, style), finding.check, finding.detail)
    print_rows(table, to_json(findings), as_json)
    for finding in () if as_json else findings:
        if finding.status == "fail":
            say(f"\n{finding.check}: {CAUSES[finding.cause].meaning}\n  cure: {finding.cure}")
    raise typer.Exit(exit_code(findings))


assets = typer.Typer(add_completion=False, no_args_is_help=True)

Fallback = Annotated[
    str, typer.Option(help="`builtin`: take what the pack lacks from the builtin one.")
]


@assets.command()
def build(
    out: Annotated[
        Path | None, typer.Option(help="Write the pack here instead of the user's cache.")
    ] = None,
    force: Annotated[bool, typer.Option(help="Build it even if it already exists.")] = False,
    workers: Annotated[
        int | None, typer.Option(help="Processes; default: one per core, at most 8.")
    ] = None,
) -> None:
    """Generate the builtin pack, unless this version's pack already exists."""
    root = out.resolve() if out else cache_folder() / source_digest()[:16]
    stamp = root / STAMP
    # Building replaces what is there.
    if out and not stamp.is_file() and (root.is_file() or (root.is_dir() and any(root.iterdir()))):
        raise BadValue("out", str(out), "rtphys built no pack there; name a new or empty folder")
    reading, writing = (nullcontext, nullcontext) if out else (reading_cache, writing_cache)
    with reading():
        there = stamp.is_file() and read_json(stamp).get("source") == source_digest()
    if force or not there:
        with progress_bar("building assets") as bar, writing():
            build_pack(root, bar, workers=workers)
    pack = Pack(root)
    say(f"{pack.root}\n{counted(len(pack.names), 'objects')}, digest {pack.digest}")


@assets.command()
def show(
    names: Annotated[
        list[str], typer.Argument(help="Objects or patterns: 050_bell, 050_bell/1, '*_fork'.")
    ],
    out: Annotated[Path, typer.Option(help="The picture to write.")] = Path("assets.png"),
    size: Annotated[int, typer.Option(help="Pixels per model.", min=32, max=1024)] = 160,
) -> None:
    """Draw a contact sheet of models, with the axes of their frames and their points.

    x is orange, y green, z violet. Red points out of a contact point, against the hand's approach;
    blue is the z of a functional point.
    """
    from rtphys.assets.contact_sheet import contact_sheet

    if out.suffix.lower() not in PICTURES:
        raise BadValue("out", str(out), f"its name ends in {' or '.join(PICTURES)}")
    pack = pack_in_use()
    models = [model for name in names for model in _models(pack, name)]
    make_folder(out.parent)
    with progress_bar("drawing") as bar:
        done = iter(range(1, len(models) + 1))
        picture = contact_sheet(
            pack, models, size, tell=lambda name: bar(next(done), len(models), name)
        )
    picture.save(out)
    say(f"{out}: {counted(len(models), 'models')}")


def _models(pack: Pack, name: str) -> list[tuple[str, int]]:
    """`050_bell` is all its models, `050_bell/1` one. Raises UnknownName, BadValue, or
    MissingAsset: the object that is named holds none."""
    pattern, _, number = name.partition("/")
    found = fnmatch.filter(pack.names, pattern)
    if not found:
        raise UnknownName("object", pattern, pack.names)
    if number and not number.isdecimal():
        raise BadValue("names", name, "write an object's name, or name/number")
    models = list[tuple[str, int]]()
    for one in found:
        try:
            models += [(one, i) for i in ([int(number)] if number else pack.indices(one))]
        except MissingAsset:  # a folder without models, such as `objaverse` of the official pack
            if one == pattern:
                raise
    return models


@assets.command("list")
def list_models(
    names: Annotated[
        list[str] | None,
        typer.Argument(help="Objects or patterns, such as '*_fork'; default: all."),
    ] = None,
    as_json: Json = False,
) -> None:
    """List models with size, mass, and the numbers of their contact and functional points.

    Sizes are in the model's own frame, usually with y up.
    """
    pack, rows = pack_in_use(), list[dict[str, object]]()
    title = "models; what has no contact point cannot be grasped"
    columns = ("size x y z [cm]", "mass [g]", "contact", "functional")
    table = fitting_table(["model"], columns, title)
    found = (model for pattern in names or ["*"] for model in _models(pack, pattern))
    for name, index in dict.fromkeys(found):
        if pack.is_articulated(name):
            model, size = pack.articulation(name, index), None
        else:
            model = pack.model(name, index)
            size = [float(x) for x in model.extents]
        mass, points = model.mass_kg, (len(model.contact_points), len(model.functional_points))
        rows.append(
            {
                "object": name,
                "model": index,
                "articulated": size is None,
                "size_m": None if size is None else [round(x, 4) for x in size],
                "mass_kg": None if mass is None else round(mass, 4),
                "contact_points": points[0],
                "functional_points": points[1],
                "phrases": list(model.description),
            }
        )
        table.add_row(
            f"{name}/{index}",
            "articulated" if size is None else " ".join(f"{100 * x:.1f}" for x in size),
            "" if mass is None else f"{1000 * mass:.0f}",
            *map(str, points),
        )
    print_rows(table, rows, as_json)


@assets.command()
def check(
    folder: Annotated[Path | None, typer.Argument(help="A pack; default: the one in use.")] = None,
    fallback: Fallback = "",
    robot: Annotated[
        str, typer.Option(help="Check only this robot: a name, or LEFT,RIGHT,DISTANCE.")
    ] = "",
    as_json: Json = False,
) -> None:
    """Check which parts of a pack load, what is missing, and which tasks can run on it."""
    from rtphys.plan.kinematics import check_robot

    if folder is None and fallback:
        raise BadValue("fallback", fallback, "it needs `folder`, which lacks models")
    pack = pack_in_use() if folder is None else chosen_pack(folder, fallback)
    if robot:
        _show_robot(pack, robot, as_json)
        return
    report = check_pack(pack)
    problems = list(report.problems)
    for name in pack.embodiments:
        try:
            if name in report.loaded:
                check_robot(pack, name)
        except RtphysError as problem:  # it loads, but no episode can be tried with it
            problems.append(str(problem))
    lacks = dict[str, list[str]]()
    for name in task_names():
        try:
            lacks[name] = lacking(pack, name)
        except RtphysError as problem:  # one broken file must not hide the others
            problems.append(str(problem))
    if as_json:
        facts = {"root": str(pack.root), **asdict(report), "problems": problems, "lacking": lacks}
        say_json(facts)
        raise typer.Exit(bool(problems))
    say(str(pack.root))
    robots = library.names("robots")
    for name, count in report.loaded.items():
        own = any((pack.root / kind / name).is_dir() for kind in ("objects", "embodiments"))
        whose = "of this pack" if own or pack.fallback is None else f"of {pack.fallback.root}"
        if name in robots:
            whose = f"of the library {robots[name].parents[1]}"
        say(f"  {name}: {counted(count, 'models')}, {whose}")
    say(f"  textures: {report.textures['seen']} seen, {report.textures['unseen']} unseen")
    for problem in problems:
        Screen().print(problem, style="red", soft_wrap=True)
    able = [name for name, missing in lacks.items() if not missing]
    say("tasks that can run: " + (", ".join(able) or "none"))
    for name, missing in lacks.items():
        if missing:
            say(f"  {name} lacks {', '.join(missing)}")
    raise typer.Exit(bool(problems))


def _show_robot(pack: Pack, name: str, as_json: bool) -> None:
    """Raises what makes a robot unusable."""
    from rtphys.plan.kinematics import check_robot

    found = check_robot(pack, name)
    openings = [2 * limb.hand.finger_open for limb in found.limbs]  # [m]
    layout, opening = found.action_layout, [round(one, 4) for one in openings]
    if as_json:
        numbers = {"numbers": layout.size, "action": str(layout)}
        say_json({"robot": found.name, "urdf": str(found.urdf), **numbers, "opening_m": opening})
        return
    left, right = (f"{100 * opening:.1f} cm" for opening in openings)
    say(f"{found.name}: usable, {layout.size} numbers: {layout}")
    say(f"its hands open {left} and {right}; both arms in {found.urdf}")


def lacking(pack: Pack, task: str) -> list[str]:
    """Models that the task uses and the pack cannot load, as far as its first layouts tell."""
    wanted = {
        (prop.category, prop.model, isinstance(prop, Articulated))
        for prop in props_of(load_task(task))
        if isinstance(prop, Mesh | Articulated)
    }
    missing = []
    for category, model, articulated in sorted(wanted):
        try:
            (pack.articulation if articulated else pack.model)(category, model)
        except (MissingAsset, UnknownName):
            missing.append(f"{category}/{model}")
    return missing


@assets.command()
def link(
    folder: Annotated[
        Path | None, typer.Argument(help="RoboTwin's `assets` folder (or its parent).")
    ] = None,
    fallback: Fallback = "",
    remove: Annotated[bool, typer.Option("--remove", help="Use the builtin pack again.")] = False,
) -> None:
    """Use another pack, such as the official one, from now on."""
    path = cache_folder() / "link.json"
    if remove and (folder or fallback):
        raise BadValue("remove", remove, "it takes no folder and no `fallback`")
    if remove:
        with writing_cache():
            path.unlink(missing_ok=True)
        say("using the builtin pack")
        return
    if folder is None:
        raise BadValue("folder", None, "name the folder to link, or give `remove`")
    pack = chosen_pack(folder.resolve(), fallback)
    text = json.dumps({"root": str(pack.root), "fallback": pack.fallback is not None})
    cure = "its path is not UTF-8; rename it, or name it in $RTPHYS_ASSETS"
    check_spelled("folder", str(pack.root), cure)
    with writing_cache():
        path.parent.mkdir(parents=True, exist_ok=True)
        # A worker may be reading it, and another process may link, too.
        with tempfile.TemporaryDirectory(dir=path.parent) as scratch:
            new = Path(scratch) / path.name
            new.write_text(f"{text}\n")
            new.replace(path)
    say(f"using {pack.root}" + (", then the builtin pack" if pack.fallback else ""))
