"""What the commands of studies are asked for. Nothing here loads the simulator, for their help."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from rtphys.core.errors import BadValue
from rtphys.data.selection import Selection
from rtphys.physics.attribute import attribute
from rtphys.physics.reach import reach
from rtphys.results.evaluation import EvaluationSpec, short_name
from rtphys.results.instances import FIRST_SEED
from rtphys.senses import REDRAWN, SENSES, drawn
from rtphys.spec.episode import EpisodeSpec, check_varies
from rtphys.spec.option import (
    Offers,
    Option,
    Positive,
    Seed,
    Tasks,
    Workers,
    at_least,
    checked_dataclass,
    one_of,
)
from rtphys.spec.protocol import Protocols, load_look, load_protocol
from rtphys.spec.recording import CAMERAS, CameraType, RecordingSpec, Shader, Size
from rtphys.spec.stored import CLOSED, Extent
from rtphys.studies.resources import check_drawable
from rtphys.task.props import parts
from rtphys.task.spec import Task, load_task

if TYPE_CHECKING:
    from rtphys.data.manifest import TaskEntry

BASELINES = ("replay", "twin")
"""Measured on feasible seeds. replay: the recorded actions alone; twin: those of the clean demo."""


@checked_dataclass(frozen=True, config=CLOSED)
class CertificationSpec:
    """One certified list."""

    episode: Annotated[EpisodeSpec, Offers("embodiment")] = EpisodeSpec()
    first_seed: Annotated[Seed, Option("The first seed to try.")] = FIRST_SEED
    feasible: Annotated[Positive, Extent, Option("Number of feasible seeds of each list.")] = 100
    max_attempts: Annotated[Positive, Extent, Option("Number of seeds to try for one list.")] = 1000
    baselines: Annotated[
        tuple[str, ...],
        Extent,
        one_of("baseline", (*BASELINES, "none")),
        Option(
            "replay, twin (open-loop replay of the clean demonstration), or none. Each costs about "
            "as much as the attempt itself. "
            "A list that lacks one gains it, and keeps what it has."
        ),
    ] = BASELINES


@checked_dataclass(frozen=True)
class CertificationRun:
    """Which lists are made or proved again, and where: one for each task and protocol."""

    tasks: Tasks
    protocols: Protocols
    out: Annotated[Path, Option("The benchmark's folder.")]
    reprove: Annotated[
        int,
        at_least(0),
        Option(
            "Solve the first so many instances of each list again instead; a list whose states "
            "agree gets the present fingerprint."
        ),
    ] = 0
    workers: Workers = None

    def specs(self, template: CertificationSpec) -> Iterator[CertificationSpec]:
        """One for each task under each protocol whose one attribute acts in it."""
        for protocol, task in product(self.protocols, self.tasks):
            if _acts(task, protocol):
                episode = replace(template.episode, task=task, protocol=protocol)
                yield replace(template, episode=episode)

    def left_out(self) -> list[str]:
        """Names of the lists that are left out: the protocol's one attribute acts on nothing."""
        lists = product(self.protocols, self.tasks)
        return [f"{task}, {name}" for name, task in lists if not _acts(task, name)]


def _acts(task: str, protocol: str) -> bool:
    """Whether anything that the protocol varies alone can change an episode of the task."""
    alone = load_protocol(protocol).only
    if not alone:
        return True
    has = reach("").parts(parts(load_task(task).props(FIRST_SEED)))
    return any(attribute(key).could_act(has, attribute(key).valid.high) for key in alone)


@checked_dataclass(frozen=True)
class CheckPlan:
    """One run of `check`: tasks under protocols."""

    tasks: Tasks
    protocols: Protocols = ("clean",)
    seeds: Annotated[Positive, Option("Number of seeds of each task and protocol.")] = 20
    first_seed: Annotated[Seed, Option("The first seed.")] = 0
    baselines: Annotated[
        Seed | None,
        Option(
            "Number of seeds for the baselines idle, random and jitter, which cost the most: up to "
            "the step limit each. Default: those of the expert, at most 20; none where it solves "
            "no seed."
        ),
    ] = None
    episode: Annotated[EpisodeSpec, Offers("ranges", "embodiment")] = EpisodeSpec()
    workers: Workers = None

    def __post_init__(self) -> None:
        for name in self.tasks:
            load_task(name)
        if self.episode.ranges is not None:
            check_varies(self.episode.ranges, self.protocols)


@checked_dataclass(frozen=True)
class TryPlan:
    """One attempt of `try`."""

    task: Annotated[str, Option("Name of the task.", positional=True)]
    seed: Annotated[Seed, Option("Seed of the episode.")] = 0
    episode: Annotated[
        EpisodeSpec, Offers("protocol", "only", "overrides", "ranges", "embodiment")
    ] = EpisodeSpec(protocol="clean")
    picture: Annotated[Path | None, Option("Draw the end of each stage into this PNG.")] = None
    video: Annotated[Path | None, Option("Draw the attempt into this MP4.")] = None

    @property
    def drawn(self) -> bool:
        return self.picture is not None or self.video is not None


@checked_dataclass(frozen=True)
class BenchPlan:
    """One run of `bench`: tasks under protocols."""

    tasks: Tasks = ("*",)
    protocols: Protocols = ("clean", "phys_random_all")
    episodes: Annotated[Positive, Option("Number of attempts of each task and protocol.")] = 2
    first_seed: Annotated[Seed, Option("The first seed.")] = 0
    pictures: Annotated[bool, Option("Draw and write what is accepted.")] = True
    episode: Annotated[EpisodeSpec, Offers("embodiment")] = EpisodeSpec()


@checked_dataclass(frozen=True)
class RenderSpec:
    """What is drawn again of a dataset, and how. What is left out stays as it is stored."""

    data: Annotated[Path, Option("Folder that holds manifest.json.", positional=True)]
    out: Annotated[Path, Option("Folder for the new dataset.")]
    add: Annotated[
        tuple[str, ...], one_of("sense", SENSES), Option(f"Also any of {', '.join(REDRAWN)}.")
    ] = ()
    cameras: Annotated[
        tuple[str, ...],
        one_of("camera", (*CAMERAS, *CAMERAS.values())),
        Option("Other cameras: any of head, left, right, front."),
    ] = ()
    camera_type: CameraType = None
    size: Size = None
    look: Annotated[
        str | None,
        Option("Textures and lights of this protocol; official_random.3 draws them anew."),
    ] = None
    part: Selection = Selection()
    shader: Shader = "slim"
    workers: Workers = None

    def __post_init__(self) -> None:
        if self.look is not None:
            load_look(self.look)  # refuses what there is not
        for name in self.add:
            if name not in REDRAWN:
                allowed = f"it is measured while simulating; allowed: {', '.join(REDRAWN)}"
                raise BadValue("add", name, allowed)

    def recording_spec(self, entry: "TaskEntry") -> RecordingSpec:
        """Of one task dataset. Raises `BadValue`: it cannot be."""
        was = entry.spec.recording
        return replace(
            was,
            cameras=self.cameras or was.cameras,
            senses=tuple(name for name in SENSES if name in (*was.senses, *self.add)),
            camera_type=self.camera_type or was.camera_type,
            size=self.size or (None if self.camera_type else was.size),
            look=self.look or was.look,
        )


@checked_dataclass(frozen=True)
class EvaluationRun:
    """On how many instances of what a policy is run, how, and where its results go."""

    tasks: Tasks
    protocols: Protocols
    episodes: Annotated[
        Positive | None,
        Option("Number of episodes of each task and protocol; default: all that are certified."),
    ] = None
    out: Annotated[Path | None, Option("Folder of the results; default: eval/<policy>.")] = None
    instances: Annotated[
        Path | None,
        Option(
            "Certified lists, a file or a folder, or a dataset whose seeds to take; default: those "
            "of rtphys."
        ),
    ] = None
    video: Annotated[
        str | None,
        Option("Also write MP4s: of `failures`, of the first so many episodes of each, or `all`."),
    ] = None
    record: Annotated[
        Path | None, Option("Also write the episodes, and the failed ones, as a dataset.")
    ] = None
    resume: Annotated[bool, Option("Continue what is in the folder.")] = True
    accept_changes: Annotated[
        bool, Option("Run on lists that have another certification fingerprint.")
    ] = False
    timeout: Annotated[float, at_least(1), Option("Seconds of an episode before it is lost.")] = (
        1800.0
    )
    workers: Workers = None

    def __post_init__(self) -> None:
        text = self.video or "all"
        if text not in ("failures", "all") and not (text.isdecimal() and int(text)):
            raise BadValue("video", text, "failures, all, or a positive number")

    def check(self, spec: EvaluationSpec) -> list[Task]:
        """The tasks. Raises UnknownName, BadValue, BadFile, NoRenderer before any work is done."""
        from rtphys.policies import check_options  # imported here: its baselines need the simulator

        check_options(spec.policy, spec.options)
        tasks = [load_task(name) for name in self.tasks]
        if drawn(spec.recording.senses):
            check_drawable("senses")
        elif self.video or self.record:
            check_drawable()
        return tasks

    def folder(self, policy: str) -> Path:
        """Where the results lie."""
        return self.out or Path("eval") / short_name(policy)
