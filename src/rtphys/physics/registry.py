"""The table of attributes, found in this package, in users' libraries and among plug-ins."""

import importlib
import inspect
import pkgutil
from collections.abc import Mapping
from functools import lru_cache
from importlib.metadata import entry_points
from pathlib import Path
from types import MappingProxyType, ModuleType
from typing import cast

from rtphys.core import library
from rtphys.core.errors import BadFile, UnknownName
from rtphys.core.python_file import load_file
from rtphys.physics.attribute import AnyAttribute, Attribute, Attributes

# The package with one module for each attribute. It is imported here and not on use: the import
# sets `rtphys.physics.attributes`, which then must become the function below and stay it.
BUNDLED = importlib.import_module("rtphys.physics.attributes")
ENTRY_POINTS = "rtphys.attributes"  # group in which an installed plug-in names its attributes


def attributes() -> Attributes:
    """Key -> attribute, sorted by key: the bundled thirteen and those of libraries and plug-ins.

    Raises:
        BadFile: a file that does not define exactly one attribute, or a key that exists already.
    """
    return _attributes(tuple(library.names("attributes").values()))


def attribute(key: str) -> AnyAttribute:
    """The attribute of this key.

    Raises:
        UnknownName: no such key; names the nearest match.
    """
    known = attributes()
    if key not in known:
        raise UnknownName("attribute", key, known)
    return known[key]


@lru_cache(maxsize=8)
def _attributes(files: tuple[Path, ...]) -> Attributes:
    by_key: dict[str, AnyAttribute] = {}
    origin: dict[str, str] = {}
    for cls, where in _classes(files):
        if (key := cls.key) in by_key:
            raise BadFile(where, f"attribute {key!r} exists already, in {origin[key]}")
        by_key[key], origin[key] = cls(), where
    known = MappingProxyType(dict(sorted(by_key.items())))
    _order(known, origin)
    return known


def in_order() -> tuple[AnyAttribute, ...]:
    """All attributes as they are applied: by key, but each behind its `applied_after`."""
    return _order(attributes(), {})


def _order(known: Attributes, origin: Mapping[str, str]) -> tuple[AnyAttribute, ...]:
    """Raises `UnknownName`, or `BadFile` for a circle; `origin`: key -> file, for the messages."""
    done: dict[str, AnyAttribute] = {}

    def place(key: str, below: tuple[str, ...]) -> None:
        if key in below:
            circle = " -> ".join((*below[below.index(key) :], key))
            raise BadFile(origin.get(key, key), f"applied_after leads in a circle: {circle}")
        if key not in done:
            for before in known[key].applied_after:
                if before not in known:
                    raise UnknownName(
                        "attribute in applied_after", before, known, origin.get(key, "")
                    )
                place(before, (*below, key))
            done[key] = known[key]

    for key in known:
        place(key, ())
    return tuple(done.values())


def _classes(files: tuple[Path, ...]) -> list[tuple[type[AnyAttribute], str]]:
    """Every attribute class, with the file or entry point that defines it."""
    classes: list[tuple[type[AnyAttribute], str]] = []
    for info in pkgutil.iter_modules(BUNDLED.__path__):
        module = importlib.import_module(f"{BUNDLED.__name__}.{info.name}")
        classes.append((_only_attribute(module, info.name), str(module.__file__)))
    classes += [
        (_only_attribute(load_file(path, "attribute"), path.stem), str(path)) for path in files
    ]
    for entry in entry_points(group=ENTRY_POINTS):
        cls = entry.load()
        _check_class(cls, entry.name, entry.value)
        classes.append((cls, entry.value))
    return classes


def _only_attribute(module: ModuleType, key: str) -> type[AnyAttribute]:
    own: list[type[AnyAttribute]] = [
        c
        for c in vars(module).values()
        if inspect.isclass(c) and issubclass(c, Attribute) and c.__module__ == module.__name__
    ]
    if len(own) != 1:
        raise BadFile(str(module.__file__), f"needs exactly one Attribute, has {len(own)}")
    _check_class(own[0], key, str(module.__file__))
    return own[0]


def _check_class(candidate: object, key: str, where: str) -> None:
    if not (inspect.isclass(candidate) and issubclass(candidate, Attribute)):
        raise BadFile(where, "does not name a subclass of rtphys.physics.attribute.Attribute")
    cls = cast(type[AnyAttribute], candidate)
    missing = [name for name in ("key", "unit", "nominal", "valid") if not hasattr(cls, name)]
    if missing:
        raise BadFile(where, f"{cls.__name__} does not say its {', '.join(missing)}")
    if cls.key != key:
        raise BadFile(where, f"the key is {cls.key!r}, the file or entry point {key!r}")
