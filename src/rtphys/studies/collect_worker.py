"""What a worker of a collection does: attempt one seed, and draw it if accepted; on any machine."""

import os
import platform
import shutil
import tempfile
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import NamedTuple

from rtphys.assets.pack import default_pack
from rtphys.campaign.pool import Setup
from rtphys.core.bounds import LARGEST_EPISODE
from rtphys.core.errors import RtphysError
from rtphys.data import files
from rtphys.data.episode import Episode, Images
from rtphys.data.staging import HDF5, INSTRUCTION, VIDEO, StagedEpisode, stage_episode
from rtphys.data.writer import Rejection
from rtphys.episode.assemble import assemble, kept, rejection, unpaired, with_pictures
from rtphys.episode.fingerprint import versions
from rtphys.episode.generate import Attempt
from rtphys.episode.render import RenderedFrames, StateTrajectory, draw_together, render_frames
from rtphys.sim import renderer
from rtphys.spec.collection import CollectionSpec
from rtphys.spec.episode import Recipe
from rtphys.spec.recording import RecordingSpec
from rtphys.spec.stored import differences
from rtphys.studies.worker import StudyWorker
from rtphys.task.spec import load_task

ROOT = "rtphys-staging"  # below the folder for temporary files, with user and node
# Paths that must mean the same on every node, and what stands in for a missing asset.
PASSED = ("RTPHYS_LIBRARY", "RTPHYS_ASSETS", "RTPHYS_ASSETS_FALLBACK")

Outcome = StagedEpisode | Rejection
Results = tuple[Outcome, ...]
"""What comes of a seed: an outcome for each side."""


class CollectionTask(NamedTuple):
    """One seed, for each side its recipe, a folder for its files, whether to keep a failure's."""

    recipes: tuple[Recipe, ...]
    folders: tuple[Path, ...]
    recording: RecordingSpec
    keep: tuple[bool, ...]
    paired: bool = True  # whether all must succeed


@dataclass(frozen=True, eq=False)
class Drawing:
    """An episode that is simulated and not drawn yet; can be pickled."""

    recipe: Recipe
    states: StateTrajectory
    episode: Episode
    folder: Path  # for its files
    recording: RecordingSpec


class Simulated(NamedTuple):
    """What an attempt of one side has come to; nothing is drawn yet."""

    rejection: Rejection | None = None
    drawing: Drawing | None = None  # also of a failure whose files are kept

    def outcome(self, draw: Callable[[Drawing], StagedEpisode]) -> Outcome:
        staged = self.drawing and draw(self.drawing)
        if self.rejection is None:
            assert staged is not None
            return staged
        return replace(self.rejection, kept=staged)


@dataclass
class CollectWorker(StudyWorker[CollectionTask, Results]):
    """Attempts a seed, and draws it with a shader."""

    shader: str = "slim"

    def start(self) -> None:
        renderer.ready(self.shader)

    def do(self, job: CollectionTask) -> Results:
        return tuple(side.outcome(self.draw) for side in self.simulate(job))

    def simulate(self, job: CollectionTask) -> tuple[Simulated, ...]:
        """Attempts all recipes; of what is paired, nothing is drawn unless all succeed."""
        attempts = [
            self.demonstrate(recipe, job.recording.touch, happened=True) for recipe in job.recipes
        ]
        failed, results = next((one for one in attempts if not one.accepted), None), []
        failed = failed if job.paired else None
        for one, folder, keep in zip(attempts, job.folders, job.keep, strict=True):
            if failed is not None and one.accepted:
                results.append(Simulated(rejection(unpaired(one, failed))))
            else:
                results.append(self.simulated(one, folder, job.recording, keep))
        return tuple(results)

    def simulated(
        self, attempt: Attempt, folder: Path, recording: RecordingSpec, keep: bool = True
    ) -> Simulated:
        """What is to be drawn of an attempt. `keep`: also of a failure, if that is possible."""
        why = None if attempt.accepted else rejection(attempt)
        if why is not None and not (keep and kept(attempt)):
            return Simulated(why)
        assert attempt.recording is not None
        states, episode = StateTrajectory.of(attempt.recording), assemble(attempt, self.pack)
        return Simulated(why, Drawing(attempt.recipe, states, episode, folder, recording))

    def draw(self, drawing: Drawing) -> StagedEpisode:
        """Draws, encodes and stages an episode."""
        return _staged(drawing, self._frames(drawing))

    def draw_all(self, jobs: Sequence[tuple[Simulated, ...]]) -> Sequence[Results]:
        """As `draw`, for the episodes of several jobs at once, with the same pictures."""
        waiting = [side.drawing for sides in jobs for side in sides if side.drawing]
        frames = [self._frames(drawing) for drawing in waiting]
        use = [partial(_staged, *pair) for pair in zip(waiting, frames, strict=True)]
        staged = dict(zip(waiting, draw_together([one.images for one in frames], use), strict=True))
        return [tuple(side.outcome(staged.__getitem__) for side in sides) for sides in jobs]

    def _frames(self, drawing: Drawing) -> RenderedFrames:
        task, states = self.tasks[drawing.recipe.task], drawing.states
        return render_frames(drawing.recipe, task, self.pack, states, drawing.recording)


def _staged(
    drawing: Drawing, frames: RenderedFrames, images: Iterable[Images] | None = None
) -> StagedEpisode:
    """`images`: those of `frames`, where another thread draws them."""
    episode = with_pictures(drawing.episode, frames)
    if images is not None:
        episode = replace(episode, images=images)
    return stage_episode(drawing.folder, episode, drawing.recording.layout)


# ---- on a machine with a GPU: some workers simulate, few draw ------------------------------------


def without_drawing(sides: Sequence[Simulated]) -> Results | None:
    """The results of a seed of which nothing is to be drawn; None: something is."""
    if any(side.drawing for side in sides):
        return None
    return tuple(side.rejection for side in sides if side.rejection is not None)


@dataclass(frozen=True)
class Simulator(Setup):
    """The half of a `CollectWorker` that needs no renderer."""

    worker: CollectWorker

    def warm(self) -> None:
        self.worker.warm()

    def __call__(self) -> Callable[[CollectionTask], tuple[Simulated, ...]]:
        return self.worker.simulate


@dataclass(frozen=True)
class Drawer(Setup):
    """The other half; `gpu`: the number of its GPU, None where there is one alone."""

    worker: CollectWorker
    gpu: int | None = None

    def warm(self) -> None:
        self.worker.warm()

    def __call__(self) -> Callable[[Sequence[tuple[Simulated, ...]]], Sequence[Results]]:
        if self.gpu is not None:  # SAPIEN draws on a GPU that CUDA shows, if there is one
            shown = os.environ.get("CUDA_VISIBLE_DEVICES") or None
            known = shown.split(",") if shown else [*map(str, range(self.gpu + 1))]
            os.environ["CUDA_VISIBLE_DEVICES"] = known[self.gpu % len(known)]
        self.worker.start()
        return self.worker.draw_all


# ---- on another machine: it must be the same, and sends its files back -------------------------


class OtherMachine(RtphysError):
    """A node that would make other episodes."""

    exit_code = 3


@dataclass(frozen=True, eq=False)
class SerializedEpisode(StagedEpisode):
    """A staged episode with the bytes of its files, as it is sent to another machine."""

    contents: Mapping[str, bytes]

    def written(self, folder: Path) -> StagedEpisode:
        """Writes the files where a local worker would have.

        Raises `CannotWrite`: the disk refuses; `OtherMachine`: the bytes are not those that were
        sent, or are of another file.
        """
        if strange := self.contents.keys() - {HDF5, VIDEO, INSTRUCTION}:
            raise OtherMachine(f"{folder}: an episode has no file {min(strange)!r}")
        shutil.rmtree(folder, ignore_errors=True)
        files.make_folder(folder)
        for name, data in self.contents.items():
            if files.write_synced(folder / name, data) != self.files[name]:
                raise OtherMachine(f"{folder / name}: it was damaged on its way here")
        rest = {key: value for key, value in vars(self).items() if key != "contents"}
        return StagedEpisode(**{**rest, "folder": folder})


@dataclass(frozen=True)
class RemoteWorker:
    """As `CollectWorker`, on a node that does not share the supervisor's disk; it checks all."""

    worker: CollectWorker  # its pack is the supervisor's
    digest: str  # of that pack
    # By task and robot: all that shapes their episodes.
    versions: Mapping[tuple[str, str], Mapping[str, str]]
    environment: Mapping[str, str]

    @staticmethod
    def of(worker: CollectWorker, specs: Iterable[CollectionSpec]) -> "RemoteWorker":
        asked = dict.fromkeys((one.episode.task, one.episode.embodiment) for one in specs)
        known = {(task, robot): versions(load_task(task), robot) for task, robot in asked}
        passed = {key: os.environ[key] for key in PASSED if key in os.environ}
        return RemoteWorker(worker, worker.pack.digest, known, passed)

    def __call__(self) -> Callable[[CollectionTask], Results]:
        """Raises `OtherMachine`. The builtin pack is built first if this node has none."""
        os.environ.update(self.environment)
        pack = default_pack()
        if pack.digest != self.digest:
            clause = f"its assets are {pack.digest[:12]}, the supervisor's {self.digest[:12]}"
            raise OtherMachine(f"{platform.node()}: {clause}; link the same pack on both")
        for (task, robot), wanted in self.versions.items():
            if clauses := differences(wanted, versions(load_task(task), robot)):
                raise OtherMachine(f"{platform.node()}: {task}: {'; '.join(clauses)}")
        folder = own_folder()
        do = replace(self.worker, pack=pack)()

        def do_and_ship(job: CollectionTask) -> Results:
            local = tuple(folder / str(n) for n in range(len(job.folders)))
            results = do(job._replace(folders=local))
            return tuple(of_files(one, _serialized) for one in results)

        return do_and_ship


def of_files(outcome: Outcome, move: Callable[[StagedEpisode], StagedEpisode]) -> Outcome:
    """An outcome whose files, those of a failure included, were moved."""
    if isinstance(outcome, StagedEpisode):
        return move(outcome)
    return outcome if outcome.kept is None else replace(outcome, kept=move(outcome.kept))


def arrived(outcome: Outcome, folder: Path) -> Outcome:
    """An outcome whose files lie in this folder: those of another machine are written there."""
    return of_files(
        outcome, lambda one: one.written(folder) if isinstance(one, SerializedEpisode) else one
    )


def _serialized(staged: StagedEpisode) -> SerializedEpisode:
    contents = {name: files.read(staged.folder / name, LARGEST_EPISODE) for name in staged.files}
    shutil.rmtree(staged.folder, ignore_errors=True)
    return SerializedEpisode(**vars(staged), contents=contents)


def own_folder() -> Path:
    """A folder of this process; removes those of processes that have died."""
    root = Path(tempfile.gettempdir()) / f"{ROOT}-{os.getuid()}-{platform.node()}"
    root.mkdir(mode=0o700, exist_ok=True)
    for old in root.iterdir():
        if not Path(f"/proc/{old.name}").exists():
            shutil.rmtree(old, ignore_errors=True)
    folder = root / str(os.getpid())
    folder.mkdir(exist_ok=True)
    return folder
