"""Finds and imports a plug-in the way RoboTwin's evaluation does."""

import importlib
import os
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

from rtphys.core.errors import BadFile, RtphysError

CONTRACT = ("get_model", "eval", "reset_model")


class BrokenPlugin(RtphysError):
    """A plug-in that cannot be imported, or whose model cannot be made."""


@dataclass(frozen=True)
class Plugin:
    """The three functions of `deploy_policy.py`, and the folder that it expects to run in."""

    name: str  # what RoboTwin calls policy_name; may be dotted
    root: Path  # RoboTwin's root, or the folder above the plug-in's
    get_model: Callable[[dict[str, object]], object]
    eval: Callable[[object, object, object], object]
    reset_model: Callable[[object], object]


def load_plugin(file: Path, name: str = "") -> Plugin:
    """Import a plug-in.

    Args:
        file: its `deploy_policy.py`, or whatever module has the three functions.
        name: dotted policy_name, as a launcher gives it; by default that of the file's folder.

    Raises:
        BadFile: no such file, or `name` does not lead to it.
        BrokenPlugin: importing it fails, or it lacks one of the three.
    """
    # Launchers link a policy's folder into RoboTwin's root: a link is where it is, not where it
    # leads to.
    file = Path(os.path.abspath(file))  # noqa: PTH100 - Path has nothing that keeps links
    if not file.is_file():
        raise BadFile(file, "no such plug-in; give the path of its deploy_policy.py")
    name = name or file.parent.name
    home = _home(file, name)
    root = home.parent if home.name == "policy" else home
    _reach(root, home)
    return _plugin(name, root, file.stem, file)


def plugin_named(name: str, root: Path) -> Plugin:
    """A plug-in by its dotted name, found from a RoboTwin root as its launchers find it.

    Raises:
        BrokenPlugin: importing it fails, or it lacks one of the three.
    """
    _reach(root)
    return _plugin(name, root, "deploy_policy")


def _reach(root: Path, *more: Path) -> None:
    for path in (root, root / "policy", root / "description" / "utils", *more):
        if path.is_dir() and str(path) not in sys.path:
            sys.path.append(str(path))


def _plugin(name: str, root: Path, inner: str, file: Path | None = None) -> Plugin:
    # A package may re-export the three (official ones do), or leave them in a file of its own.
    names = [name] if name.endswith(f".{inner}") else [name, f"{name}.{inner}"]
    where, lacking = str(file or f"policy_name {name!r}"), ""
    for candidate in names:
        try:
            module = importlib.import_module(candidate)
        except Exception as error:
            raise BrokenPlugin(f"{where}: {type(error).__name__}: {error}") from error
        if file is not None:
            _check_place(module, file)
        missing = [key for key in CONTRACT if not callable(getattr(module, key, None))]
        if not missing:
            return Plugin(name, root, *(getattr(module, key) for key in CONTRACT))
        lacking = ", ".join(missing)
    raise BrokenPlugin(f"{where}: has no {lacking}; a plug-in defines {', '.join(CONTRACT)}")


def _home(file: Path, name: str) -> Path:
    """The folder from which `import name` reaches the file."""
    parts = name.split(".")
    for folder in file.parents:
        target = folder.joinpath(*parts)
        if target == file.parent or target.with_suffix(".py") == file:
            return folder
    raise BadFile(file, f"policy_name {name!r} does not lead to this file")


def _check_place(module: ModuleType, file: Path) -> None:
    """Another package of the same name would be imported without a word."""
    places = [module.__file__] if module.__file__ else list(module.__path__)
    if not any(Path(place).resolve().is_relative_to(file.parent.resolve()) for place in places):
        name = module.__name__
        told = f"`import {name}` finds {places[0]} instead; rename the plug-in's folder"
        raise BrokenPlugin(f"{file}: {told}")
