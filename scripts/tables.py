"""Write generated tables into the documents: `make tables`; `--check` only compares.

The function NAME generates the table between `<!-- table: NAME -->` and `<!-- end -->`.
"""

import inspect
import re
import sys
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from functools import cache
from pathlib import Path

import coverage
import labels
import numpy as np
import policy_tables
import relevance
from com_inside import Bodies, narrowed, survival
from masses import theirs as robotwin_mass
from numpy.typing import NDArray

import results
from rtphys import task as vocabulary
from rtphys.analysis.identify import read_result
from rtphys.assets.pack import default_pack
from rtphys.core import library
from rtphys.core.poses import Array
from rtphys.data.schema import FailureMeta
from rtphys.physics import attributes, load_domain
from rtphys.physics.load import domain_for_task
from rtphys.report import figures
from rtphys.results import Rate
from rtphys.results.instances import BENCHMARK, InstanceList, read_lists
from rtphys.studies.rates import SHARES, costs, rates
from rtphys.task.spec import load_task, task_names

REPLAYS = ("replay", "twin")  # columns of a certified list
BENCHMARKED = ("clean", "official_random", "phys_random", "phys_random_all")
PROTOCOLS = ("clean", "phys_random")  # of the success rates shown
TRIED = ("clean", "phys_random_all")  # with other robots
BLIND = {
    "idle": "keeps its posture",
    "random": "moves both arms and grippers slowly at random",
    "jitter": "commands the present posture plus noise of 0.1 rad, grippers too",
}
SEES = ("joints", "touch", "memory")  # what a learner is shown beside pictures
EPISODES = 100  # of each task
BEFORE = ("unsettled", "layout", "invalid_physics")  # reasons of a seed that does not begin
SHUFFLED = "expert:shuffled"
# Tasks whose hidden value is continuous: whether one value will do for another one.
NEAR: dict[str, Callable[[Array, Array], NDArray[np.bool_]]] = {
    "balance_the_bar": lambda true, taken: abs(taken - true) < 0.02,  # half of the support
    "carry_the_loaded": lambda true, taken: abs(taken - true) < 0.04,  # two thirds on a hand
    "slide_to_mark": lambda true, taken: abs(taken / true - 1) < 0.02 / 0.1375,  # half the mark
}
MADE_FOR = (
    ("object_mass", "heft"),
    ("friction", "rub"),
    ("friction", "push"),
    ("object_joint_damping", "swing"),
    ("table_height", "tap"),
    ("table_tilt", "tap"),
    ("arm_joint_damping", "heft"),
)
CARRIES = 0.05  # fall of R2 from which a group of features is named
CORES = (4, 16, 64)
# Fields of a label that the schema does not explain, or in fewer words than a reader needs.
FIELDS = {
    "schema_version": "version of the dataset",
    "seed": "the episode's seed",
    "task": "the task's name",
    "protocol": "the protocol's name",
    "episode": "number in its task dataset",
    "domain.name": "the file in `domains/`",
    "domain.digest": "SHA-256 of its resolved ranges",
    "attributes": "by key, such as `friction`; thirteen, and those of a library of yours",
    "attributes.*.unit": "`×` is a factor on the asset's or servo's own value, `1` a plain number",
    "attributes.*.source": "who chose the value: nobody, the domain, the user, RoboTwin's look",
    "draws": "`camera_mode`, `camera_direction`; `center_of_mass_redraws`: how many "
    "draws lay outside a body before this one",
    "readback": "What the simulator said after everything was applied.",
    "readback.bodies": "by object: `mass`, `inertia`, `com`, `spin_decay`",
    "readback.surfaces": "by object, and `table` and `gripper`: both frictions, `restitution`",
    "readback.joints": "by joint of an object: `damping`, `friction`",
    "readback.servos": "by joint of the robot: `damping`",
    "readback.scale": "by object: its size as a factor",
    "readback.external_force": "by object: N, world",
    "visual.split": "which textures were drawn from",
    "visual.wall_texture": "the same of the wall",
    "visual.lights": "RGB of `ambient`, `directional` and `points`; null: as in clean",
    "visual.clutter": "`name`, `category` and `model` of each piece",
    "cameras.*.quaternion_wxyz": "in the world",
    "cameras.*.position": "m, in the world",
    "verdict.accepted": "whether it counts as a demonstration",
    "verdict.first_success_time": "s since the first frame",
    "verdict.stages": "`name` and first `time` [s] of each motion of the expert",
    "recipe": "all that makes the episode again: the whole `spec`, and the seed",
    "versions": "packages, and digests of `code`, the `task` file and a library's `robot`",
    "state_hash": "SHA-256 of the recorded states; equal on every machine",
    "failure.detail": "the same in words",
    "failure.event": "what happened (see Failures)",
    "failure.time": "s since the first frame",
}
ROOT = Path(__file__).resolve().parents[1]
DOCS = ROOT / "docs"
DOCUMENTS = (
    DOCS / "fifty_tasks.md",
    DOCS / "dataset.md",
    DOCS / "objects.md",
    DOCS / "domains.md",
    DOCS / "physics.md",
    DOCS / "masses.md",
    DOCS / "scale.md",
    DOCS / "benchmark.md",
    DOCS / "identify.md",
    DOCS / "maps.md",
    DOCS / "physics_suite.md",
    DOCS / "training_set.md",
    DOCS / "visual_policy.md",
    DOCS / "reference" / "task.md",
)
SHOWN = ("block", "plate", "071_can", "001_bottle", "021_cup", "081_playingcards", "043_book")
DRAWN = 100  # number of layouts per task for which centres of mass are drawn


def tasks() -> str:
    """Table of bundled tasks, with the first sentence of each file."""
    domains, measured = library.names("domains"), rates()
    rows = []
    for name in sorted(library.names("tasks")):
        task = load_task(name)
        what = task.doc.strip().partition("\n\n")[0].replace("\n", " ")
        domain = f"`{name}`" if name in domains else "`global`"
        by_protocol = measured.get(name, {})
        shown = [str(by_protocol.get(protocol, "")) for protocol in PROTOCOLS]
        rows.append((f"`{name}`", what, task.mechanism, task.arms, domain, *shown))
    return _table(("task", "what", "mechanism", "arms", "domain", *PROTOCOLS), rows)


def task_vocabulary() -> str:
    """Table of what a task file may import, and of the methods that a script calls."""
    rows = []
    for name in vocabulary.__all__:
        found = getattr(vocabulary, name)
        if inspect.isclass(found) or inspect.isfunction(found):
            rows.append((f"`{name}`", _first_line(found)))
        methods = vars(found).items() if name in ("Arm", "Robot", "Scene", "Draw") else ()
        for method, function in methods:
            if inspect.isfunction(function) and not method.startswith("_"):
                rows.append((f"`{name}.{method}`", _first_line(function)))
    return _table(("name", "what"), rows)


def _first_line(thing: object) -> str:
    return (inspect.getdoc(thing) or "").partition("\n")[0].replace("|", "\\|")


def physics() -> str:
    """Table of attributes, with their range in the global domain."""
    rules = load_domain("global").rules
    rows = []
    for key, attribute in attributes().items():
        nominal = "the asset's" if attribute.nominal is None else str(attribute.nominal)
        rows.append((f"`{key}`", attribute.what, attribute.unit, nominal, str(rules.get(key, ""))))
    return _table(("attribute", "what", "unit", "nominal", "global range"), rows)


def center_of_mass() -> str:
    """Table of tasks with their own range: share of draws outside the body, own and global."""
    bodies, whole = Bodies(default_pack()), load_domain("global")
    rows = []
    for name, domain in narrowed().items():
        shares = [1 - survival(name, d, bodies, range(DRAWN)).share for d in (domain, whole)]
        shown = [f"{share:.0%}" for share in shares]
        rows.append((f"`{name}`", str(domain.rules["center_of_mass"]), *shown, domain.why))
    return _table(("task", "own range [m]", "outside, own", "outside, global", "why"), rows)


def com_rejection() -> str:
    """Table of tasks with something to move: draws that survive, and their spread."""
    bodies, rows = Bodies(default_pack()), []
    for name in sorted(library.names("tasks")):
        if not bodies.solids(load_task(name).props(0)):
            continue
        found = survival(name, domain_for_task(name), bodies, range(DRAWN))
        spreads = [_millimetres(spread) for spread in (found.drawn, found.left)]
        rows.append((f"`{name}`", f"{found.share:.0%}", *spreads))
    return _table(("task", "first draws that survive", "drawn [mm]", "left [mm]"), rows)


def _millimetres(spread: Iterable[float]) -> str:
    return ", ".join(f"{1000 * value:.1f}" for value in spread)


def feasibility() -> str:
    """Table of tasks with their own domain: share of feasible seeds, own and global."""
    measured = results.load("feasibility")
    seeds, rows = measured["seeds"], list[tuple[str, ...]]()
    for name, of_domain in measured["tasks"].items():
        for domain in ("own", "global"):
            found = of_domain[domain]
            begins = seeds - sum(found.get(reason, 0) for reason in BEFORE)
            counts = sorted(found.items(), key=lambda item: (-item[1], item[0]))
            lost = ", ".join(
                f"{count} {reason}" for reason, count in counts if reason != "accepted"
            )
            shares = (f"{count / seeds:.0%}" for count in (begins, found.get("accepted", 0)))
            rows.append((f"`{name}`", domain, *shares, lost))
    return _table(("task", "domain", "begins", "accepted", f"rejected, of {seeds}"), rows)


def slip() -> str:
    """Table of objects that stand: push at which they slide, by the distance of their mass."""
    measured = results.load("slip")
    aside = sorted({a for row in measured.values() for a in row["slip"]}, key=float)
    footed = [name for name, row in measured.items() if row["feet"]]
    off = [
        n
        for n in measured
        if any(low < 0.97 or high > 1.03 for low, high in measured[n]["slip"].values())
    ]
    plain = [name for name in footed if name not in off]
    groups = {f"{len(plain)} of {len(footed)} on feet": plain}
    named = [n for n in SHOWN if n in plain] + sorted({*off, *measured} - {*plain})
    rows = []
    for title, names in {**groups, **{f"`{n}`": [n] for n in named}}.items():
        found = [measured[n]["slip"] for n in names]
        cells = (_extremes([s[a] for s in found if a in s]) for a in aside)
        turned = max((measured[n]["turned_deg"] for n in names), default=0)
        rows.append((title, *cells, f"{turned:.0f}"))
    return _table(("object", *(f"{a} mm" for a in aside), "turned [deg]"), rows)


def masses() -> str:
    """Table of what the tasks move: kilograms here, in RoboTwin, and how many times as much."""
    rows = []
    for kind, by_task in results.load("masses").items():
        groups: dict[float, list[str]] = {}
        for task in by_task:
            groups.setdefault(robotwin_mass(task, kind), []).append(task)
        for other, named in sorted(groups.items()):
            counts, least, most = zip(*(by_task[task] for task in named), strict=True)
            low, high = min(least), max(most)
            names = ", ".join(f"`{task}`" for task in named)
            times = _span(float(f"{low / other:.2g}"), float(f"{high / other:.2g}"))
            cells = (str(max(counts)), _span(low, high), f"{other:g}", times, names)
            rows.append((f"`{kind}`" if kind[0].isdigit() else kind, *cells))
    return _table(("object", "parts", "here [kg]", "RoboTwin [kg]", "times", "tasks"), rows)


def _span(low: float, high: float) -> str:
    return f"{low:g}" if low == high else f"{low:g} to {high:g}"


def _extremes(pairs: list[list[float]]) -> str:
    """Least and largest of several ranges; empty if there are none."""
    if not pairs:
        return ""
    return f"{min(low for low, _ in pairs):.2f} to {max(high for _, high in pairs):.2f}"


def benchmark() -> str:
    """Table of certified lists: length, and success of both open-loop replays."""
    lists = {protocol: of for protocol, of in _certified().items() if protocol in BENCHMARKED}
    rows = [
        (f"`{task}`", *(_cell(of[task]) if task in of else "" for of in lists.values()))
        for task in sorted({task for of in lists.values() for task in of})
    ]
    return _table(("task", *(f"`{protocol}`" for protocol in lists)), rows)


def replays() -> str:
    """Table of protocols: the numbers of `benchmark`, over all tasks."""
    rows = []
    for protocol, of in sorted(_certified().items(), key=lambda each: _in_order(each[0])):
        shown = [_replayed(of.values(), name) for name in REPLAYS]
        rows.append((f"`{protocol}`", str(len(of)), _length(of.values()), *shown))
    return _table(("protocol", "tasks", "feasible of tried", *REPLAYS), rows)


def _in_order(protocol: str) -> tuple[str, int]:
    """Sorts protocols by name, those of a severity by its percentage."""
    name, _, share = protocol.rpartition("_")
    return (name, int(share)) if share.isdigit() else (protocol, 0)


def blind() -> str:
    """Table of the policies that see nothing: successes of trials under each protocol."""
    trials = results.load("blind")["trials"]
    protocols = list(next(iter(trials.values())))
    rows = [
        (f"`{policy}`", BLIND[policy], *(_solved(by_protocol[name]) for name in protocols))
        for policy, by_protocol in trials.items()
    ]
    return _table(("policy", "what it does", *(f"`{name}`" for name in protocols)), rows)


def _solved(of: dict[str, list[int]]) -> str:
    """Successes and trials of all tasks, of which each has successes and trials."""
    return "{} of {}, {} tasks".format(*map(sum, zip(*of.values(), strict=True)), len(of))


def knowing_suite() -> str:
    """Table of the physical suite: chance, and what the label, a belief and feeling achieve."""
    solved = results.load("knowing_suite")["solved"]
    lists = read_lists(ROOT / "manifests" / "physics" / "clean.jsonl")
    senseless = [policy for policy in BLIND if policy in solved]
    head = ("task", "chance", "feasible of tried", "knows", "blind", "feels", "worth", *senseless)
    rows = []
    for task in library.suites()["physics"]:
        knows, blind, feels = (solved[policy][task] for policy in ("expert", SHUFFLED, "feels"))
        rates = (_rate(one) for one in (knows, blind, feels))
        none = (f"{(of := solved[policy][task]).count('1')} of {len(of)}" for policy in senseless)
        length = _length([lists[task]])
        row = (f"`{task}`", f"{_chance(task):.0%}", length, *rates, _worth(knows, blind), *none)
        rows.append(row)
    return _table(head, rows)


def knowing_fifty() -> str:
    """Table of the fifty tasks' scripts that ask for physics: what each attribute is worth."""
    measured = results.load("knowing_fifty")
    rows = list[tuple[str, ...]]()
    for policy, moved in measured["moved"].items():
        tasks, blind = [*moved], "".join(measured["solved"][policy].values())
        knows = "".join(measured["solved"]["expert"][task] for task in tasks)
        others = "".join(moved.values()).count("1")
        counts = (f"{one.count('1')} of {len(one)}" for one in (knows, blind))
        key = policy.removeprefix("expert:").removesuffix("=shuffled")
        row = (f"`{key}`", str(len(tasks)), f"{others} of {len(blind)}", *counts)
        rows.append((*row, _worth(knows, blind)))
    head = ("believed wrong", "tasks that ask for it", "episodes that end otherwise")
    return _table((*head, "knows", "blind", "worth"), rows)


def learner() -> str:
    """Table of networks trained on what `feels` does, by what they see beside pictures."""
    rows = []
    for task, solved in results.load("learner").items():
        rates = (_rate(solved[sees]) if sees in solved else "" for sees in SEES)
        rows.append((f"`{task}`", f"{_chance(task):.0%}", *rates))
    return _table(("task", "chance", *SEES), rows)


def suite_tolerance() -> str:
    """Table of the physical suite: attributes that break a replay, and how far each may go."""
    rows = []
    for task, found in results.load("sensitivity_suite").items():
        broken = [
            f"`{key}` {of['tolerance'][0]:.3g} to {of['tolerance'][1]:.3g}"
            for key, of in found["attributes"].items()
            if of["share"] < 1
        ]
        shown = ", ".join(broken) or "none" if found["seeds"] else "no replay succeeds"
        rows.append((f"`{task}`", shown))
    return _table(("task", "attributes that break a replay, and what it tolerates"), rows)


def suite_robots() -> str:
    """Table of the physical suite on other robots: attempts of the expert that succeed."""
    measured = results.load("robots_physics")
    rows = [
        (f"`{task}`", *(_accepted(of[p].get(task)) for of in measured.values() for p in TRIED))
        for task in library.suites()["physics"]
    ]
    head = (f"`{robot}`, {protocol}" for robot in measured for protocol in TRIED)
    return _table(("task", *head), rows)


def _accepted(counts: dict[str, int] | None) -> str:
    return f"{counts.get('accepted', 0)} of {counts['seeds']}" if counts else ""


def hidden() -> str:
    """Table of a classifier on first frames: what is hidden, and what is not."""
    rows = [
        (f"`{task}`", str(of["hidden"]["episodes"]), *(_auc(of[q]) for q in ("hidden", "control")))
        for task, of in results.load("hidden").items()
    ]
    return _table(("task", "episodes", "AUC of what is hidden", "of a prop's place"), rows)


def _auc(found: dict[str, float]) -> str:
    return "{auc:.2f} ({low:.2f} to {high:.2f})".format_map(found)


def _rate(solved: str) -> str:
    rate = Rate(solved.count("1"), len(solved))
    low, high = (100 * bound for bound in rate.interval)
    return f"{rate.successes} of {rate.trials} ({low:.0f} to {high:.0f} %)"


def _worth(first: str, second: str) -> str:
    """Percentage points by which the first is better on the same seeds, and a 95 % interval.

    The interval is that of Agresti and Min (2005) for paired proportions.
    """
    only_first = sum(a > b for a, b in zip(first, second, strict=True)) + 0.5
    only_second = sum(a < b for a, b in zip(first, second, strict=True)) + 0.5
    n, more = len(first) + 2, only_first - only_second
    half = 1.96 * (only_first + only_second - more**2 / n) ** 0.5 / n
    better = 100 * (first.count("1") - second.count("1")) / len(first)
    low, high = (100 * max(-1.0, min(1.0, more / n + side * half)) for side in (-1, 1))
    digits = 0 if high - low > 5 else 1
    return f"{better:.0f} ({low:.{digits}f} to {high:.{digits}f})"


@cache
def _chance(task: str) -> float:
    """How often another seed's hidden values lead to what these ask for, of all pairs of 1,000."""
    domain, seeds = domain_for_task(task).by_prop, range(1000)
    keys = [key for key in domain.keys if "@" in key]
    draws = (domain.sample(seed, keys, task=task) for seed in seeds)
    hidden = np.array([[_first(drawn[key]) for key in keys] for drawn in draws])
    if task in NEAR:
        right = NEAR[task](hidden[:, None, 0], hidden[:, 0])
    else:
        order = hidden.argsort()
        right = (order[:, None] == order).all(axis=-1)
    return (right.sum() - len(seeds)) / (len(seeds) * (len(seeds) - 1))  # none with itself


def _first(value: object) -> float:
    return float(value[0] if isinstance(value, tuple) else value)  # pyright: ignore


def _certified() -> dict[str, dict[str, InstanceList]]:
    """Certified lists by protocol and task."""
    paths = sorted((ROOT / "manifests" / BENCHMARK).glob("*.jsonl"))
    return {path.stem: read_lists(path) for path in paths}


def _cell(instances: InstanceList) -> str:
    shown = (f"{name} {share}" for name in REPLAYS if (share := _replayed([instances], name)))
    return "; ".join((_length([instances]), *shown))


def _length(lists: Iterable[InstanceList]) -> str:
    sizes = [(len(listed.feasible), listed.attempts) for listed in lists]
    return "{} of {}".format(*map(sum, zip(*sizes, strict=True)))


def _replayed(lists: Iterable[InstanceList], name: str) -> str:
    """Share of the feasible instances that a replay solves; their number, where some lack it."""
    results = [getattr(one, name) for listed in lists for one in listed.feasible]
    known = [result for result in results if result is not None]
    if not known:
        return ""
    share = f"{sum(known) / len(known):.0%}"
    return share if len(known) == len(results) else f"{share} of {len(known)}"


def episode_costs() -> str:
    """CPU-s and MB of an episode of each task, in three columns."""
    cells = [
        f"`{task}` {of.cpu:.1f} s, {of.megabytes:.0f} MB" for task, of in sorted(costs().items())
    ]
    cells += [""] * (-len(cells) % 3)
    rows = [tuple(cells[n : n + 3]) for n in range(0, len(cells), 3)]
    return _table(("", "", ""), rows)


def collection_costs() -> str:
    """Table of protocols: what a hundred episodes of every task cost, by cores."""
    known, seeds, rows = costs(), rates(), list[tuple[str, ...]]()
    cpu = EPISODES * sum(cost.cpu for cost in known.values())
    gigabytes = EPISODES * sum(cost.megabytes for cost in known.values()) / 1e3
    for protocol, (of_cpu, of_bytes) in SHARES.items():
        tried = [seeds[task][protocol] for task in task_names()]
        attempts = sum(EPISODES * rate.seeds / rate.accepted for rate in tried)
        minutes = (f"{of_cpu * cpu / cores / 60:.0f}" for cores in CORES)
        whole = f"{of_cpu * cpu / 3600:.1f}", f"{of_bytes * gigabytes:.0f}"
        rows.append((f"`{protocol}`", f"{attempts:.0f}", *whole, *minutes))
    titles = (f"min, {cores} cores" for cores in CORES)
    return _table(("protocol", "attempts", "CPU-hours", "GB", *titles), rows)


def label() -> str:
    """Table of every field of a label, also of a failure's, from the schema."""
    schema, words = FailureMeta.model_json_schema(), dict(FIELDS)
    rows = list(_fields(schema, schema, "", words))
    if words:
        raise SystemExit(f"tables.py: a label has no field {[*words]}")
    return _table(("field", "type", "what"), rows)


def _fields(
    schema: dict, part: dict, prefix: str, words: dict[str, str]
) -> Iterator[tuple[str, str, str]]:
    """Rows of an object's fields; `words` loses what they take from it."""
    for name, field in part["properties"].items():
        path = prefix + name
        kinds = [_kind(schema, one) for one in field.get("anyOf", [field])]
        inner = next((one for _, one in kinds if one), None)
        known = field.get("description") or (inner or {}).get("description")
        what = words.pop(path, None) or known
        if what is None:
            raise SystemExit(f"tables.py: explain the field {path} of a label in FIELDS")
        yield f"`{path}`", " or ".join(kind for kind, _ in kinds), what.replace("|", "\\|")
        if inner:
            many = ".*." if kinds[0][0] == "map" else "."
            yield from _fields(schema, inner, path + many, words)


def _kind(schema: dict, field: dict) -> tuple[str, dict | None]:
    """A JSON type in a word, and the object that it holds or maps names to, if any."""
    if "$ref" in field:
        found = schema["$defs"][field["$ref"].rpartition("/")[2]]
        return ("object", found) if "properties" in found else ("any", None)
    if field.get("enum"):
        return ", ".join(f"`{one}`" for one in field["enum"] if one), None
    if field.get("type") == "object" and isinstance(
        held := field.get("additionalProperties"), dict
    ):
        return "map", _kind(schema, held)[1]
    kinds = {"array": "list", "object": "object", "integer": "integer", "null": "null"}
    kind: str = field.get("type", "any")
    return kinds.get(kind, kind), None


def broken_and_identifiable() -> str:
    """Table of attributes: how many tasks each breaks, and in how many it is identifiable."""
    tolerated = figures.tolerated_shares([*results.load("sensitivity_replay").values()])
    r2 = read_result(results.RESULTS / "identify_trees.json").r2()
    of_tasks = relevance.relevance(tolerated, r2).values()
    counts = Counter(pair for of in of_tasks for pair in of.items())
    rows = []
    for key in sorted({key for key, _ in counts}):
        tasks = [counts[key, kind] for kind in relevance.Relevance]
        rows.append((f"`{key}`", str(sum(tasks)), *map(str, tasks)))
    return _table(("attribute", "tasks", *(kind.value for kind in relevance.Relevance)), rows)


def probes() -> str:
    """Table of what each probe was made for: how well two estimators predict it there."""
    trees, column = (
        read_result(results.RESULTS / f"identify_probes{end}.json").tasks for end in ("", "_column")
    )
    rows = []
    for key, probe in MADE_FOR:
        of, by, line = trees[probe], trees[probe].scores[key], column[probe].scores[key]
        assert by.beyond is not None and line.beyond is not None
        low, high = by.interval
        carried = sorted(by.importance.items(), key=lambda item: -item[1])
        rows.append((
            f"`{key}`",
            f"`{probe}`",
            f"{of.episodes} of {of.attempts}",
            f"{by.r2:.2f} ({low:.2f} to {high:.2f})",
            f"{line.r2:.2f}",
            f"{by.shuffled:.2f}, {line.shuffled:.2f}",
            f"{by.beyond.r2:.2f}, {line.beyond.r2:.2f}",
            ", ".join(group for group, fall in carried if fall >= CARRIES),
        ))  # fmt: skip
    heads = "attribute,probe,solved,`trees`,`column`,shuffled,beyond,carried by"
    return _table(tuple(heads.split(",")), rows)


TABLES = {
    "probes": probes,
    "costs": episode_costs,
    "collection_costs": collection_costs,
    "label": label,
    "task_vocabulary": task_vocabulary,
    "tasks": tasks,
    "physics": physics,
    "center_of_mass": center_of_mass,
    "com_rejection": com_rejection,
    "feasibility": feasibility,
    "slip": slip,
    "masses": masses,
    "benchmark": benchmark,
    "replays": replays,
    "blind": blind,
    "knowing_suite": knowing_suite,
    "knowing_fifty": knowing_fifty,
    "learner": learner,
    "suite_tolerance": suite_tolerance,
    "suite_robots": suite_robots,
    "hidden": hidden,
    "relevance": broken_and_identifiable,
    **{
        name: lambda of=of: _table(*of())
        for name, of in (policy_tables.TABLES | coverage.TABLES | labels.TABLES).items()
    },
}


def filled(text: str) -> str:
    """Text of a document with all its tables generated again."""

    def table(match: re.Match[str]) -> str:
        return f"{match[1]}\n{TABLES[match[2]]()}\n{match[3]}"

    return re.sub(r"(<!-- table: (\w+) -->).*?(<!-- end -->)", table, text, flags=re.DOTALL)


def _table(head: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> str:
    lines = [head, tuple("---" for _ in head), *rows]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)


def main() -> int:
    """Update the documents; exit code 1 if `--check` finds an old table."""
    old = {path: path.read_text() for path in DOCUMENTS}
    new = {path: filled(text) for path, text in old.items()}
    changed = [path for path in DOCUMENTS if old[path] != new[path]]
    for path in changed:
        if "--check" in sys.argv:
            print(f"{path.name}: the tables are old; run `make tables`", file=sys.stderr)
        else:
            path.write_text(new[path])
    return int("--check" in sys.argv and bool(changed))


if __name__ == "__main__":
    sys.exit(main())
