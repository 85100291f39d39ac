"""What a task dataset is: which episodes, what is recorded of each, and what that resolved to.

A `CollectionSpec` is a run of `rtphys collect` for one task: the command line, an entry of
`manifests/*.yaml`, and, with what it resolved to, the first line of a ledger and an entry of
`manifest.json`.
"""

from collections.abc import Mapping
from dataclasses import field, replace
from typing import Annotated, Any, Literal

from rtphys.core.bounds import EPISODES, SHARDS
from rtphys.core.errors import BadValue
from rtphys.core.untrusted import plain_name
from rtphys.physics.domain import Domain
from rtphys.physics.values import Value
from rtphys.spec.episode import EpisodeSpec
from rtphys.spec.option import NumberOrAll, Option, Positive, Seed, at_least, checked_dataclass
from rtphys.spec.protocol import VisualRandomization
from rtphys.spec.recording import RecordingSpec
from rtphys.spec.rules import Rules
from rtphys.spec.stored import CLOSED, Extent

DATASET_VERSION = "3.0"  # raised by any change of what a dataset holds or of a seed's states


@checked_dataclass(frozen=True, config=CLOSED)
class CollectionSpec:
    """One task dataset: its episodes, and what is recorded of each."""

    episode: EpisodeSpec = EpisodeSpec()
    recording: RecordingSpec = RecordingSpec()
    episodes: Annotated[
        int, at_least(1, most=EPISODES), Extent, Option("Number of episodes of each task.")
    ] = 10
    first_seed: Annotated[Seed, Option("The first seed; attempts go upward from it.")] = 0
    max_attempts: Annotated[
        Positive | None,
        Extent,
        Option("Largest number of attempts of each task, including earlier runs."),
    ] = None
    twin: Annotated[
        str | None, Option("A second protocol: record each seed under both, and keep only pairs.")
    ] = None
    keep_failures: Annotated[
        NumberOrAll,
        Option("Also draw and keep this many failed attempts of each task, or `all`."),
    ] = None
    sweep: str | None = None  # "friction=0.05,0.2": this holds one of these, on the same seeds
    config: str | None = None  # name of the folder; None: after what varies
    twin_of: str | None = None  # configuration of the task dataset whose twin this is
    policy: str | None = None  # who acts, where it is not the expert
    shards: Annotated[int, at_least(1, most=SHARDS)] = 1  # that share this task dataset's seeds
    shard: Annotated[int, at_least(0, most=SHARDS)] = 0  # which of them this is; 0: it is whole
    # What `merge` and `subset` write has gaps between its seeds and cannot be continued.
    made_by: Literal["collect", "merge", "subset"] = "collect"

    def __post_init__(self) -> None:
        if self.sweep and (key := self.sweep.partition("=")[0]) not in self.episode.overrides:
            raise BadValue("sweep", self.sweep, f"`set` holds {key} at one of its values")
        if self.shard > self.shards:
            raise BadValue("shard", self.shard, f"it is one of {self.shards}")
        for key, name in (("config", self.config), ("twin_of", self.twin_of)):
            try:
                plain_name(name or "none")
            except ValueError as error:
                raise BadValue(key, name, str(error)) from error

    @property
    def name(self) -> str:
        """Name of the configuration: of the folder that holds it."""
        return self.config or self.episode.variation

    @property
    def twin_name(self) -> str | None:
        """Configuration of the twin's task dataset; None where there is none."""
        return None if self.twin is None else f"{self.name}.twin={self.twin}"

    @property
    def sides(self) -> "tuple[CollectionSpec, ...]":
        """This one, and its twin's if there is one."""
        if self.twin is None:
            return (self,)
        episode = self.episode.under(self.twin)
        twin = replace(self, episode=episode, config=self.twin_name, twin=None, twin_of=self.name)
        return self, twin

    @property
    def unswept(self) -> "CollectionSpec":
        """Without its sweep, and the value that it holds for it; that of all values is equal."""
        if self.sweep is None:
            return self
        key, overrides = self.sweep.partition("=")[0], dict(self.episode.overrides)
        del overrides[key]
        own, main = (name and name.partition(f".{key}=")[0] for name in (self.config, self.twin_of))
        episode = replace(self.episode, overrides=overrides)
        return replace(self, episode=episode, config=own, twin_of=main, sweep=None)

    @property
    def swept(self) -> tuple[str, Value]:
        """Attribute of its sweep, and the value at which this holds it. It is one of a sweep."""
        assert self.sweep is not None
        key = self.sweep.partition("=")[0]
        return key, self.episode.overrides[key]

    @property
    def paired(self) -> bool:
        """Whether a seed gives episodes only if it succeeds under its twin, or with every value.

        A sweep that keeps failures has every seed with every value instead.
        """
        return self.made_by != "subset" and (self.sweep is None or self.keep_failures is None)

    def of_task(self, task: str) -> "CollectionSpec":
        """The same for one task."""
        episode, recording = replace(self.episode, task=task), self.recording.of_task(task)
        return replace(self, episode=episode, recording=recording)

    def seed(self, attempt: int) -> int:
        """Seed of the attempt with that number, counted from 0."""
        step = self.shards if self.shard else 1
        return self.first_seed + max(self.shard - 1, 0) + attempt * step

    @property
    def max_failures(self) -> int:
        """How many failed attempts are kept at most."""
        kept = self.keep_failures or "0"
        return EPISODES if kept == "all" else int(kept)

    @property
    def failures_expected(self) -> int:
        """How many failed attempts are kept at most; of all, no more than episodes are expected."""
        return self.episodes if self.keep_failures == "all" else self.max_failures


@checked_dataclass(frozen=True, config=CLOSED)
class Resolved:
    """What a spec's names stood for when the run began; their files may change later."""

    domain: Mapping[str, Any]  # `Domain.to_json()`: every range, inheritance resolved
    visual: Mapping[str, Any] | None  # rules of the looks; None: as in protocol clean
    versions: Mapping[str, str] = field(default_factory=dict[str, str])  # rtphys, sapien, ...
    assets: Mapping[str, str] = field(default_factory=dict[str, str])  # pack, digest
    dataset_version: str = DATASET_VERSION


@checked_dataclass(frozen=True, config=CLOSED)
class TaskHeader:
    """The first line of a task dataset's ledger: its spec, and what that resolved to."""

    spec: CollectionSpec
    resolved: Resolved

    @property
    def rules(self) -> Rules:
        """What physics and looks were drawn by, from what is stored alone.

        Raises:
            RtphysError, ValueError: a rule that cannot be read.
        """
        episode, visual = self.spec.episode, self.resolved.visual
        return Rules(
            Domain.from_json(self.resolved.domain, "domain"),
            None if visual is None else VisualRandomization.from_json(visual, "visual"),
            episode.only,
            episode.overrides,
            "" if episode.pair_tasks else episode.task,
        )
