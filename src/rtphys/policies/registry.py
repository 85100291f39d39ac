"""Policies by specification, `NAME[:ARGUMENT[?key=value&key=value]]`; imported when opened."""

import ast
import hashlib
import importlib.util
import os
import sys
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from importlib.machinery import PathFinder
from itertools import product
from pathlib import Path
from types import MappingProxyType
from typing import Annotated
from urllib.parse import parse_qsl

from rtphys.core.dependencies import cure_of
from rtphys.core.errors import BadValue, RtphysError, UnknownName
from rtphys.core.library import load_file
from rtphys.data.files import facts_of
from rtphys.data.json_text import check_spelled
from rtphys.physics.attribute import is_attribute
from rtphys.policies.options import AskedOptions
from rtphys.policies.policy import Policy, PolicyBroken, PolicyGone, PolicySetup
from rtphys.sim import renderer
from rtphys.spec.option import at_least
from rtphys.task.spec import Task

Opener = Callable[[str, PolicySetup], Policy]
Seconds = Annotated[float, at_least(0.001, most=1e6)]

BUILTIN: dict[str, str] = {
    "idle": "rtphys.policies.baselines:Idle",
    "random": "rtphys.policies.baselines:RandomWalk",
    "jitter": "rtphys.policies.baselines:Jitter",
    "expert": "rtphys.policies.experts:open_expert",
    "feels": "rtphys.policies.experts:Feels",
    "replay": "rtphys.policies.baselines:open_replay",
    "robotwin": "rtphys.policies.robotwin_plugin:open_robotwin",
    "openpi": "rtphys.policies.openpi:open_openpi",
    "xpolicylab": "rtphys.policies.xpolicylab:open_xpolicylab",
    "lerobot": "rtphys.policies.lerobot:open_lerobot",
    "python": "rtphys.policies.registry:open_python",
}
"""Name of a policy -> "module:name" of its `Opener`, or of its class if it takes no argument."""

CHECKPOINTS = ("", "pretrained_model", "checkpoints/last/pretrained_model")
"""Where in a folder that `lerobot-train` has written a checkpoint may lie."""

WEIGHTS = ("*.safetensors", "*.pt", "*.pth", "*.ckpt", "*.bin", "*.npz")

WITHOUT_OPTIONS = ("idle", "random", "jitter", "expert", "feels", "replay")


def parse_spec(spec: str) -> tuple[str, str]:
    """Name and argument of a specification. Raises `UnknownName`: no such policy."""
    name, _, argument = spec.partition(":")
    if name not in BUILTIN:
        raise UnknownName("policy", name, BUILTIN)
    return name, argument


def literal(text: str) -> object:
    """Value of a Python literal, or the text itself if it is none."""
    try:
        return ast.literal_eval(text)
    except (ValueError, SyntaxError, MemoryError, RecursionError):
        return text


def split_options(text: str, more: Mapping[str, str]) -> tuple[str, dict[str, str]]:
    """What precedes `?` in an argument, and its options, which override `more`.

    Raises `BadValue`: an option without a value.
    """
    rest, _, tail = text.partition("?")
    try:
        tail = tail.replace("+", "%2B")  # a plus is a plus, as in the path before `?`
        pairs = parse_qsl(tail, keep_blank_values=True, strict_parsing=bool(tail))
    except ValueError as error:
        raise BadValue("policy", text, "options are ?key=value&key=value") from error
    return rest, {**more, **dict(pairs)}


def check_options(spec: str, given: Mapping[str, str]) -> None:
    """Refuse options that would be ignored.

    Raises `UnknownName`: no such policy; `BadValue`: the policy takes none, or one names physics,
    which the benchmark's instances decide; or a text is not UTF-8.
    """
    name, _ = parse_spec(spec)
    cure = "results hold UTF-8 text; rename the file, or write the option so"
    check_spelled("policy", " ".join((spec, *given, *given.values())), cure)
    for key, value in given.items():
        if is_attribute(key):
            cure = "physics follows from the protocol and the seed here, and no option holds it"
            raise BadValue("policy_option", f"{key}={value}", cure)
        if name in WITHOUT_OPTIONS:
            raise BadValue("policy_option", f"{key}={value}", f"the policy {name} has no options")


def check_task(spec: str, task: Task, protocols: Iterable[str]) -> None:
    """Refuses a policy of the task's own script that cannot run there.

    Raises `BadValue`: `feels` in a task that cannot be felt, or no such belief of the expert;
    `UnknownName`: a belief about something that the task does not have.
    """
    name, _ = parse_spec(spec)
    if name == "feels" and task.feel is None:
        cure = f"{task.name} has no `feel` to find physics out by; tasks of suite:physics have one"
        raise BadValue("policy", name, cure)
    if name == "expert":
        for protocol in protocols:
            open_policy(spec, PolicySetup(task.name, protocol)).close()


def files_digest(spec: str, options: Mapping[str, str] = MappingProxyType({})) -> str:
    """SHA-256 over the local files that a specification and options name; empty if they name none.

    A file stands for itself, a folder for its JSON and weights (`WEIGHTS`): so a dataset, or a
    LeRobot checkpoint, or what `lerobot-train` wrote around it. A RoboTwin plug-in stands for
    itself and the YAML beside it. A dotted module stands for its file, a package for all its Python
    files. What a Python file imports is not followed. An option whose value is a path names what is
    there.

    Raises `UnknownName`: no such policy; `BadValue`: an option without a value; `OSError`: a file
    cannot be read.
    """
    name, argument = parse_spec(spec)
    argument, options = split_options(argument, options)
    paths = (argument, argument.rpartition(":")[0])  # the second of `python:FILE:NAME`
    path = Path(next(filter(os.path.exists, paths), ""))  # an argument may be of any length
    found = [path] if path.is_file() else []
    if name == "robotwin" and (beside := path.with_suffix(".yml")).is_file():
        found.append(beside)
    if name == "python" and path.suffix != ".py":  # a package may lie in this folder
        found = _files_of_module(argument.rpartition(":")[0])
    elif path.is_dir() and path != Path():
        found += _files_of_folder(path)
    for _, text in sorted(options.items()):
        if os.path.isfile(text):  # noqa: PTH113 - a text of any length
            found.append(Path(text))
        elif os.path.isdir(text):  # noqa: PTH112
            found += _files_of_folder(Path(text))
    digests = [f"{file.name} {facts_of(file.resolve()).sha256}" for file in found]
    return hashlib.sha256("\n".join(digests).encode()).hexdigest() if digests else ""


def _files_of_folder(path: Path) -> list[Path]:
    """JSON and weights in a folder of a policy, or of a dataset."""
    places = product(CHECKPOINTS, ("*.json", *WEIGHTS))
    return sorted(file for inner, kind in places for file in (path / inner).glob(kind))


def edited(before: str, now: str) -> list[str]:
    """A clause where two `files_digest` of a policy are not the same, which cannot be continued."""
    if before == now:
        return []
    if not before:
        unknown = "it does not record the files of the policy, which may have been edited since"
        return [f"policy_files: {unknown}"]
    return ["policy_files: the files of the policy were edited since"]


def _files_of_module(name: str) -> list[Path]:
    """The file of a dotted module, or all of a package; empty where Python finds none.

    Nothing is imported, so a module that cannot be imported is reported where it is opened.
    """
    _search(Path.cwd())
    first, *rest = name.split(".")
    try:
        found = importlib.util.find_spec(first)
        for number, _ in enumerate(rest, start=2):
            inside = found and found.submodule_search_locations
            part = ".".join(name.split(".")[:number])
            found = PathFinder.find_spec(part, inside) if inside else None
    except (ImportError, ValueError):  # such as an empty name
        return []
    if found is None:
        return []
    inside = [Path(folder) for folder in found.submodule_search_locations or ()]
    files = sorted(file for folder in inside for file in folder.rglob("*.py"))
    origin = Path(found.origin or "")
    return files or ([origin] if origin.is_file() else [])


def _search(folder: Path) -> None:
    """Lets modules of a folder be imported, last: a user's random.py must not hide Python's."""
    if str(folder) not in sys.path:
        sys.path.append(str(folder))


def open_policy(spec: str, setup: PolicySetup | None = None) -> Policy:
    """Open the policy of a specification.

    Raises `UnknownName`: no such policy; `PolicyGone`: an optional dependency of rtphys is not
    installed; `PolicyBroken`: the policy raises, or lacks `needs_images`; `RtphysError`: the policy
    refuses its argument.
    """
    setup = setup or PolicySetup()
    name, argument = parse_spec(spec)
    module, _, attribute = BUILTIN[name].partition(":")
    options = AskedOptions(setup.options)
    try:
        opener: Opener = getattr(importlib.import_module(module), attribute)
    except ModuleNotFoundError as error:
        cure = cure_of(error)
        problem = f"Python finds no module {error.name!r}" + (cure and f"; {cure}")
        raise PolicyGone(name, problem) from error
    try:
        bare = isinstance(opener, type)
        if bare and argument:
            raise BadValue("policy", spec, f"{name} takes no argument")
        policy = opener() if bare else opener(argument, replace(setup, options=options))
        options.check()
        bool(policy.needs_images)
    except (RtphysError, KeyboardInterrupt):
        raise
    except BaseException as error:  # a library may end the process, or panic
        raise PolicyBroken(spec, "opened", error) from error
    return policy


class PolicySession:
    """A policy that stays open from one episode to the next, until the setup changes."""

    def __init__(self, spec: str) -> None:
        self.spec = spec
        self._home = Path.cwd()  # what a user names is relative to it
        self._open: tuple[PolicySetup, Policy] | None = None

    def policy(self, setup: PolicySetup) -> Policy:
        """The open policy. Raises what `open_policy` and `close` raise."""
        if self._open is None or self._open[0] != setup:
            self.close()
            os.chdir(self._home)  # an earlier one may have left it
            policy = open_policy(self.spec, setup)
            if policy.needs_images:
                renderer.hold_anchor()
            self._open = (setup, policy)
        return self._open[1]

    def close(self) -> None:
        """Closes it; the next episode opens another. Raises `PolicyBroken`: it cannot be closed."""
        opened, self._open = self._open, None
        if opened is None:
            return
        try:
            opened[1].close()
        except KeyboardInterrupt:
            raise
        except BaseException as error:
            raise PolicyBroken(self.spec, "closed", error) from error


def open_python(argument: str, setup: PolicySetup) -> Policy:
    """Opener of `python:MODULE:ATTRIBUTE`: calls `ATTRIBUTE(setup)` of a user's module.

    MODULE is the path of a Python file or a dotted name; the working directory is searched too.

    Raises `BadValue`: not `python:MODULE:ATTRIBUTE`, no such module, or its result is no policy;
    `BadFile`: the file does not exist, or raises when it is imported; `UnknownName`: the module has
    no such attribute, or an option is misspelt.
    """
    name, _, attribute = argument.rpartition(":")
    if not name or not attribute:
        raise BadValue("policy", f"python:{argument}", "write python:MODULE:ATTRIBUTE")
    path = Path(name)
    folder = path.resolve().parent if path.suffix == ".py" else Path.cwd()
    _search(folder)  # a file may import its neighbours
    try:
        module = (
            load_file(path, "policy") if path.suffix == ".py" else importlib.import_module(name)
        )
    except ModuleNotFoundError as error:
        problem = f"Python finds no module {error.name!r}"
        raise BadValue("policy", f"python:{name}", problem) from error
    if not hasattr(module, attribute):
        known = [name for name in vars(module) if not name.startswith("_")]
        raise UnknownName(f"attribute of {name}", attribute, known)
    policy = getattr(module, attribute)(setup)
    if not callable(getattr(policy, "play", None)):
        problem = f"it returned type {type(policy).__name__}, which has no play(episode)"
        raise BadValue("policy", f"python:{argument}", problem)
    return policy
