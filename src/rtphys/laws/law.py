"""A law test: the textbook law of one attribute, the values to test it at, and what comes out."""

import importlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from rtphys.core import library
from rtphys.core.errors import BadFile, RtphysError, UnknownName
from rtphys.core.library import line_of, load_file
from rtphys.laws.lab import Lab
from rtphys.physics.attribute import attribute, attributes
from rtphys.physics.domain import AUXILIARY, check_key
from rtphys.physics.values import Value

Values = Mapping[str, Value]  # attribute or auxiliary key -> value


# Every attribute varied at once; each law must hold among them too.
ALL_VARIED: Values = {
    "arm_joint_damping": 2.0,
    "camera_angle": 6.0,
    "camera_distance": 0.05,
    "camera_mode": "orbit",
    "camera_direction": (0.0, 1.0, 0.0),
    "center_of_mass": (0.01, 0.01, -0.01),
    "external_force": 0.05,
    "friction": 0.4,
    "gripper_joint_damping": 2.0,
    "object_joint_damping": 0.5,
    "object_mass": 2.0,
    "object_scale": 0.9,
    "restitution": 0.3,
    "table_height": -0.05,
    "table_tilt": 1.5,
}


@dataclass(frozen=True)
class Trial:
    """One number of an experiment: what the law expects and what the simulator did."""

    what: str  # "acceleration under 0.5 N"
    expected: float
    measured: float
    unit: str
    full: float = 0.0  # full scale of the error where the expected value is near zero
    tolerance: float = 0.03
    setting: str = ""  # "object_mass = 4"; `run_trials` fills it in

    @property
    def error(self) -> float:
        """Relative error [1]: |measured - expected| / the larger of |expected| and `full`."""
        size = max(abs(self.expected), self.full)
        if not np.isfinite(self.measured) or not size:
            return float("inf")
        return abs(self.measured - self.expected) / size

    @property
    def passed(self) -> bool:
        return self.error <= self.tolerance


@dataclass(frozen=True)
class LawTest:
    """The law of one attribute and the experiments that test it.

    Args:
        key: the attribute's key.
        law: the formula, on one line.
        settings: the nominal value, both ends of the global domain, perhaps more. At least one is
            so far from nominal that an attribute without effect must fail.
        run: the experiments at one setting: (lab, setting, values of other attributes) -> trials.
        others: values of other attributes under which the law must hold too.
        except_for: changes of ALL_VARIED for this law; None leaves an attribute nominal.
        source: the file, if it is of a user's library; `law_test` fills it in.
    """

    key: str
    law: str
    settings: tuple[Value, ...]
    run: Callable[[Lab, Value, Values], list[Trial]]
    others: tuple[Values, ...] = ()
    except_for: Values = field(default_factory=dict)
    source: Path | None = None

    @property
    def all_others(self) -> Values:
        """Values of all other attributes, all varied at once."""
        values = {**ALL_VARIED, **self.except_for}
        return {key: v for key, v in values.items() if key != self.key and v is not None}


def number(value: Value) -> float:
    """A setting as a float. Raises TypeError if it is no number."""
    if not isinstance(value, int | float):
        raise TypeError(f"{value!r} is not a number")
    return float(value)


class NoLawTest(RtphysError):
    """An attribute of a user's library that comes with no experiment."""


def law_test(key: str) -> LawTest:
    """The law test of one attribute: a bundled one, or `LAW` of a library's `laws/<key>.py`.

    Raises `UnknownName`: there is no such attribute; `NoLawTest`: it has none; `BadFile`: the file
    raises when it is imported, or has no `LAW` of this key.
    """
    if key not in attributes():
        raise UnknownName("attribute", key, attributes())
    files = (root / "laws" / f"{key}.py" for root in library.roots())
    own, name = next(filter(Path.is_file, files), None), f"rtphys.laws.{key}"
    try:
        module = load_file(own, "laws") if own else importlib.import_module(name)
    except ModuleNotFoundError as error:
        if error.name != name:  # one that the experiment imports
            raise
        file = f"laws/{key}.py of its library"
        raise NoLawTest(f"attribute {key} has no experiment: {file} does not exist") from None
    law = getattr(module, "LAW", None)
    if not isinstance(law, LawTest) or law.key != key:
        raise BadFile(module.__file__ or key, f"must define LAW, a LawTest with key = {key!r}")
    if not law.settings:
        raise BadFile(module.__file__ or key, "LAW: settings = () is not allowed; name a value")
    for name in law.except_for:
        if name not in AUXILIARY:
            check_key(name, own or "")
    return replace(law, source=own)


def law_tests_of(keys: Sequence[str] | None) -> tuple[list[LawTest], list[str]]:
    """Law tests of these attributes, or of all; why some of all have none. Raises as `law_test`."""
    laws, without = [], []
    for key in keys or attributes():
        try:
            laws.append(law_test(key))
        except NoLawTest as error:
            if keys:
                raise
            without.append(str(error))
    return laws, without


def run_trials(lab: Lab, law: LawTest, value: Value, others: Values) -> list[Trial]:
    """All trials of one law at one setting, each with the setting filled in.

    Raises `BadFile`: the experiment of a user's library raises an error, or returns no trials.
    """
    if others == law.all_others:
        own = " of each object, another value elsewhere" if lab.elsewhere else ""
        setting = f"{law.key} = {_text(value)}{own}, while all others vary"
    else:
        setting = ", ".join(f"{k} = {_text(v)}" for k, v in {law.key: value, **others}.items())
    try:
        trials = list(law.run(lab, value, others))
    except RtphysError:
        raise
    except Exception as error:
        if law.source is None:
            raise
        where = line_of(error, law.source)
        raise BadFile(law.source, f"raises {type(error).__name__}: {error}{where}") from error
    if law.source and not (trials and all(isinstance(one, Trial) for one in trials)):
        raise BadFile(law.source, "its run must return one or more Trial")
    return [replace(trial, setting=setting) for trial in trials]


def trials_of(lab: Lab, law: LawTest) -> Iterator[Trial]:
    """All trials of one attribute: each setting alone and with all others varied, then the last
    one beside extreme values of a few, and as the own value of each object."""
    for others in ({}, law.all_others):
        for value in law.settings:
            yield from run_trials(lab, law, value, others)
    for others in law.others:
        yield from run_trials(lab, law, law.settings[-1], others)
    if attribute(law.key).by_prop:
        yield from run_trials(by_prop(lab, law), law, law.settings[-1], law.all_others)


def by_prop(lab: Lab, law: LawTest) -> Lab:
    """The laboratory in which each object has its own value, and all else the first setting."""
    return replace(lab, elsewhere={law.key: law.settings[0]})


def _text(value: Value) -> str:
    """Such as "0.3" or "(0, 0, 0.015)"."""
    if isinstance(value, tuple):
        return "(" + ", ".join(f"{x:g}" for x in value) + ")"
    return f"{value:g}" if isinstance(value, int | float) else str(value)
