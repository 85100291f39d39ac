"""What `collect` is asked for: specs from a template, a file or a sweep, and where to make them.

Nothing here loads the simulator, so that a command line can.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast

from rtphys.campaign.machine import cores
from rtphys.campaign.pool import Limits
from rtphys.core import library
from rtphys.core.bounds import SHARDS
from rtphys.core.errors import BadFile, BadValue, UnknownName
from rtphys.physics.domain import AUXILIARY, check_key
from rtphys.physics.load import parse_overrides
from rtphys.spec.collection import CollectionSpec
from rtphys.spec.option import Option, Workers, at_least, checked_dataclass, from_words, one_of
from rtphys.spec.recording import Shader
from rtphys.studies.resources import episode_bytes

if TYPE_CHECKING:
    from rtphys.assets.pack import Pack


@checked_dataclass(frozen=True)
class Run:
    """Where and on what a collection is made. None of it moves a byte of an episode."""

    out: Annotated[Path, Option("The dataset's folder.")] = Path("data")
    workers: Workers = None
    runner: Annotated[
        str, one_of("runner", ("local", "ray")), Option("local, or ray: on a Ray cluster.")
    ] = "local"
    address: Annotated[
        str | None, Option("Address of the Ray cluster; `local` makes a private one.")
    ] = None
    gpus: Annotated[
        int | None,
        at_least(0, most=64),
        Option("GPUs with drawing workers; 0: each worker draws; default all that draw."),
    ] = None
    shard: Annotated[str, Option("i/n: one part of n, for `rtphys merge` to join.")] = ""
    resume: Annotated[bool, Option("Continue what is in the folder.")] = True
    shader: Shader = "slim"
    assets: Annotated[Path | None, Option("An asset pack, such as RoboTwin's own.")] = None
    fallback: Annotated[
        str,
        one_of("fallback", ("", "builtin")),
        Option("`builtin`: it stands in for what the pack of `assets` lacks."),
    ] = ""
    limits: Limits = field(default_factory=Limits)

    def __post_init__(self) -> None:
        if self.fallback and self.assets is None:
            raise BadValue("fallback", self.fallback, "it needs `assets`, which lacks models")
        if self.address is not None and self.runner != "ray":
            raise BadValue("address", self.address, "it belongs to `runner` ray")
        if self.gpus and self.runner == "ray":
            raise BadValue(
                "gpus", self.gpus, "it belongs to `runner` local; nodes draw as they can"
            )

    def size(self) -> int:
        """Number of workers: as many as were asked for, else one for each CPU.

        Joins the Ray cluster; raises `NoCluster` where there is none.
        """
        if self.runner == "local":
            return cores() if self.workers is None else self.workers
        from rtphys.campaign.ray import connect  # imported here: Ray is optional

        return connect(self.address, self.workers)

    def pack(self, progress: Callable[[int, int, str], None] | None = None) -> "Pack":
        """The asset pack, built if need be."""
        from rtphys.assets.pack import chosen_pack  # imported here: it takes scipy along

        return chosen_pack(self.assets, self.fallback, progress)


def room_needed(specs: Sequence[CollectionSpec]) -> float:
    """Disk space that the specs' episodes need at most [bytes]."""
    return sum(
        (spec.episodes + spec.failures_expected)
        * episode_bytes(side.recording, side.episode.visual())
        for spec in specs
        for side in spec.sides
    )


def specs_for(
    template: CollectionSpec, tasks: Sequence[str], sweep: str = ""
) -> tuple[CollectionSpec, ...]:
    """One spec a task, or one for each task and each value of a sweep, which see `swept`."""
    variants = swept(template, sweep) if sweep else (template,)
    return tuple(variant.of_task(task) for variant in variants for task in tasks)


def swept(spec: CollectionSpec, text: str) -> tuple[CollectionSpec, ...]:
    """The same again with one attribute held at each value, in folders of their own.

    Args:
        text: "friction=0.05,0.1", or ';' between vectors: "center_of_mass=0,0,0.01;0,0,0.02".

    Raises:
        UnknownName, BadValue: as `parse_overrides`; a value that is named twice; one that is held.
    """
    key, equals, spelt = text.partition("=")
    key, episode = key.strip(), spec.episode
    parts = [part.strip() for part in spelt.split(";" if ";" in spelt else ",")]
    if not equals or not all(parts):
        raise BadValue("sweep", text, "write key=value,value, such as friction=0.1,0.2")
    if len(set(parts)) < len(parts):
        raise BadValue("sweep", text, "name each value once")
    if key in episode.overrides:
        raise BadValue("sweep", key, "it is held at a value already")
    only = None if episode.only is None else tuple(dict.fromkeys((*episode.only, key)))
    found: list[CollectionSpec] = []
    for part in parts:
        overrides = {**episode.overrides, **parse_overrides([f"{key}={part}"])}
        config = spec.config and f"{spec.config}.{key}={part}"
        held = replace(episode, only=only, overrides=overrides)
        found.append(replace(spec, episode=held, config=config))
    return tuple(found)


def find_collection(text: str) -> Path:
    """A file, or the name of one in a library. Raises `UnknownName`: neither."""
    path = Path(text)
    return path if path.is_file() else library.find("manifests", text)


def read_specs(path: Path) -> tuple[CollectionSpec, ...]:
    """The specs of a file such as `manifests/smoke.yaml`.

    Its key `collect` lists runs: `tasks`, perhaps a `sweep`, and fields of a `CollectionSpec`, with
    those of its episode and recording beside them, in the words of the command line. Raises
    `BadFile`, `UnknownName`, `BadValue`: names the file, the key and the nearest match.
    """
    content = library.read_yaml(path)
    for key in content:
        if key not in ("what", "collect"):
            raise UnknownName("key", key, ("what", "collect"), path)
    runs = content.get("collect")
    if not isinstance(runs, list) or not runs:
        raise BadFile(path, "collect: a list of runs is needed, such as `- tasks: [click_bell]`")
    found: list[CollectionSpec] = []
    for number, run in enumerate(cast(list[object], runs)):
        at, place = f"collect.{number}", f"{path}: collect.{number}"
        if not isinstance(run, Mapping):
            raise BadFile(path, f"{at}: a mapping is needed, such as `tasks: [...]`")
        given = dict(cast(Mapping[str, object], run))
        named, sweep = given.pop("tasks", None), str(given.pop("sweep", ""))
        if not isinstance(named, list) or not named:
            raise BadFile(path, f"{at}.tasks: a list of names or patterns is needed")
        if "episodes" not in given:
            raise BadFile(path, f"{at}.episodes: how many of each task?")
        held = given.get("set", {})
        for key in cast(Mapping[str, object], held) if isinstance(held, Mapping) else ():
            if key not in AUXILIARY:
                check_key(str(key), place)
        template = from_words(CollectionSpec, given, f"key of {at}", place)
        tasks = library.matching("tasks", [str(name) for name in cast(list[object], named)], place)
        found += specs_for(template, tasks, sweep)
    names = [(spec.name, spec.episode.task, spec.recording.layout) for spec in found]
    if twice := next((name for name in names if names.count(name) > 1), None):
        raise BadFile(path, f"{'/'.join(twice[:2])} is collected by two runs")
    return tuple(found)


def shard_of(specs: Sequence[CollectionSpec], text: str) -> Sequence[CollectionSpec]:
    """What shard "i/n" makes of a collection; all of it where the text is empty.

    Where there are as many task datasets as shards or more, each shard makes whole ones. Otherwise
    the shards form as many equal groups as possible, and the m shards of a group share each of
    their task datasets: every m-th seed, and 1/m of the episodes, each. Raises `BadValue`: it is
    not spelled so.
    """
    if not text:
        return specs
    first, _, last = text.partition("/")
    spelt = all(part.isdecimal() and len(part) <= len(str(SHARDS)) for part in (first, last))
    if not (spelt and 1 <= int(first) <= int(last) <= SHARDS):
        raise BadValue("shard", text, f"write i/n, from 1/n to n/n, n at most {SHARDS}")
    index, of = int(first) - 1, int(last)
    ordered = sorted(specs, key=lambda spec: (spec.name, spec.episode.task))
    sharing = 1 if len(ordered) >= of else of // math.gcd(len(ordered), of)
    own = ordered[index // sharing :: of // sharing]
    if sharing == 1:
        return own
    shard = index % sharing + 1
    return [
        replace(one, shards=sharing, shard=shard, episodes=math.ceil(one.episodes / sharing))
        for one in own
    ]
