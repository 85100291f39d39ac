"""Imports a user's Python file by its path: a task, an attribute, a policy."""

import importlib.util
import sys
import traceback
from pathlib import Path
from types import ModuleType

from rtphys.core.errors import BadFile


def load_file(path: Path, kind: str) -> ModuleType:
    """Run a file as a module of its own, anew at each call.

    It is not imported by its bare name: another file of that name, or a package, would be taken
    in its stead without a word.

    Raises:
        BadFile: no such file, not a Python file, or it raises.
    """
    name = f"rtphys_{kind}_{path.stem}"
    path = path.absolute()  # as Python names it in a traceback
    if not path.is_file():
        raise BadFile(path, f"no such {kind} file")
    spec = importlib.util.spec_from_file_location(name, path)
    if spec is None or spec.loader is None:
        raise BadFile(path, "is not a Python file")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module  # dataclasses look their module up
    try:
        spec.loader.exec_module(module)
    except Exception as error:
        del sys.modules[name]
        told = f"cannot be loaded: {type(error).__name__}: {error}{_place(error, path)}"
        raise BadFile(path, told) from error
    return module


def _place(error: Exception, path: Path) -> str:
    """The line of the file that the error came through; a SyntaxError names its own."""
    frames = traceback.extract_tb(error.__traceback__)
    lines = [frame.lineno for frame in frames if frame.filename == str(path)]
    return f" (line {lines[-1]})" if lines else ""
