"""A proof of one attribute: its law, the settings to test, and the trials that come out."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from rtphys.core.poses import Array
from rtphys.physics.values import Value
from rtphys.proofs.lab import Lab

Values = Mapping[str, Value]  # attribute or auxiliary key -> value


# Every attribute varied at once; each law must hold in this company too.
COMPANY: Values = {
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


@dataclass(frozen=True, eq=False)
class Trace:
    """The recorded curve of one experiment and the curve of the law, for a figure."""

    x: Array
    measured: Array
    law: Array
    x_label: str
    y_label: str


@dataclass(frozen=True, eq=False)
class Trial:
    """One number of an experiment: the textbook's and the simulator's."""

    what: str  # "acceleration under 0.5 N"
    expected: float
    measured: float
    unit: str
    full: float = 0.0  # full scale of the error where the expected value is near zero
    tolerance: float = 0.03
    setting: str = ""  # "object_mass = 4"; `run.py` fills it in
    trace: Trace | None = None

    @property
    def error(self) -> float:
        """Relative error [1]: |measured - expected| / the larger of |expected| and `full`."""
        if not np.isfinite(self.measured):
            return float("inf")
        size = max(abs(self.expected), self.full)
        return abs(self.measured - self.expected) / size if size else float("inf")

    @property
    def passed(self) -> bool:
        return self.error <= self.tolerance


@dataclass(frozen=True)
class Proof:
    """The law of one attribute and the experiments that test it.

    Args:
        key: the attribute's key.
        law: the formula, on one line.
        settings: the nominal value, both ends of the global domain, perhaps more. At least one is
            so far from nominal that an attribute without effect must fail.
        run: the experiments at one setting: (lab, setting, values of other attributes) -> trials.
        others: values of other attributes under which the law must hold too.
        except_for: changes of COMPANY for this law; None leaves an attribute nominal.
    """

    key: str
    law: str
    settings: tuple[Value, ...]
    run: Callable[[Lab, Value, Values], list[Trial]]
    others: tuple[Values, ...] = field(default_factory=tuple)
    except_for: Values = field(default_factory=dict)

    @property
    def company(self) -> Values:
        """Values of all other attributes, all varied at once."""
        values = {**COMPANY, **self.except_for}
        return {key: v for key, v in values.items() if key != self.key and v is not None}


def number(value: Value) -> float:
    """A setting as a float. Raises TypeError if it is no number."""
    if not isinstance(value, int | float):
        raise TypeError(f"{value!r} is not a number")
    return float(value)
