"""Checks the physics and the look in a label against what its seed gives by the manifest's rules.

No simulator is needed. What the task or the asset pack must be there for is compared where they
are those of the collection.
"""

from collections.abc import Callable, Mapping

from rtphys.assets.pack import Pack, pack_with
from rtphys.core.errors import Infeasible, RtphysError
from rtphys.core.untrusted import JSON
from rtphys.data.manifest import TaskEntry
from rtphys.data.schema import PhysMeta
from rtphys.physics import after, could_act
from rtphys.physics.attribute import attribute, is_attribute
from rtphys.physics.domain import AUXILIARY
from rtphys.physics.reach import keys_of
from rtphys.physics.values import REDRAWS, Value, plain_value
from rtphys.spec.rules import Rules
from rtphys.task.props import parts
from rtphys.task.spec import Task, load_task
from rtphys.visual.look import draw_look
from rtphys.visual.look import problems as backdrop_problems


class DrawCheck:
    """Compares the labels of one task dataset with what their seeds give."""

    task: Task | None = None  # of the collection; None: it is not here
    pack: Pack | None  # likewise
    gap = ""  # why pictures and clutter of looks cannot be drawn again

    def __init__(
        self, entry: TaskEntry, find_pack: Callable[[str], Pack | None] = pack_with
    ) -> None:
        """`find_pack` may remember: task datasets that share a pack then read its models once."""
        self._split, resolved = entry.spec.episode.split, entry.resolved
        self._rules: Rules | str  # or why they are unknown
        name = resolved.domain.get("name")
        try:
            self._rules = entry.header.rules
            if (digest := self._rules.domain.digest) != resolved.domain.get("digest"):
                self._rules = f"domain {name} has digest {digest}, not its own"
        except (RtphysError, ValueError, KeyError, TypeError) as error:
            self._rules = f"domain {name} or the rules of the look cannot be read: {error}"
        looks, assets = resolved.visual is not None, resolved.assets.get("digest", "")
        self.pack = find_pack(assets)
        try:
            task = load_task(entry.spec.episode.task)
            if task.digest != resolved.versions.get("task"):
                raise RtphysError(f"{task.source} is another version of the task")
            self.task = task
            if looks and self.pack is None:
                raise RtphysError(f"the asset pack {assets[:12]} is not on this machine")
        except RtphysError as error:
            self.gap = f"pictures and clutter were not drawn again: {error}" if looks else ""

    def problems(self, meta: PhysMeta) -> list[str]:
        """One sentence for each value that is not what the seed gives."""
        if isinstance(self._rules, str):
            return [self._rules]
        return self._physics(meta, self._rules) + self._look(meta, self._rules)

    def _physics(self, meta: PhysMeta, rules: Rules) -> list[str]:
        stated = dict[str, int]()
        for key in keys_of(REDRAWS, meta.draws):
            count = meta.draws[key]
            if not isinstance(count, int) or isinstance(count, bool) or count < 0:
                return [f"draws.{key} = {count!r} is no count"]
            stated[key] = count
        try:
            # How often the centre of mass lay outside a body is the label's word: no geometry here.
            drawn = rules.draw(meta.seed, inside=after(stated))
        except (RtphysError, TypeError, ValueError) as error:
            return [f"the physics of seed {meta.seed} cannot be drawn again: {error}"]
        try:  # what the episode's world has; None where that is unknown
            has = None if self.task is None else parts(self.task.props(meta.seed))
        except Infeasible:
            has = None
        found: list[str] = []
        known = {key: attribute(key) for key in filter(is_attribute, drawn)}
        able = could_act(drawn, has or {})
        for key in sorted(known.keys() | meta.attributes.keys()):
            label = meta.attributes.get(key)
            if label is None:
                found.append(f"attributes.{key} is missing")
            elif key not in known:
                problem = "is no attribute that is known here, or drawn; is its library loaded?"
                found.append(f"attributes.{key} {problem}")
            else:
                scope = known[key].scope.partition(";")[0]
                tolerance = None if label.tolerance is None else known[key].deviation(drawn[key])
                pairs = {
                    "": (_value(label.value), drawn[key]),
                    ".unit": (label.unit, known[key].unit),
                    ".varied": (label.varied, key in drawn.varied),
                    ".source": (label.source, rules.source(key, drawn)),
                    ".tolerance": (label.tolerance, tolerance),
                    # What lies or leans at the end is named behind it: no world is built here.
                    ".scope": (label.scope.partition(";")[0], label.scope and scope),
                    ".could_act": (
                        label.could_act,
                        label.could_act if has is None else key in able,
                    ),
                    ".acted": (label.acted, label.acted if label.could_act else False),
                }
                found += _clauses(f"attributes.{key}", pairs)
        draws = {key: (_value(meta.draws.get(key)), drawn[key]) for key in AUXILIARY}
        return found + _clauses("draws.", draws)

    def _look(self, meta: PhysMeta, rules: Rules) -> list[str]:
        if meta.visual is None or rules.visual is None:
            missing = meta.visual is None and rules.visual is None
            return [] if missing else ["visual is not what the manifest says"]
        stored, chance = meta.visual.model_dump(), rules.chance(meta.seed)
        found = backdrop_problems(stored, rules.visual, chance)
        if stored["split"] != self._split:
            found.append(f"visual.split is {stored['split']!r}, the manifest says {self._split!r}")
        if found or self.task is None or self.pack is None:
            return found
        try:
            props = self.task.props(meta.seed)
        except Infeasible as problem:
            return [f"seed {meta.seed} has no layout: {problem.detail}"]
        drawn = draw_look(rules.visual, chance, (self.task, props), self.pack, self._split)
        pairs = {key: (stored[key], value) for key, value in drawn.to_json().items()}
        return _clauses("visual.", pairs)


def _value(raw: JSON) -> Value:
    try:
        return plain_value(raw)
    except ValueError:
        return repr(raw)


def _clauses(place: str, pairs: Mapping[str, tuple[object, object]]) -> list[str]:
    return [
        f"{place}{part} is {is_!r}, the seed gives {should!r}"
        for part, (is_, should) in pairs.items()
        if is_ != should
    ]
