"""Finds attributes in this package, in users' libraries and among plug-ins: no list to edit."""

import importlib
import inspect
import pkgutil
from functools import lru_cache
from importlib.metadata import entry_points
from pathlib import Path
from types import MappingProxyType, ModuleType

from rtphys.core import library
from rtphys.core.errors import BadFile, UnknownName
from rtphys.core.python_file import load_file
from rtphys.physics import attributes as bundled
from rtphys.physics.attribute import Attribute, Attributes

ENTRY_POINTS = "rtphys.attributes"


def attributes() -> Attributes:
    """Key -> attribute, sorted by key: the thirteen, then whatever libraries and plug-ins add.

    Raises:
        BadFile: a file without exactly one attribute, or with a key that another one has.
    """
    return _attributes(tuple(library.names("attributes").values()))


def attribute(key: str) -> Attribute:
    """One attribute.

    Raises:
        UnknownName: no such key; names the nearest match.
    """
    known = attributes()
    if key not in known:
        raise UnknownName("attribute", key, known)
    return known[key]


@lru_cache(maxsize=8)
def _attributes(files: tuple[Path, ...]) -> Attributes:
    found: dict[str, Attribute] = {}
    origin: dict[str, str] = {}
    for cls, where in _classes(files):
        if (key := cls.key) in found:
            raise BadFile(where, f"attribute {key!r} exists already, in {origin[key]}")
        found[key], origin[key] = cls(), where
    return MappingProxyType(dict(sorted(found.items())))


def _classes(files: tuple[Path, ...]) -> list[tuple[type[Attribute], str]]:
    classes: list[tuple[type[Attribute], str]] = []
    for info in pkgutil.iter_modules(bundled.__path__):
        module = importlib.import_module(f"{bundled.__name__}.{info.name}")
        classes.append((_only_attribute(module, info.name), str(module.__file__)))
    classes += [
        (_only_attribute(load_file(path, "attribute"), path.stem), str(path)) for path in files
    ]
    for entry in entry_points(group=ENTRY_POINTS):
        cls = entry.load()
        _check_class(cls, entry.name, entry.value)
        classes.append((cls, entry.value))
    return classes


def _only_attribute(module: ModuleType, key: str) -> type[Attribute]:
    own = [
        c
        for c in vars(module).values()
        if inspect.isclass(c) and issubclass(c, Attribute) and c.__module__ == module.__name__
    ]
    if len(own) != 1:
        raise BadFile(str(module.__file__), f"needs exactly one Attribute, has {len(own)}")
    _check_class(own[0], key, str(module.__file__))
    return own[0]


def _check_class(cls: object, key: str, where: str) -> None:
    if not (inspect.isclass(cls) and issubclass(cls, Attribute)):
        raise BadFile(where, "is no subclass of rtphys.physics.attribute.Attribute")
    missing = [name for name in ("key", "unit", "nominal", "valid") if not hasattr(cls, name)]
    if missing:
        raise BadFile(where, f"{cls.__name__} does not say its {', '.join(missing)}")
    if cls.key != key:
        raise BadFile(where, f"the key is {cls.key!r}, the file or entry point {key!r}")
