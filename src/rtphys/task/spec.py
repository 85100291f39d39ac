"""A task: pure data and two functions, loaded by path from a library."""

import hashlib
import inspect
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import cast

from rtphys.core import library
from rtphys.core.code_digest import code_digest, imported_files
from rtphys.core.errors import BadFile, BadValue, Infeasible
from rtphys.core.library import load_file
from rtphys.physics.values import Value
from rtphys.task.arm import Robot
from rtphys.task.draw import Draw
from rtphys.task.props import Prop, check_names
from rtphys.task.success import Condition

Interval = tuple[float, float]
MIDDLE: tuple[Interval, Interval] = ((-0.2, 0.2), (-0.25, 0.0))
"""x and y [m] of the place before the robot where most tasks stack, row up and hand over."""


@dataclass(frozen=True)
class Phrases:
    """Sentence templates with RoboTwin's placeholders: `{A}` objects, `{a}` arms."""

    seen: tuple[str, ...]
    unseen: tuple[str, ...]


@dataclass(frozen=True)
class Task:
    """What to do. `name` is the file's name, filled in by the loader.

    Args:
        layout: yields the props of one episode from its draws.
        script: the expert; raises Infeasible, returns nothing.
        success: the condition, task frame, measured quantities.
        feel: finds out the physics that the script asks for, by acting: what the robot feels alone
            (`Arm.felt`) may decide; returns values by key.
        step_limit: policy actions of an evaluation episode (RoboTwin's own limit).
        info: placeholder values by placeholder letter: a prop name for `A`..; for `a`.. "left" or
            "right", "arm:<prop>" (the side of the table on which that prop starts) or
            "other:<prop>" (the opposite side).
        keep_clear: rectangles ((x0, x1), (y0, y1)) [m] of the table where no clutter may stand,
            beside the props' own places: where things are carried to, by default the middle.
        table_shift: (x, y) [m] of the table's centre; table_drop: [m] below the usual height.
    """

    layout: Callable[[Draw], Iterable[Prop]]
    script: Callable[[Robot], None]
    success: Condition | Callable[[list[Prop]], Condition]
    step_limit: int
    feel: Callable[[Robot], Mapping[str, Value]] | None = None
    phrases: Phrases = field(default_factory=lambda: Phrases((), ()))
    info: dict[str, str] = field(default_factory=dict[str, str])
    arms: str = "single"  # "single" | "dual" | "dual, in step" | "dual, in sequence"
    mechanism: str = ""
    table_shift: tuple[float, float] = (0.0, 0.0)
    table_drop: float = 0.0
    keep_clear: tuple[tuple[Interval, Interval], ...] = (MIDDLE,)
    name: str = ""
    doc: str = ""
    source: Path = Path()

    def props(self, seed: int) -> list[Prop]:
        """The layout of an episode; depends on the task and the seed alone.

        Raises:
            Infeasible: "layout", after 50 whole redraws.
            BadValue: two props have one name, one has a name that other things have, or a size or
                a mass that nothing has.
        """
        for retry in range(50):
            try:
                props = self._listed(self.layout(Draw(seed, retry, self.name)))
            except Infeasible as problem:
                if problem.reason != "layout":
                    raise
            except BadValue as problem:  # of a prop, which knows no task
                where = f"task {self.name}" + (f", {problem.where}" if problem.where else "")
                raise BadValue(problem.key, problem.value, problem.allowed, where) from problem
            else:
                check_names(props, f"task {self.name}")
                return props
        raise Infeasible("layout", "50 layouts in a row broke the task's spacing rules")

    def _listed(self, laid_out: object) -> list[Prop]:
        """What a layout yields. Raises `BadFile`: that is no props."""
        found = cast(Iterable[object], laid_out) if isinstance(laid_out, Iterable) else [laid_out]
        props: list[Prop] = []
        for prop in found:
            if not isinstance(prop, Prop):
                raise BadFile(self.source, f"layout must yield props, and gave {prop!r:.80}")
            props.append(prop)
        return props

    def sentences(self) -> Phrases:
        """Sentence templates: `phrases`, else the YAML beside the file, else the doc's first line.

        Raises:
            BadFile: the YAML does not hold two lists of sentences, `seen` and `unseen`.
        """
        if self.phrases.seen:
            return self.phrases
        path = self.source.parent / f"{self.source.stem}.yaml"
        if not path.is_file():
            line = self.doc.partition("\n")[0].rstrip(".") or self.name.replace("_", " ")
            return Phrases((line,), (line,))
        content = library.read_yaml(path)
        splits: list[tuple[str, ...]] = []
        for key in ("seen", "unseen"):
            value = content.pop(key, None)
            lines = cast(list[object], value) if isinstance(value, list) else []
            if not lines or not all(isinstance(line, str) for line in lines):
                raise BadFile(path, f"{key} must be a list of sentences")
            splits.append(tuple(map(str, lines)))
        if content:
            raise BadFile(path, f"has keys that nobody reads: {', '.join(content)}")
        return Phrases(*splits)

    @property
    def digest(self) -> str:
        """Digest of the task's code, its family's and its sentences, 16 hex digits."""
        files = imported_files(self.source, library.top_of("tasks", self.source))
        source = hashlib.sha256(code_digest(files).encode())
        if (phrases := self.source.with_suffix(".yaml")).is_file():
            source.update(phrases.read_bytes())
        return source.hexdigest()[:16]

    def condition(self, props: list[Prop]) -> Condition:
        """The success condition of one episode."""
        return self.success if isinstance(self.success, Condition) else self.success(props)


def load_task(name: str) -> Task:
    """A task by name from the libraries.

    Raises:
        UnknownName: with the nearest match.
        BadFile: the file does not define `task = Task(...)` or raises on import.
    """
    path = library.find("tasks", name)
    module = load_file(path, "task", library.top_of("tasks", path))
    task = getattr(module, "task", None)
    if not isinstance(task, Task):
        raise BadFile(path, "must define `task = Task(...)`")
    _check(task, path)
    object.__setattr__(task, "name", name)
    object.__setattr__(task, "doc", (module.__doc__ or "").strip())
    object.__setattr__(task, "source", path)
    return task


def _check(task: Task, path: Path) -> None:
    """Raises `BadFile`, `BadValue`: a part of a task is not what it must be."""
    for what, given in (("layout", task.layout), ("script", task.script)):
        if not _takes_one(given):
            raise BadFile(path, f"{what} must be a function of one argument")
    if not (isinstance(task.success, Condition) or _takes_one(task.success)):
        raise BadFile(path, "success must be a condition, or a function of the props")
    limit = cast(object, task.step_limit)
    if isinstance(limit, bool) or not isinstance(limit, int) or limit < 1:
        raise BadValue("step_limit", limit, "it is a number of actions, 1 or more", path)


def _takes_one(given: object) -> bool:
    """Whether it can be called with one argument."""
    try:
        inspect.signature(cast(Callable[..., object], given)).bind(None)
    except (TypeError, ValueError):
        return False
    return True


def task_names() -> list[str]:
    """Names of all tasks of no suite, from file names alone."""
    return list(library.names("tasks"))
