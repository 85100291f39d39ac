"""Which episode comes next: what `reset(options=...)` asks for."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from rtphys.core import library
from rtphys.core.errors import BadValue, UnknownName
from rtphys.physics import attributes
from rtphys.physics.values import Value, plain_value
from rtphys.results.instance_file import instance_file, read_instances
from rtphys.setting.protocol import load_protocol
from rtphys.setting.setting import Recipe, Setting

OPTIONS = ("protocol", "physics", "index", "split")
BENCHMARK = "benchmark_v1"  # certified lists that ship with rtphys


@dataclass(frozen=True)
class Choice:
    """Everything about an episode but its seed."""

    task: str
    protocol: str = "clean"
    physics: Mapping[str, Value] = field(default_factory=dict)  # held at these values
    index: int | None = None  # of the certified instances
    split: str = "unseen"

    def recipe(self, seed: int) -> Recipe:
        return Setting(self.task, self.protocol, overrides=dict(self.physics), split=self.split).at(
            seed
        )


def choose(default: Choice, options: Mapping[str, object] | None) -> Choice:
    """The default, changed by options.

    Raises:
        UnknownName: no such option, protocol or attribute.
        BadValue: a value of the wrong kind, or outside what the simulator can do.
    """
    given = dict(options or {})
    for key in given:
        if key not in OPTIONS:
            raise UnknownName("reset option", key, OPTIONS)
    if "physics" in given:
        given["physics"] = _physics(given["physics"])
    index = given.get("index")
    if index is not None and (isinstance(index, bool) or not isinstance(index, int) or index < 0):
        raise BadValue("index", index, "it counts certified instances from 0")
    chosen = replace(default, **given)  # pyright: ignore[reportArgumentType]
    load_protocol(chosen.protocol)
    return chosen


def _physics(raw: object) -> dict[str, Value]:
    if not isinstance(raw, Mapping):
        raise BadValue("physics", raw, "a mapping from attribute to value")
    known = attributes()
    values: dict[str, Value] = {}
    for key, value in raw.items():
        if key not in known:
            raise UnknownName("attribute", str(key), known)
        plain = _plain(value)
        known[key].check(plain)
        values[key] = plain
    return values


def _plain(value: object) -> Value:
    """Numbers and vectors of NumPy as ours."""
    listed = getattr(value, "tolist", None)
    return plain_value(listed() if callable(listed) else value)


def certified_seed(choice: Choice) -> int:
    """The seed of the certified instance that `index` names.

    Raises:
        BadFile: the task is not certified under this protocol.
        BadValue: the list is shorter.
    """
    folder = library.bundled() / "manifests" / BENCHMARK
    found = read_instances(instance_file(folder, choice.protocol, choice.task)).feasible
    index = choice.index or 0
    if index >= len(found):
        raise BadValue("index", index, f"{len(found)} instances are certified")
    return found[index].seed
