"""Whether the physics in a label is what the seed gives, and lies inside its domain."""

from collections.abc import Mapping

from rtphys.data.episode import JSON
from rtphys.data.schema import LeafEntry, PhysMeta
from rtphys.errors import RtphysError
from rtphys.physics import Domain, Physics, after, attributes
from rtphys.physics.auxiliary import AUXILIARY
from rtphys.physics.values import REDRAWS, Value, plain_value


class PhysicsCheck:
    """Draws each episode's physics of one leaf again.

    The centre of mass was redrawn until it lay inside every body; the label says how often, so
    the same draw is found without any geometry.
    """

    def __init__(self, entry: LeafEntry, domains: Mapping[str, Mapping[str, JSON]]) -> None:
        self.entry = entry
        self.refusal = ""  # why nothing can be derived
        self._domain: Domain | None = None
        resolved = domains.get(entry.domain.digest)
        if resolved is None:
            self.refusal = f"the manifest holds no domain with digest {entry.domain.digest}"
            return
        try:
            self._domain = Domain.from_json(resolved, "manifest.json")
            self._overrides = {key: plain_value(v) for key, v in entry.overrides.items()}
        except (RtphysError, ValueError) as error:
            self.refusal = f"domain {entry.domain.name} cannot be read: {error}"
            return
        if self._domain.digest != entry.domain.digest:
            self.refusal = (
                f"domain {entry.domain.name} has digest {self._domain.digest}, not its own"
            )

    def problems(self, meta: PhysMeta) -> list[str]:
        """One sentence for each value that is not what the seed gives."""
        if self._domain is None or self.refusal:
            return [self.refusal]
        stated = meta.draws.get(REDRAWS, 0)
        if not isinstance(stated, int) or isinstance(stated, bool) or stated < 0:
            return [f"draws.{REDRAWS} = {stated!r} is no count"]
        try:
            drawn = self._domain.sample(
                meta.seed, self.entry.only, self._overrides, inside=after(stated)
            )
        except (RtphysError, TypeError, ValueError) as error:
            return [f"the physics of seed {meta.seed} cannot be drawn again: {error}"]
        return _compare(meta, drawn) + self._domain.problems(drawn, self._overrides)


def _compare(meta: PhysMeta, drawn: Physics) -> list[str]:
    found = []
    known = attributes()
    for key in sorted(known.keys() | meta.attributes.keys()):
        label = meta.attributes.get(key)
        if label is None:
            found.append(f"attributes.{key} is missing")
        elif key not in known:
            found.append(f"attributes.{key} is no attribute")
        else:
            expected = (drawn[key], known[key].unit, key in drawn.varied)
            stored = (_value(label.value), label.unit, label.varied)
            found += _clauses(f"attributes.{key}", stored, expected)
    for key in AUXILIARY:
        if (stored := _value(meta.draws.get(key))) != drawn[key]:
            found.append(f"draws.{key} is {stored!r}, the seed gives {drawn[key]!r}")
    return found


def _value(raw: JSON) -> Value:
    try:
        return plain_value(raw)
    except ValueError:
        return repr(raw)


def _clauses(key: str, stored: tuple[object, ...], expected: tuple[object, ...]) -> list[str]:
    parts = zip(("", ".unit", ".varied"), stored, expected, strict=True)
    return [
        f"{key}{part} is {is_!r}, the seed gives {should!r}"
        for part, is_, should in parts
        if is_ != should
    ]
