"""Finds tasks, domains, manifests, attributes, protocols and robots in the library folders.

The bundled library is the checkout (editable install) or the package folder (wheel). A user's own
library is a folder with the same subfolders, added by `$RTPHYS_LIBRARY` or the option `library`.
A folder in `tasks/` is a suite: its tasks have names like all others, but only `suite:FOLDER` and
their whole names find them, so that no pattern mixes them with the tasks beside it.
"""

import fnmatch
import hashlib
import importlib
import importlib.util
import os
import sys
import traceback
from collections.abc import Iterable, Mapping
from copy import deepcopy
from functools import lru_cache
from itertools import chain
from pathlib import Path
from types import ModuleType

import yaml

from rtphys.core.bounds import YAML_BYTES
from rtphys.core.errors import BadFile, RtphysError, UnknownName, shortened
from rtphys.core.untrusted import parse_yaml, read_file

KINDS = {  # how the file of an entry ends; a robot's is in a folder of its name
    "tasks": ".py",
    "domains": ".yaml",
    "manifests": ".yaml",
    "attributes": ".py",
    "protocols": ".yaml",
    "robots": "/config.yml",
}


SUITE = "suite:"  # before the name of a suite, where a task may stand


class AmbiguousName(RtphysError):
    """A name that two libraries define: a dataset's label must have one meaning."""

    def __init__(self, kind: str, name: str, first: Path, second: Path) -> None:
        super().__init__(f"{kind[:-1]} {name!r} exists twice: {first} and {second}; rename one")


@lru_cache(maxsize=1)
def bundled() -> Path:
    """Root of the library that ships with rtphys."""
    package = Path(__file__).resolve().parents[1]
    return package if (package / "tasks").is_dir() else package.parents[1]


def roots() -> tuple[Path, ...]:
    """The bundled library, then each folder in `$RTPHYS_LIBRARY` (separated by os.pathsep)."""
    own = [Path(p) for p in os.environ.get("RTPHYS_LIBRARY", "").split(os.pathsep) if p]
    for path in own:
        if not path.is_dir():
            raise BadFile(path, "the library folder does not exist")
    return tuple(dict.fromkeys((bundled(), *[p.resolve() for p in own])))  # one may be named twice


def names(kind: str, suite: str | None = "") -> dict[str, Path]:
    """Name -> file (of a robot: folder) of every entry of one kind in all libraries, by name.

    It reads file names only, so that a broken file cannot break the list.

    Args:
        suite: of tasks, the folder in `tasks/`; empty: those of no suite; None: all.

    Raises:
        AmbiguousName: two libraries define the same name.
    """
    files: dict[str, Path] = {}
    for root in roots():
        folders = [root / kind / suite] if suite is not None else [root / kind, *_suites(root)]
        for path in chain.from_iterable(folder.glob(f"*{KINDS[kind]}") for folder in folders):
            entry = path.parent if KINDS[kind].startswith("/") else path
            name = entry.name.removesuffix(KINDS[kind])
            if name in files:
                raise AmbiguousName(kind, name, files[name], entry)
            if not name.startswith("_"):
                files[name] = entry
    return dict(sorted(files.items()))


def suites() -> dict[str, list[str]]:
    """Name of each suite of tasks -> its tasks."""
    found = sorted({folder.name for root in roots() for folder in _suites(root)})
    return {suite: list(names("tasks", suite)) for suite in found}


def _suites(root: Path) -> list[Path]:
    files = (root / "tasks").glob(f"[!_.]*/*{KINDS['tasks']}")
    return sorted({file.parent for file in files})


def matching(kind: str, patterns: Iterable[str], where: str | Path = "") -> tuple[str, ...]:
    """All names that match the patterns (`*`, `?`), each once, in the order of the patterns.

    Of tasks, `suite:NAME` stands for all of a suite.

    Raises:
        UnknownName: a pattern that matches nothing; names the nearest match, and the file `where`.
    """
    known, by_suite = names(kind), suites() if kind == "tasks" else {}
    in_suites = list(chain.from_iterable(by_suite.values()))
    matched: dict[str, None] = {}
    for pattern in patterns:
        if pattern.startswith(SUITE) and by_suite:
            suite = pattern.removeprefix(SUITE)
            if suite not in by_suite:
                raise UnknownName("suite", suite, by_suite, where)
            matches = by_suite[suite]
        else:
            matches = [pattern] if pattern in in_suites else fnmatch.filter(known, pattern)
        if not matches:
            raise UnknownName(kind[:-1], pattern, [*known, *in_suites], where)
        matched |= dict.fromkeys(matches)
    return tuple(matched)


def find(kind: str, name: str) -> Path:
    """The file of the entry of this name. Raises `UnknownName`, which names the nearest match."""
    known = names(kind, None if kind == "tasks" else "")
    if name not in known:
        raise UnknownName(kind[:-1], name, known)
    return known[name]


def top_of(kind: str, path: Path) -> Path:
    """The library's folder of this kind that an entry is in, directly or in a suite."""
    return next(top for root in roots() if (top := root / kind) in path.parents)


def read_yaml(path: Path) -> dict[str, object]:
    """Read a YAML file that holds one mapping.

    Raises:
        BadFile: not there, not readable, not YAML (names line and column), larger or deeper than
            is read, with a key twice or more aliases than a person writes, or not a mapping.
    """
    data = read_file(path, YAML_BYTES, links=True)
    try:
        content = deepcopy(parse_yaml(data.decode("utf-8")))
    except UnicodeDecodeError as error:
        raise BadFile(path, "is not UTF-8 text") from error
    except (yaml.YAMLError, RecursionError, ValueError) as error:
        mark = getattr(error, "problem_mark", None)
        where = f" at line {mark.line + 1}, column {mark.column + 1}" if mark else ""
        problem = getattr(error, "problem", None) or error
        raise BadFile(path, f"broken YAML{where}: {shortened(str(problem))}") from error
    if content is None:
        return {}
    if not isinstance(content, Mapping) or not all(isinstance(k, str) for k in content):
        raise BadFile(path, "must be a mapping of names to values")
    return dict(content)


# ---- a user's Python files -----------------------------------------------------------------------


def load_file(path: Path, kind: str, top: Path | None = None) -> ModuleType:
    """Run a file as a module of its own, anew at each call.

    It is not imported by its bare name: another file of that name, or a package, would be taken
    in its stead without a word. It may import its neighbours (`from ._bowls import nest`), which
    are loaded once.

    Args:
        top: a folder above the file's own that it may import from (`from .._bowls import nest`).

    Raises:
        BadFile: no such file, not a Python file, or it raises.
    """
    path = path.absolute()  # as Python names it in a traceback
    if not path.is_file():
        raise BadFile(path, f"no such {kind} file")
    # A package is made up for the folder, whose members its files are.
    top = path.parent if top is None else top.absolute()
    package = f"rtphys_{kind}_{hashlib.sha256(str(top).encode()).hexdigest()[:12]}"
    _make_package(package, top)
    if top != path.parent:
        package = f"{package}.{path.parent.name}"
        _make_package(package, path.parent)
    name = f"{package}.{path.stem}"
    spec = importlib.util.spec_from_file_location(name, path)
    if spec is None or spec.loader is None:
        raise BadFile(path, "is not a Python file")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module  # dataclasses look their module up
    try:
        spec.loader.exec_module(module)
    except Exception as error:
        del sys.modules[name]
        what = f"{type(error).__name__}: {error}".replace(package, "")
        raise BadFile(path, f"cannot be loaded: {what}{line_of(error, path)}") from error
    return module


def _make_package(name: str, folder: Path) -> None:
    if name not in sys.modules:
        sys.modules[name] = ModuleType(name)
        sys.modules[name].__path__ = [str(folder)]
        importlib.invalidate_caches()  # files may have been written since Python last looked


def line_of(error: Exception, path: Path) -> str:
    """` (line 12)`: where an error came through the file, or else a neighbour that it imports.

    A SyntaxError names its own.
    """
    for frame in reversed(traceback.extract_tb(error.__traceback__)):
        if frame.filename == str(path):
            return f" (line {frame.lineno})"
        if Path(frame.filename).parent == path.parent:
            return f" (line {frame.lineno} of {Path(frame.filename).name})"
    return ""
