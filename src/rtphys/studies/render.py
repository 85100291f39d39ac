"""`render`: a dataset drawn again: other cameras, sizes, senses or looks, the same states."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

from rtphys.assets.pack import Pack, pack_with
from rtphys.campaign.local import run_here
from rtphys.campaign.pool import WorkerFailure
from rtphys.campaign.series import QUIET, Listener, Progress, Series
from rtphys.core.errors import BadFile, BadValue, RtphysError
from rtphys.core.untrusted import JSON
from rtphys.data import jpeg
from rtphys.data.attempts import Rejected
from rtphys.data.dataset import Dataset, Part
from rtphys.data.faults import OTHER_SEEDS, DatasetMismatch
from rtphys.data.json_text import plain
from rtphys.data.layout import MANIFEST, EpisodePaths, TaskDataset
from rtphys.data.manifest import TaskEntry, entries_there
from rtphys.data.rewrite import encoded_episode
from rtphys.data.staging import EncodedEpisode, StagedEpisode, stage_encoded
from rtphys.data.video import VIDEO_CAMERA, encode_images
from rtphys.data.writer import DatasetWriter, Rejection
from rtphys.episode.generate import attempt, under_look
from rtphys.episode.render import StateTrajectory, render_frames
from rtphys.senses import drawn
from rtphys.senses.states import BodyPoses
from rtphys.senses.touch import Touch
from rtphys.sim import renderer
from rtphys.spec.collection import TaskHeader
from rtphys.spec.episode import Recipe
from rtphys.spec.protocol import VisualRandomization
from rtphys.spec.recording import RecordingSpec
from rtphys.spec.stored import load
from rtphys.studies.rates import Cost, costs
from rtphys.studies.requests import RenderSpec
from rtphys.studies.resources import check_drawable, check_fits, check_space, episode_bytes
from rtphys.studies.worker import StudyWorker
from rtphys.task.spec import load_task


@dataclass(frozen=True)
class Rendered:
    """What came of a dataset that was drawn again."""

    episodes: int
    compared: int  # pictures that were stored with the same camera, size and look
    differing: int  # of those: not the stored bytes


class RenderTask(NamedTuple):
    """One stored episode."""

    paths: EpisodePaths
    layout: str
    scene: Mapping[str, JSON]  # its entry of scene_info.json
    recording: RecordingSpec
    same: bool  # look and shader are the stored ones, so that pictures can be compared
    assets: str  # digest
    folder: Path  # for the new files


class Redrawn(NamedTuple):
    """An episode in files that wait for their number, or a rejection that is taken over."""

    outcome: StagedEpisode | Rejection
    compared: int = 0
    differing: int = 0


def render(wanted: RenderSpec, listener: Listener = QUIET) -> Rendered:
    """Draws every episode again into a dataset of its own. Repeated, it continues.

    Raises `RtphysError`: what is refused before any work, such as assets of the collection that are
    not on this machine; states that are not stored, and cannot be simulated again.
    """
    chosen = wanted.part.of(Dataset(wanted.data))
    packs = _check(wanted, chosen)
    with DatasetWriter(wanted.out) as dataset:
        studies = [RenderSeries(wanted, part, dataset) for part in chosen.parts]
        shader = wanted.recording(chosen.parts[0].entry).shader
        worker = RenderWorker(next(iter(packs.values())), packs, shader)
        saved = dataset.checkpoint_if_due
        run_here(studies, worker, wanted.workers, listener, wanted.out, committed=saved)
        if halted := next((study.halted for study in studies if study.halted), ""):
            raise RtphysError(halted)
    return Rendered(
        len(chosen),
        sum(study.compared for study in studies),
        sum(study.differing for study in studies),
    )


def _check(wanted: RenderSpec, chosen: Dataset) -> dict[str, Pack]:
    """The packs by digest; refuses all that cannot work."""
    if wanted.out.resolve() == wanted.data.resolve():
        raise BadValue("out", str(wanted.out), "it is the dataset itself; name another folder")
    needed, packs, shaders, known = 0.0, dict[str, Pack](), set[str](), costs()
    there = entries_there(wanted.out)
    for part in chosen.parts:
        entry = part.entry
        digest = entry.resolved.assets.get("digest", "")
        recording, of, policy = wanted.recording(entry), entry.spec.episode, entry.spec.policy
        if policy is not None and "states" not in entry.spec.recording.senses:
            why = f"{wanted.data}: {of.task} was recorded without `states` of the policy {policy}"
            raise RtphysError(f"{why}, and what it did cannot be simulated again")
        shaders.add(recording.shader)
        check_fits(recording)
        if drawn(recording.senses):
            renderer.check_senses(recording.shader)
        cost = known.get(of.task, Cost(0, 0))
        done = there.get(TaskDataset.of(wanted.out, _header(wanted, part).spec).name)
        drawn_already = done.episodes + done.failures if done else 0
        left = max(sum(bool(row.on_disk) for row in part.rows()) - drawn_already, 0)
        needed += left * episode_bytes(cost, recording, _visual(wanted, entry))
        pack = packs.get(digest) or pack_with(digest)
        if pack is None:
            pack_name = entry.resolved.assets.get("pack", "unknown")
            named = f"{digest} (pack {pack_name})"
            why = f"{of.task} was collected with assets of digest {named}"
            raise RtphysError(f"{wanted.data}: {why}, which are not on this machine; link them")
        packs[digest] = pack
        load_task(of.task)
    if not packs:
        raise BadFile(wanted.data / MANIFEST, "lists no episodes")
    if any(part.tests for part in chosen.parts) and not (len(chosen) or chosen.failures()):
        raise BadFile(wanted.data, "the dataset holds no such episode")
    if len(shaders) > 1:
        allowed = f"the dataset was drawn with {' and '.join(sorted(shaders))}; name one of them"
        raise BadValue("shader", wanted.shader, allowed)
    check_space(wanted.out, needed)
    check_drawable(shader=shaders.pop())
    return packs


def _visual(wanted: RenderSpec, entry: TaskEntry) -> VisualRandomization | None:
    """Rules of the look that will be drawn."""
    stored = entry.resolved.visual
    own = None if stored is None else VisualRandomization.from_json(stored, MANIFEST)
    return own if wanted.look is None else under_look(own, wanted.look)


def _header(wanted: RenderSpec, part: Part) -> TaskHeader:
    """That of the source, but for what is drawn otherwise."""
    entry = part.entry
    visual, spec = _visual(wanted, entry), entry.spec
    spec = replace(spec, recording=wanted.recording(entry))
    if part.tests:
        spec = replace(spec, made_by="subset")
    if wanted.look is not None:
        # A twin's folder is named after that of its pair, so the look goes before that.
        old = spec.twin_of or spec.name
        new = f"{old}.look={wanted.look}"
        name = new + spec.name.removeprefix(old)
        spec = replace(spec, config=name, twin_of=spec.twin_of and new)
    rules = None if visual is None else visual.to_json()
    return TaskHeader(spec, replace(entry.resolved, visual=rules))


class RenderSeries(Series[RenderTask, Redrawn]):
    """One task dataset: its attempts in their order, the accepted ones drawn again."""

    def __init__(self, wanted: RenderSpec, part: Part, dataset: DatasetWriter) -> None:
        self.wanted, self.entry = wanted, part.entry
        self.compared = self.differing = 0  # pictures, as in `Rendered`
        self._rejections: dict[int, Rejection] = {}
        self._places: dict[int, tuple[EpisodePaths, Mapping[str, JSON]]] = {}
        seeds: list[int] = []
        for row in part.rows():
            seeds.append(row.seed)
            if (held := row.on_disk) is not None:
                self._places[row.seed] = held.paths(part.place), held.scene_info
            if isinstance(row, Rejected):
                rejection = Rejection(row.seed, row.reason, row.detail, row.physics)
                self._rejections[row.seed] = rejection
        accepted = len(seeds) - len(self._rejections)
        self.writer = writer = dataset.task(_header(wanted, part), accepted)
        there = list(writer.seeds())
        if there != seeds[: len(there)]:
            raise DatasetMismatch(writer.task_dataset.folder, [OTHER_SEEDS])
        left = seeds[len(there) :]
        task = part.entry.spec.episode.task
        progress = Progress(task, accepted, writer.totals.episodes, writer.totals.attempts)
        super().__init__(progress, left, owed=len(left))

    def job(self, seed: int) -> RenderTask:
        (paths, scene), layout = self._places[seed], self.entry.spec.recording.layout
        recording = self.wanted.recording(self.entry)
        alike = recording.shader == self.entry.spec.recording.shader
        same = self.wanted.look is None and alike
        assets = self.entry.resolved.assets.get("digest", "")
        return RenderTask(paths, layout, scene, recording, same, assets, self.writer.staging(seed))

    def known(self, seed: int) -> Redrawn | None:
        drawn_anew = seed in self._places  # a failure that was kept is drawn like an episode
        return None if drawn_anew else Redrawn(self._rejections[seed])

    def reason(self, result: Redrawn) -> str:
        if isinstance(result.outcome, Rejection):
            return result.outcome.reason
        return "failed" if "failure" in result.outcome.phys_meta else ""

    def commit(self, seed: int, result: Redrawn) -> str:
        outcome, rejection = result.outcome, self._rejections.get(seed)
        if rejection is not None and not isinstance(outcome, Rejection):
            outcome = replace(rejection, kept=outcome)
        self.writer.record(outcome)
        self.progress.add(self.reason(result))  # seeds that are owed are not counted otherwise
        self.compared += result.compared
        self.differing += result.differing
        return ""

    def lost(self, seed: int, loss: WorkerFailure) -> str:
        return f"{self.entry.spec.episode.task}, seed {seed}: {loss}"


@dataclass
class RenderWorker(StudyWorker[RenderTask, Redrawn]):
    """Draws stored episodes."""

    packs: Mapping[str, Pack]
    shader: str

    def start(self) -> None:
        renderer.ready(self.shader)

    def do(self, job: RenderTask) -> Redrawn:
        """Draws, encodes and stages one. Raises `BadFile`, `RtphysError`."""
        stored = encoded_episode(job.paths, job.layout, job.scene)
        recipe = load(Recipe, stored.phys_meta["recipe"], job.paths.phys_meta)
        task, pack = self.tasks[recipe.task], self.packs[job.assets]
        states = self._states(stored, recipe, pack, job.paths.hdf5)
        taken = render_frames(recipe, task, pack, states, job.recording)
        images = encode_images(taken.images, job.layout)
        alike = [
            (old, new)
            for name, streams in images.jpegs.items()
            if job.same and name in stored.images.jpegs
            for old, new in zip(stored.images.jpegs[name], streams, strict=True)
            if jpeg.shape_of(old) == jpeg.shape_of(new)
        ]
        if VIDEO_CAMERA not in images.jpegs:
            images.video = stored.images.video
        poses, scene = plain(taken.poses_json(), "cameras"), stored.scene_info
        meta = {**stored.phys_meta, "cameras": poses}
        if not job.same:
            meta["visual"] = plain(taken.look.to_json(), "visual")
            shown = taken.look.scene_info()
            scene = {**scene, **{key: plain(value, key) for key, value in shown.items()}}
        frames = replace(stored.frames, cameras=taken.cameras)
        made = EncodedEpisode(frames, images, meta, scene, stored.instructions, taken.sensed)
        staged = stage_encoded(job.folder, made, job.layout)
        return Redrawn(staged, len(alike), sum(old != new for old, new in alike))

    def _states(
        self, stored: EncodedEpisode, recipe: Recipe, pack: Pack, path: Path
    ) -> StateTrajectory:
        """The poses of all bodies: as they are stored, else simulated again and proven the same."""
        touch, held = None, stored.sensed
        if held is not None and "touch" in held.senses:
            touch = Touch.of(held.tracks, held.names)
        if held is not None and "states" in held.senses:
            times, bodies = stored.frames.time.tolist(), BodyPoses.of(held.tracks, held.names)
            return replace(StateTrajectory.of_poses(times, bodies), touch=touch)
        recording = attempt(recipe, self.tasks[recipe.task], pack).recording
        wanted = stored.phys_meta["state_hash"]
        if recording is None or recording.hash != wanted:
            found = "no states" if recording is None else f"states {recording.hash[:12]}"
            why = f"holds no `states`, and simulated again it gives {found}, not {str(wanted)[:12]}"
            raise RtphysError(f"{path}: {why}; rtphys or its task has changed since")
        return replace(StateTrajectory.of(recording), touch=touch)
