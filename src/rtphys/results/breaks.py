"""Which physics breaks a policy: regression of success on every attribute that varied."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from rtphys.data.episode import JSON
from rtphys.physics import attributes
from rtphys.results.logistic import Curve, bins, fit
from rtphys.results.record import EpisodeRecord
from rtphys.results.statistics import Rate, holm

LEAST = 10  # episodes below which no curve is fitted


@dataclass(frozen=True)
class Break:
    """Effect of one physical attribute on success under one protocol."""

    key: str
    unit: str
    curve: Curve
    p_holm: float  # p-value of `curve`, adjusted for the number of attributes
    bins: tuple[tuple[float, float, Rate], ...]  # from, to, success rate
    same: tuple[str, ...] = ()  # attributes that always had the same values (one shared draw)

    def to_json(self) -> dict[str, JSON]:
        curve = self.curve
        return {
            "attribute": self.key,
            "same": list(self.same),
            "unit": self.unit,
            "low": curve.low,
            "high": curve.high,
            "log_odds": curve.slope,
            "log_odds_error": curve.error,
            "p": curve.p,
            "p_holm": self.p_holm,
            "bins": [{"from": a, "to": b, **rate.to_json()} for a, b, rate in self.bins],
        }


def breaks(records: Sequence[EpisodeRecord]) -> list[Break]:
    """Effects of the attributes that varied, by increasing p-value; empty if none can be fitted.

    A vector attribute counts by its norm. Episodes in which an attribute does not act say
    nothing of it. Every task has its own level in the regression. Attributes that share a draw
    cannot be separated: they make one entry.
    """
    names = sorted({record.task for record in records})
    columns, same = _columns(records)
    effects: list[Break] = []
    for key, column in columns.items():
        known = [(x, r) for x, r in zip(column, records, strict=True) if x is not None]
        if len(known) < LEAST:
            continue
        x, success = [x for x, _ in known], [r.success for _, r in known]
        curve = fit(x, success, [names.index(r.task) for _, r in known])
        if curve is not None:
            unit, others = attributes()[key].unit, tuple(same.get(key, ()))
            effects.append(Break(key, unit, curve, curve.p, tuple(bins(x, success)), others))
    adjusted = holm([effect.curve.p for effect in effects])
    effects = [replace(effect, p_holm=p) for effect, p in zip(effects, adjusted, strict=True)]
    return sorted(effects, key=lambda effect: effect.curve.p)


def _columns(
    records: Sequence[EpisodeRecord],
) -> tuple[dict[str, list[float | None]], dict[str, list[str]]]:
    """Values (n,) of each distinct attribute, and the attributes that repeat its values."""
    columns: dict[str, list[float | None]] = {}
    same: dict[str, list[str]] = {}
    for key in attributes():
        acting = [None if key in r.inert else r.physics.get(key) for r in records]
        x = [_number(value) for value in acting]
        first = next((other for other, values in columns.items() if values == x), None)
        if first is None:
            columns[key] = x
        elif any(value is not None for value in x):
            same.setdefault(first, []).append(key)
    return columns, same


def _number(value: JSON) -> float | None:
    """A number as it is, a vector by its norm; None for anything else."""
    if isinstance(value, list | tuple):
        return float(np.linalg.norm(np.array(value, float)))
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    return float(value)
