"""Imports a user's Python file by its path: a task, an attribute, a policy."""

import hashlib
import importlib
import importlib.util
import sys
import traceback
from pathlib import Path
from types import ModuleType

from rtphys.core.errors import BadFile


def load_file(path: Path, kind: str) -> ModuleType:
    """Run a file as a module of its own, anew at each call.

    It is not imported by its bare name: another file of that name, or a package, would be taken
    in its stead without a word. It may import its neighbours (`from ._bowls import nest`), which
    are loaded once.

    Raises:
        BadFile: no such file, not a Python file, or it raises.
    """
    path = path.absolute()  # as Python names it in a traceback
    if not path.is_file():
        raise BadFile(path, f"no such {kind} file")
    package = _package(path.parent, kind)
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
        what = f"{type(error).__name__}: {error}".replace(package, "")  # a name made up here
        raise BadFile(path, f"cannot be loaded: {what}{line_of(error, path)}") from error
    return module


def _package(folder: Path, kind: str) -> str:
    """Name of the package, made up for this folder, whose members its files are."""
    name = f"rtphys_{kind}_{hashlib.sha256(str(folder).encode()).hexdigest()[:12]}"
    if name not in sys.modules:
        package = ModuleType(name)
        package.__path__ = [str(folder)]
        sys.modules[name] = package
        importlib.invalidate_caches()  # files may have been written since Python last looked
    return name


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
