"""Checks the physics in a label against what the seed gives, and against its domain."""

from collections.abc import Mapping

from rtphys.core.errors import RtphysError
from rtphys.data.episode import JSON
from rtphys.data.schema import PhysMeta, TaskDatasetEntry
from rtphys.physics import Domain, Physics, after, attributes
from rtphys.physics.auxiliary import AUXILIARY
from rtphys.physics.values import REDRAWS, Value, plain_value


class Redraw:
    """Draws the physics of a task dataset's seeds again, from the manifest alone."""

    def __init__(self, entry: TaskDatasetEntry, domains: Mapping[str, Mapping[str, JSON]]) -> None:
        self.refusal = ""  # why nothing can be drawn
        self.domain: Domain | None = None
        self.only = entry.only
        self.overrides: dict[str, Value] = {}
        name, digest = entry.domain.name, entry.domain.digest
        if digest not in domains:
            self.refusal = f"the manifest holds no domain with digest {digest}"
            return
        try:
            self.domain = Domain.from_json(domains[digest], "manifest.json")
            self.overrides = {key: plain_value(v) for key, v in entry.overrides.items()}
        except (RtphysError, ValueError) as error:
            self.refusal = f"domain {name} cannot be read: {error}"
            return
        if self.domain.digest != digest:
            self.refusal = f"domain {name} has digest {self.domain.digest}, not its own"

    def draw(self, seed: int, redraws: int = 0) -> Physics:
        """Physics of a seed, without any geometry.

        Args:
            redraws: how often the centre of mass was drawn again because it lay outside a body, as
                the label says.

        Raises:
            RtphysError: the manifest's domain cannot draw.
        """
        if self.domain is None or self.refusal:
            raise RtphysError(self.refusal)
        return self.domain.sample(seed, self.only, self.overrides, inside=after(redraws))

    def values(self, seed: int) -> Mapping[str, JSON]:
        """Plain values for figures; empty where the domain cannot draw."""
        try:
            return {key: value for key, value in self.draw(seed).items()}  # noqa: C416 - typed
        except RtphysError:
            return {}


class PhysicsCheck:
    """Compares the labels of one task dataset with what their seeds give."""

    def __init__(self, entry: TaskDatasetEntry, domains: Mapping[str, Mapping[str, JSON]]) -> None:
        self._redraw = Redraw(entry, domains)

    def problems(self, meta: PhysMeta) -> list[str]:
        """One sentence for each value that is not what the seed gives."""
        domain = self._redraw.domain
        if domain is None or self._redraw.refusal:
            return [self._redraw.refusal]
        stated = meta.draws.get(REDRAWS, 0)
        if not isinstance(stated, int) or isinstance(stated, bool) or stated < 0:
            return [f"draws.{REDRAWS} = {stated!r} is no count"]
        try:
            drawn = self._redraw.draw(meta.seed, stated)
        except (RtphysError, TypeError, ValueError) as error:
            return [f"the physics of seed {meta.seed} cannot be drawn again: {error}"]
        return _compare(meta, drawn) + domain.problems(drawn, self._redraw.overrides)


def _compare(meta: PhysMeta, drawn: Physics) -> list[str]:
    differences = []
    known = attributes()
    for key in sorted(known.keys() | meta.attributes.keys()):
        label = meta.attributes.get(key)
        if label is None:
            differences.append(f"attributes.{key} is missing")
        elif key not in known:
            differences.append(f"attributes.{key} is no attribute")
        else:
            tolerance = None if label.tolerance is None else known[key].deviation(drawn[key])
            expected = (drawn[key], known[key].unit, key in drawn.varied, tolerance)
            stored = (_value(label.value), label.unit, label.varied, label.tolerance)
            differences += _clauses(f"attributes.{key}", stored, expected)
    for key in AUXILIARY:
        if (stored := _value(meta.draws.get(key))) != drawn[key]:
            differences.append(f"draws.{key} is {stored!r}, the seed gives {drawn[key]!r}")
    return differences


def _value(raw: JSON) -> Value:
    try:
        return plain_value(raw)
    except ValueError:
        return repr(raw)


def _clauses(key: str, stored: tuple[object, ...], expected: tuple[object, ...]) -> list[str]:
    parts = zip(("", ".unit", ".varied", ".tolerance"), stored, expected, strict=True)
    return [
        f"{key}{part} is {is_!r}, the seed gives {should!r}"
        for part, is_, should in parts
        if is_ != should
    ]
