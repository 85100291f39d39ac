"""A policy of the user's own: `python:MODULE:ATTRIBUTE`."""

import importlib
import sys
from pathlib import Path
from types import ModuleType

from rtphys.core.errors import BadValue, UnknownName
from rtphys.core.python_file import load_file
from rtphys.policies.policy import Policy, PolicySetup


def open_python(argument: str, setup: PolicySetup) -> Policy:
    """Calls `ATTRIBUTE(setup)` of a module, which returns a policy.

    MODULE is a dotted name, looked for beside the command's working folder as well, or the path of
    a Python file.

    Raises:
        BadValue: not `python:MODULE:ATTRIBUTE`, no such module, or what it made cannot play.
        BadFile: the file is not there, or raises when it is run.
        UnknownName: the module has no such attribute.
    """
    module_name, _, attribute = argument.rpartition(":")
    if not module_name or not attribute:
        raise BadValue("policy", f"python:{argument}", "write python:MODULE:ATTRIBUTE")
    module = _module(module_name)
    if not hasattr(module, attribute):
        known = [name for name in vars(module) if not name.startswith("_")]
        raise UnknownName(f"attribute of {module_name}", attribute, known)
    policy = getattr(module, attribute)(setup)
    if not callable(getattr(policy, "play", None)):
        told = f"it made a {type(policy).__name__}, which has no play(episode)"
        raise BadValue("policy", f"python:{argument}", told)
    return policy


def _module(name: str) -> ModuleType:
    path = Path(name)
    if path.suffix == ".py":
        _reach(path.resolve().parent)  # it may import its neighbours
        return load_file(path, "policy")
    _reach(Path.cwd())
    try:
        return importlib.import_module(name)
    except ModuleNotFoundError as error:
        told = f"Python finds no module {error.name!r}"
        raise BadValue("policy", f"python:{name}", told) from error


def _reach(folder: Path) -> None:
    if str(folder) not in sys.path:
        sys.path.append(str(folder))  # last: a user's random.py is not Python's
