"""What a physical attribute is, and which there are: the bundled ones, libraries' and plug-ins'."""

import importlib
import inspect
import pkgutil
from abc import ABC, abstractmethod
from collections.abc import Collection, Iterable, Mapping
from functools import lru_cache
from importlib.metadata import entry_points
from pathlib import Path
from types import MappingProxyType, ModuleType
from typing import Any, ClassVar, Generic, Literal, TypeVar, cast, get_args

import numpy as np

from rtphys.core import library
from rtphys.core.errors import BadFile, BadValue, UnknownName
from rtphys.core.library import load_file
from rtphys.physics.handles import Blueprint, Happened, World
from rtphys.physics.reach import MARK, split
from rtphys.physics.values import Interval, Physics, Value, Vector

Target = TypeVar("Target", Blueprint, World)
Label = TypeVar("Label", float, Vector)
Reading = float | Vector
# Dynamic bodies, joints of articulated task objects, and surfaces that something can touch.
Part = Literal["bodies", "joints", "surfaces"]
Stage = Literal["before_build", "after_build"]


class Attribute(ABC, Generic[Target, Label]):
    """One physical quantity that can vary between episodes, such as friction.

    `apply` starts from the asset's nominal value, never from the current one, so that repeating it
    changes nothing.
    """

    key: ClassVar[str]  # name in domain files, in dataset labels and on the command line
    unit: ClassVar[str]  # of values and labels; `apply` converts to SI
    nominal: ClassVar[float | Vector | None]  # None: the asset's own value
    valid: ClassVar[Interval]  # range of the simulator; a held value may go so far
    # Range of a value that one prop has; None: no prop has its own. An attribute that allows it
    # looks at nothing of the world but bodies, surfaces and joints, and finds those of that prop.
    by_prop: ClassVar[Interval | None] = None
    when: ClassVar[Stage] = "after_build"
    # Keys of attributes that write the same quantity and must have written it before this one does.
    applied_after: ClassVar[tuple[str, ...]] = ()
    size: ClassVar[int] = 1  # number of components, each drawn on its own: 1 or 3
    resolution: ClassVar[float] = 0.0  # absolute error of `read` in single precision
    # [1] Share of the value by which the world may differ: what `physics audit` resolves.
    tolerance: ClassVar[float] = 1e-3
    scope: ClassVar[str] = ""  # what that share, or `deviation`, is true of; empty: of everything
    auxiliary: ClassVar[tuple[str, ...]] = ()  # keys of further draws that it needs
    acts_on: ClassVar[Part | None] = None  # a world without any leaves it without effect
    what: ClassVar[str] = ""  # a phrase that describes it in tables

    def for_episode(self, physics: Physics) -> "Attribute[Target, Label]":
        """This attribute with the auxiliary draws of one episode filled in; most need none."""
        return self

    def could_act(self, parts: Collection[Part], value: Value) -> bool:
        """Whether it may change anything in a world with these parts; if not, it is no factor."""
        return self.acts_on is None or self.acts_on in parts

    def acted(self, happened: Happened) -> bool | None:
        """Whether another value would have changed an episode; None: it is not measured."""
        return None

    @abstractmethod
    def apply(self, target: Target, value: Label) -> None:
        """Write `value` (in `unit`) to the blueprint or to the built world."""

    @abstractmethod
    def read(self, world: World) -> dict[str, Reading]:
        """Name of each body, surface or joint -> its value in the simulator now, in `unit`."""

    def expected(self, world: World, value: Label) -> dict[str, Reading]:
        """What `read` must return after `apply(value)`."""
        return dict.fromkeys(self.read(world), value)

    def disagreements(self, world: World, value: Label) -> list[str]:
        """One sentence for each name at which the simulator's value differs from `value`."""
        read, expected = self.read(world), self.expected(world, value)
        wrong = [f"{self.key} at {n}: read nothing" for n in expected.keys() - read.keys()]
        for name, reading in read.items():
            want = expected.get(name)
            if want is None or not agree(reading, want, self.resolution):
                wrong.append(f"{self.key} at {name}: read {reading}, label says {want}")
        return sorted(wrong)

    def deviation(self, value: Value) -> float | None:
        """How far the world may be from the label `value`, in `unit`; None for the asset's own.

        What independent experiments in whole worlds found (docs/physics.md), not what `read` says.
        """
        if value is None:
            return None
        size = float(np.abs(np.asarray(value, float)).max())
        return max(self.tolerance * size, self.resolution)

    def check(self, value: Value, where: str = "", prop: str = "") -> None:
        """Raises `BadValue`: wrong type, wrong number of components, or outside `valid`.

        The value of one prop must be in `by_prop`.
        """
        key = f"{self.key}{MARK}{prop}" if prop else self.key
        valid = self.by_prop if prop and self.by_prop else self.valid
        if value is None and self.nominal is None:
            return
        components = len(value) if isinstance(value, tuple) else 1
        if components != self.size or value not in valid:
            parts = f"{self.size} numbers, each" if self.size > 1 else "a number"
            unit = "" if self.unit == "1" else f" {self.unit}"
            raise BadValue(key, value, f"it is {parts} in {valid}{unit}", where)


def agree(a: Reading, b: Reading, resolution: float) -> bool:
    """Whether two readings are equal within 1e-6 (relative) or `resolution` (absolute)."""
    x, y = np.atleast_1d(np.asarray(a, float)), np.atleast_1d(np.asarray(b, float))
    return x.shape == y.shape and np.allclose(x, y, rtol=1e-6, atol=resolution)


# Attributes of both stages and both label types stand in one table.
AnyAttribute = Attribute[Any, Any]
Attributes = Mapping[str, AnyAttribute]


# The package with one module for each attribute. It is imported here and not on use: the import
# sets `rtphys.physics.attributes`, which then must become the function below and stay it.
BUNDLED = importlib.import_module("rtphys.physics.attributes")
ENTRY_POINTS = "rtphys.attributes"  # group in which an installed plug-in names its attributes


def attributes() -> Attributes:
    """Key -> attribute, sorted by key: the bundled ones and those of libraries and plug-ins.

    Raises `BadFile`: a file that does not define exactly one attribute, or a key that exists
    already.
    """
    return _attributes(tuple(library.names("attributes").values()))


def attribute(key: str, where: str | Path = "", beside: Iterable[str] = ()) -> AnyAttribute:
    """The attribute of a key, such as `friction` or `friction@left_block`.

    Args:
        where: the file that names it.
        beside: other names that are known there, for the message.

    Raises `UnknownName`: no such attribute, or none that one prop can have.
    """
    known, (name, prop) = attributes(), split(key)
    if name not in known:
        raise UnknownName("attribute", name, {*known, *beside}, where)
    if key == f"{name}{MARK}":
        raise BadValue("key", key, f"write the prop behind {MARK}, or leave both out", where)
    if prop and not known[name].by_prop:
        single = {k for k, one in known.items() if one.by_prop}
        raise UnknownName(f"attribute of one prop in {key!r}:", name, single, where)
    return known[name]


def is_attribute(key: str) -> bool:
    """Whether it is a key of an attribute that is known here, and of no other draw."""
    return split(key)[0] in attributes()


def in_order() -> tuple[AnyAttribute, ...]:
    """All attributes as they are applied: by key, but each behind its `applied_after`."""
    known = attributes()
    return tuple(known[key] for key in _order(known, {}))


@lru_cache(maxsize=8)
def _attributes(files: tuple[Path, ...]) -> Attributes:
    found: list[tuple[object, str, str]] = []  # class, key by its place, file or entry point
    for info in pkgutil.iter_modules(BUNDLED.__path__):
        module = importlib.import_module(f"{BUNDLED.__name__}.{info.name}")
        found.append((_only_attribute(module), info.name, str(module.__file__)))
    found += [(_only_attribute(load_file(p, "attribute")), p.stem, str(p)) for p in files]
    found += [(e.load(), e.name, e.value) for e in entry_points(group=ENTRY_POINTS)]
    by_key: dict[str, AnyAttribute] = {}
    origin: dict[str, str] = {}
    for cls, key, where in found:
        if not (inspect.isclass(cls) and issubclass(cls, Attribute)):
            raise BadFile(where, "does not name a subclass of rtphys.physics.attribute.Attribute")
        cls = cast(type[AnyAttribute], cls)
        said = [name for name in ("key", "unit", "nominal", "valid") if not hasattr(cls, name)]
        if missing := [*said, *sorted(cls.__abstractmethods__)]:
            raise BadFile(where, f"{cls.__name__} does not define {', '.join(missing)}")
        if cls.key != key:
            raise BadFile(where, f"the key is {cls.key!r}, the file or entry point {key!r}")
        if key in by_key:
            raise BadFile(where, f"attribute {key!r} exists already, in {origin[key]}")
        if cls.acts_on not in (None, *get_args(Part)):
            raise UnknownName("part of a world in acts_on", cls.acts_on, get_args(Part), where)
        for name, value in (("valid", cls.valid), ("by_prop", cls.by_prop)):
            if not isinstance(value, Interval) and (value is not None or name == "valid"):
                raise BadValue(name, value, "it is an Interval(low, high)", where)
        if cls.when not in get_args(Stage):
            raise UnknownName("stage in when", cls.when, get_args(Stage), where)
        if not isinstance(cast(object, cls.applied_after), tuple):
            raise BadValue("applied_after", cls.applied_after, "it is a tuple of keys", where)
        if cls.size not in (1, 3):  # as labels store values
            raise BadValue("size", cls.size, "an attribute is a number (1) or a vector (3)", where)
        by_key[key], origin[key] = cls(), where
        by_key[key].check(cls.nominal, where)
    known = MappingProxyType(dict(sorted(by_key.items())))
    _order(known, origin)
    return known


def _only_attribute(module: ModuleType) -> type[AnyAttribute]:
    own: list[type[AnyAttribute]] = [
        c
        for c in vars(module).values()
        if inspect.isclass(c) and issubclass(c, Attribute) and c.__module__ == module.__name__
    ]
    if len(own) != 1:
        raise BadFile(str(module.__file__), f"needs exactly one Attribute, has {len(own)}")
    return own[0]


def _order(known: Attributes, origin: Mapping[str, str]) -> list[str]:
    """Raises `UnknownName`, or `BadFile` for a circle; `origin`: key -> file, for the messages."""
    done: list[str] = []

    def place(key: str, below: tuple[str, ...]) -> None:
        if key in below:
            circle = " -> ".join((*below[below.index(key) :], key))
            raise BadFile(origin.get(key, key), f"applied_after leads in a circle: {circle}")
        if key in done:
            return
        for before in known[key].applied_after:
            if before not in known:
                where = origin.get(key, "")
                raise UnknownName("attribute in applied_after", before, known, where)
            place(before, (*below, key))
        done.append(key)

    for key in known:
        place(key, ())
    return done
