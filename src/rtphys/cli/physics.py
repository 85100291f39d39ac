"""`rtphys physics`: draw values, test the laws, audit a dataset's labels."""

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from math import inf, isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rtphys.assets.embodiment import DEFAULT
from rtphys.assets.pack import default_pack
from rtphys.cli.authoring import DOMAIN, domain_named, value_text
from rtphys.cli.derived import Json, names_in
from rtphys.cli.screen import fitting_table, print_table
from rtphys.cli.terminal import say, say_json
from rtphys.core import library
from rtphys.core.errors import BadValue, Infeasible, RtphysError, UnknownName, counted
from rtphys.data.dataset import Dataset
from rtphys.data.files import make_folder
from rtphys.physics import Physics, Value, parse_overrides
from rtphys.physics.attribute import attribute, is_attribute
from rtphys.physics.reach import keys_of
from rtphys.spec.episode import EpisodeSpec, Recipe
from rtphys.studies.resources import mistakes_named
from rtphys.task.spec import load_task

if TYPE_CHECKING:
    from rtphys.episode.audit import Audit
    from rtphys.laws.audit.specimen import Measurement
    from rtphys.laws.law import Trial

LINE_EVERY = 10.0  # [s] between lines of progress
SEEDS = 4  # in one table: more numbers than that do not fit in 80 columns
Facts = dict[str, object]

physics = typer.Typer(add_completion=False, no_args_is_help=True)


def facts_of(key: str, one: object, *names: str) -> Facts:
    """The attribute and named values of an object as JSON; null for what is not finite."""
    values = {name: getattr(one, name) for name in names}
    finite = {n: v if not isinstance(v, float) or isfinite(v) else None for n, v in values.items()}
    return {"attribute": key, **finite}


@physics.command()
def sample(
    name: Annotated[str, typer.Argument(help=DOMAIN)] = "",
    task: Annotated[str, typer.Option(help="The same, as an option.")] = "",
    first_seed: Annotated[int, typer.Option(min=0, help="The first episode seed.")] = 0,
    episodes: Annotated[int, typer.Option(min=1, help="Number of seeds.")] = 1,
    only: Annotated[str | None, typer.Option(help="Vary only these (comma-separated).")] = None,
    assignments: Annotated[
        list[str] | None, typer.Option("--set", help="key=value, repeatable.")
    ] = None,
    as_json: Json = False,
) -> None:
    """Show the values that an episode draws, exactly as its label will say.

    For a task, the centre of mass is redrawn until it lies inside the task's own bodies. For a
    domain it is the first draw, from the streams that all tasks share under `pair_tasks`.
    """
    if bool(name) == bool(task):
        raise BadValue("task", task or None, "name one task, domain or domain file")
    domain = domain_named(task := name or task)
    wanted = None if only is None else names_in([only])
    overrides = parse_overrides(assignments or [])
    drawn: dict[int, Physics] = {}
    for s in range(first_seed, first_seed + episodes):
        if task in library.names("tasks", None):
            drawn[s] = _inside_bodies(EpisodeSpec(task, "phys_random", wanted, overrides).at(s))
        else:
            drawn[s] = domain.sample(s, wanted, overrides)
    if as_json:
        rows: list[Facts] = [
            {"seed": s, "values": {**p}, "varied": sorted(p.varied)} for s, p in drawn.items()
        ]
        say_json([{"domain": domain.name, **row} for row in rows])
        return
    keys = sorted({key for values in drawn.values() for key in filter(is_attribute, values)})
    seeds = list(drawn)
    for start in range(0, len(seeds), SEEDS):
        few = seeds[start : start + SEEDS]
        columns = ("unit", *(f"seed {seed}" for seed in few))
        table = fitting_table(["attribute"], columns, f"domain {domain.name}")
        for key in [*keys, "camera_mode", "camera_direction"]:
            cells = [_cell(drawn[s].get(key), key in drawn[s].varied) for s in few]
            table.add_row(key, attribute(key).unit if key in keys else "", *cells)
        print_table(table)


def _inside_bodies(recipe: Recipe) -> Physics:
    """The draw with the centre of mass that fits; the first one where the episode has none."""
    from rtphys.task.props import check_props

    first, task = recipe.spec.draw(recipe.seed), load_task(recipe.task)
    with suppress(Infeasible), mistakes_named(task):  # no layout: no episode either
        check_props(first, task.props(recipe.seed))
    if not keys_of("center_of_mass", first.varied):
        return first
    from rtphys.episode.generate import prepare

    try:
        with mistakes_named(task):
            return prepare(recipe, task, default_pack()).physics
    except Infeasible as problem:
        say(f"seed {recipe.seed} gives no episode: {problem}", err=True)
        return first


def _cell(value: Value, varied: bool) -> str:
    if value is None:
        return "-"
    if isinstance(value, str):
        return value
    vector = isinstance(value, tuple)
    text = " ".join(f"{x:+.4f}" for x in value) if vector else f"{value:.4g}"
    return text if varied else f"({text})"


@physics.command()
def law_test(
    keys: Annotated[list[str] | None, typer.Argument(help="Attributes. Default: all.")] = None,
    every: Annotated[
        bool, typer.Option("--all", help="Show every trial, not only the worst.")
    ] = False,
    embodiment: Annotated[
        str, typer.Option(help="The robot: a name of the asset pack, or LEFT,RIGHT,DISTANCE.")
    ] = DEFAULT,
    as_json: Json = False,
) -> None:
    """Test each attribute by experiment: a textbook law, what it expects, what the simulator did.

    Each setting is tried alone, and with all other attributes varied at once. It needs no dataset;
    `rtphys physics audit` measures the labels of one. The exit code is 1 if a law is broken.
    """
    # Imported here: the simulator takes a second that no other command should wait for.
    from rtphys.laws.lab import Lab
    from rtphys.laws.law import law_tests_of, trials_of
    from rtphys.plan.kinematics import check_robot

    laws, without = law_tests_of(keys)
    for reason in without:
        say(reason, err=True)
    pack = default_pack()
    check_robot(pack, embodiment)
    lab, failed, total, rows = Lab(pack, embodiment=embodiment), 0, 0, list[Facts]()
    names = ("setting", "what", "expected", "measured", "unit", "error", "tolerance", "passed")
    for law in laws:
        trials = list(trials_of(lab, law))
        failed, total = failed + sum(not t.passed for t in trials), total + len(trials)
        shown = trials if every else worst(trials)
        rows += [facts_of(law.key, trial, *names) for trial in shown]
        if as_json:
            continue
        # Not a table, whose cells would wrap on a narrow terminal.
        say(f"\n{law.key}:  {law.law}")
        say(f"labels state a tolerance of {stated(law.key, law.settings[-1])}")
        say(f"{'':5}{'law':>10} {'simulator':>10} {'unit':6} {'error':>8}  at, and what")
        for t in shown:
            numbers = f"{t.expected:10.4g} {t.measured:10.4g} {t.unit:6} {100 * t.error:7.2g}%"
            setting = t.setting.removeprefix(f"{law.key} = ")
            say(f"{'ok' if t.passed else 'FAIL':5}{numbers}  {setting}: {t.what}")
    if as_json:
        say_json(rows)
    else:
        of = counted(len(laws), "attributes")
        say(f"{total - failed} of {total} trials obey the laws of {of}")
    if failed:
        raise typer.Exit(1)


def stated(key: str, value: Value) -> str:
    """The tolerance that a label of a value states, such as "0.05 at 0.5"."""
    unit = attribute(key).unit.strip("1")
    return (
        f"{attribute(key).deviation(value) or 0.0:.2g} {unit}".strip() + f" at {value_text(value)}"
    )


def worst(trials: "Sequence[Trial]") -> "list[Trial]":
    """Of each setting, the trial that came nearest to failing."""

    def used(trial: "Trial") -> float:
        """Share of the tolerance; an experiment of a library may allow no error at all."""
        if not trial.tolerance:
            return 0.0 if trial.passed else inf
        return trial.error / trial.tolerance

    worst_of: dict[str, Trial] = {}
    for trial in trials:
        known = worst_of.get(trial.setting)
        if known is None or used(trial) > used(known):
            worst_of[trial.setting] = trial
    return list(worst_of.values())


@physics.command()
def audit(
    dataset: Annotated[Path, typer.Argument(help="A folder with a manifest.json.")],
    out: Annotated[Path | None, typer.Option(help="Draw histograms here, one per task.")] = None,
    labels: Annotated[bool, typer.Option(help="Rebuild worlds and measure labels.")] = True,
    repeat: Annotated[int, typer.Option(min=0, help="Also repeat the first N demonstrations.")] = 0,
    as_json: Json = False,
) -> None:
    """Build each episode's world again and measure its label there, by experiment.

    Worlds are rebuilt from recipes, including looks. Experiments weigh bodies, throw balls at
    surfaces, turn joints and move servos; their results are compared with the label, and so is
    what the recipe draws. Then it shows, for each attribute, how accepted episodes differ from all
    attempts. `--repeat` also lets the expert demonstrate again, and checks at every step the forces
    on links, creep in the hands, and whether restitution acts. The exit code is 1 if anything
    deviates by more than its tolerance. docs/physics.md defines
    the labels.
    """
    from rtphys.laws.audit.selection import selections_by_task_dataset

    if repeat and not labels:
        raise BadValue("repeat", repeat, "it needs `labels`, which are left out")
    data, known = Dataset(dataset), library.names("tasks", None)
    if out is not None:  # refused before work of hours
        make_folder(out)
    for task in data.tasks if labels else ():
        if task not in known:
            raise UnknownName("task", task, known, dataset)

    def tell(text: str) -> None:
        if not as_json:
            say(text)

    report, sound = _labels(data, repeat, tell) if labels else ({}, True)
    selected: dict[str, list[Facts]] = {}
    for name, selections in selections_by_task_dataset(data).items():
        tell(f"\n{name}\n  {'attribute':24} {'accepted':>12} {'KS':>6} {'p':>8}")
        selected[name] = []
        for one in selections:
            accepted, attempted = one.accepted.sum(), len(one.attempted)
            counts = f"{accepted} of {attempted}"
            tell(f"  {one.key:24} {counts:>12} {one.distance:6.3f} {one.p:8.2g}  {one.sentence}")
            facts = facts_of(one.key, one, "distance", "p", "sentence")
            selected[name].append({**facts, "attempted": attempted, "accepted": accepted})
        if out is not None:
            from rtphys.report.figures import draw_selections

            draw_selections(selections, name, out / f"{name.replace('/', '_')}.png")
    if as_json:
        say_json({**report, "selection": selected})
    if not sound:
        raise typer.Exit(1)


def _labels(data: Dataset, repeat: int, tell: Callable[[str], None]) -> tuple[Facts, bool]:
    """Audits every label; as JSON, and whether all are sound."""
    from rtphys.episode.audit import Totals, audited

    totals, rows, shown = Totals(), list[Facts](), time.monotonic()
    for one in _mistakes_named(audited(data, repeat), data):
        totals.add(one)
        notes = {"problems": list(one.problems), "notes": list(one.notes)}
        wrong = [_measurement(m) for m in one.deviations]
        rows.append({"file": str(one.path), **notes, "deviations": wrong})
        for problem in one.problems:
            tell(f"{one.path}: {problem}")
        for m in one.deviations:
            label, measured = (value_text(v, ".6g") for v in (m.label, m.measured))
            values = f"label {label}, measured {measured} {attribute(m.key).unit}"
            tell(f"{one.path}: {m.key} at {m.place}: {values}, tolerance {m.tolerance:.3g}")
        for note in one.notes:
            tell(f"{one.path}: note: {note}")
        if time.monotonic() - shown > LINE_EVERY:
            shown = time.monotonic()
            say(f"{totals.episodes} of {counted(len(data), 'episodes')} measured", err=True)
    counts = f"in {totals.sound} of {counted(totals.episodes, 'episodes')}"
    tell(f"{counts}, the rebuilt world does what the label says")
    if totals.worst:
        tell(f"\n  {'attribute':24} {'values':>7} {'largest deviation':>18} {'allowed':>9}  unit")
    for key, m in sorted(totals.worst.items()):
        deviation = f"{m.deviation:18.2g} {m.tolerance:9.2g}  {attribute(key).unit}"
        tell(f"  {key:24} {totals.measured[key]:7} {deviation}")
    unmeasured = sorted(totals.unmeasured.items())
    for (key, why), count in unmeasured:
        tell(f"  {key:24} {count:7} not measured: {why}")
    report: Facts = {
        "episodes": totals.episodes,
        "sound": totals.sound,
        "worst": {key: _measurement(m) for key, m in sorted(totals.worst.items())},
        "measured": dict(sorted(totals.measured.items())),
        "unmeasured": [{"attribute": k, "why": why, "count": n} for (k, why), n in unmeasured],
        "labels": rows,
    }
    return report, totals.sound == totals.episodes


def _mistakes_named(audits: "Iterator[Audit]", data: Dataset) -> "Iterator[Audit]":
    """The audits of a dataset's episodes; what the code of a task raises becomes a `BadFile`."""
    for entry in data.task_datasets:
        for _ in range(entry.episodes):
            try:
                yield next(audits)
            except RtphysError:
                raise
            except Exception:
                with mistakes_named(load_task(entry.spec.episode.task)):
                    raise


def _measurement(m: "Measurement") -> Facts:
    facts = facts_of(m.key, m, "place", "label", "measured", "deviation", "tolerance")
    if facts["deviation"] is None:  # a component of a vector may be what is not finite
        facts["measured"] = None
    return {**facts, "unit": attribute(m.key).unit}
