"""Reproduces one seed of a dataset: simulates it again from its spec, and compares everything.

Nothing is taken from the episode's own files: its recipe follows from the ledger's first line and
the seed, and what comes of it is compared with all that is stored.
"""

from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

from rtphys.assets.pack import Pack, default_pack, pack_with
from rtphys.core.bounds import LARGEST_EPISODE
from rtphys.core.errors import BadValue, NoRenderer, RtphysError
from rtphys.core.untrusted import JSON
from rtphys.data import files, schema
from rtphys.data.attempts import Accepted, Rejected
from rtphys.data.compare import Comparison, RegeneratedEpisode, compare_episode, json_differences
from rtphys.data.hdf5_episode import EpisodeFile
from rtphys.data.json_text import plain, pretty
from rtphys.data.layout import MANIFEST, EpisodePaths, TaskDataset
from rtphys.data.staging import HDF5, PHYS_META, stage_episode, targets
from rtphys.episode.assemble import assemble, kept, rejection, unpaired, values, with_pictures
from rtphys.episode.fingerprint import versions
from rtphys.episode.generate import Attempt, attempt, prepare, under_look
from rtphys.episode.render import StateTrajectory, render_frames
from rtphys.physics.domain import Domain
from rtphys.sim.renderer import pictures_ready
from rtphys.spec.collection import TaskHeader
from rtphys.spec.episode import Recipe
from rtphys.spec.stored import differences, stored
from rtphys.task.spec import Task, load_task


@dataclass(frozen=True)
class RecordedAttempt:
    """What a dataset says of one seed."""

    out: Path
    header: TaskHeader
    row: Accepted | Rejected
    others: tuple[TaskHeader, ...] = ()  # under which the same seed had to succeed too

    @property
    def place(self) -> TaskDataset:
        return TaskDataset.of(self.out, self.header.spec)

    @property
    def paths(self) -> EpisodePaths:
        """Its files. Raises `ValueError`: there are none."""
        if self.row.on_disk is None:
            raise ValueError(f"{self.name} has no files")
        return self.row.on_disk.paths(self.place)

    @property
    def name(self) -> str:
        """For messages."""
        row = self.row
        what = f"episode {row.episode}" if isinstance(row, Accepted) else "rejected"
        return f"{self.place.name} seed {row.seed} ({what})"


def _recipe(header: TaskHeader, seed: int) -> Recipe:
    """It draws from the domain that is stored beside the spec, whose file may have changed."""
    domain = Domain.from_json(header.resolved.domain, "domain")
    return Recipe(replace(header.spec.episode, ranges=domain), seed)


@dataclass(frozen=True, eq=False)
class Scene:
    """A recorded attempt, and what it is simulated again with."""

    recorded: RecordedAttempt
    recipe: Recipe  # with the domain that is stored
    task: Task
    pack: Pack
    folder: Path

    def attempt(self) -> Attempt:
        touch = self.recorded.header.spec.recording.touch
        return attempt(self.recipe, self.task, self.pack, touch=touch, happened=True)


def scene_of(recorded: RecordedAttempt, folder: Path) -> Scene:
    """What a recorded attempt is made again with; its new files go to `folder`.

    Raises `RtphysError`: its task is not here, or its protocol draws by other rules here.
    """
    header = recorded.header
    resolved, task = header.resolved, load_task(header.spec.episode.task)
    recipe = _recipe(header, recorded.row.seed)
    # The protocol of that name must draw as the manifest says.
    own, shown = recipe.spec, header.spec.recording.look
    look = own.visual() if shown is None else under_look(own.visual(), shown)
    drawn = {
        "domain": (own.domain.digest, resolved.domain.get("digest")),
        "visual": (None if look is None else look.to_json(), resolved.visual),
    }
    for key, (here, there) in drawn.items():
        if here != there:
            allowed = f"protocol {own.protocol} has {here!r} here"
            raise BadValue(key, there, allowed, MANIFEST)
    return Scene(recorded, recipe, task, _pack(resolved.assets.get("digest", "")), folder)


def changed_since(scene: Scene) -> list[str]:
    """What is another version here than in the collection, a clause each; assets too."""
    resolved = scene.recorded.header.resolved
    now = versions(scene.task, scene.recipe.spec.embodiment)
    assets = differences(
        {"digest": resolved.assets.get("digest", "")}, {"digest": scene.pack.digest}
    )
    return [*differences(resolved.versions, now), *(f"assets.{clause}" for clause in assets)]


def reproduce(recorded: RecordedAttempt, folder: Path) -> Comparison:
    """Simulates a seed of a dataset again and compares; the new files go to `folder`."""
    spec, row, name = recorded.header.spec, recorded.row, recorded.place.name
    if spec.policy is not None:
        note = f"{name}: what {spec.policy} did is not made again without it"
        return Comparison([], [note], made=False)
    try:
        scene = scene_of(recorded, folder)
        found = _accepted(scene, row) if isinstance(row, Accepted) else _rejected(scene, row)
    except RtphysError as error:
        accepted = isinstance(row, Accepted)
        path = recorded.paths.phys_meta if accepted else recorded.place.ledger
        text = f"seed {row.seed} cannot be made again: {error}"
        return Comparison([(path, text)], made=False)
    if others := changed_since(scene):
        named = ", ".join(clause.partition(" was ")[0] for clause in others)
        suffix = f" (others here than in the collection: {named})"
        found.problems = [(path, text + suffix) for path, text in found.problems]
        found.notes.append(f"{name}: made again with others: {'; '.join(others)}")
    return found


@lru_cache(maxsize=4)
def _pack(digest: str) -> Pack:
    """The pack of the collection, or the one in use, which then stands in."""
    return pack_with(digest) or default_pack()


def _accepted(scene: Scene, row: Accepted) -> Comparison:
    recorded, again = scene.recorded, scene.attempt()
    if not again.accepted:
        text = f"made again it is rejected: {again.reason} ({again.detail})"
        return Comparison([(recorded.paths.phys_meta, text)])
    made = regenerated(again, scene)
    found = _compared(made, scene)
    assert again.instance is not None
    assert again.recording is not None
    expected: dict[str, JSON] = {
        "frames": len(made.frames),
        "physics": plain(values(again.instance.physics, again.instance.props)),
        "recovered": again.recording.recovered,
    }
    said: dict[str, JSON] = {key: getattr(row, key) for key in expected}
    texts = json_differences(said, expected)
    found.problems += [(recorded.place.ledger, f"seed {row.seed}: {text}") for text in texts]
    return found


def _rejected(scene: Scene, row: Rejected) -> Comparison:
    """Tries a rejected seed again; it may have succeeded, and failed under another protocol."""
    recorded, ledger = scene.recorded, scene.recorded.place.ledger
    first = again = scene.attempt()
    for header in recorded.others:
        if again.accepted:
            other = attempt(_recipe(header, row.seed), scene.task, scene.pack)
            again = again if other.accepted else unpaired(again, other)
    said = f"seed {row.seed} is recorded as rejected ({row.reason})"
    if again.accepted:
        return Comparison([(ledger, f"{said}, tried again it is accepted")])
    found = Comparison()
    if row.kept is not None:
        if not kept(first):
            return Comparison([(recorded.paths.phys_meta, "made again nothing happens in it")])
        found = _compared(regenerated(first, scene), scene)
    expected = rejection(again).row().model_dump(mode="json", exclude={"kept"})
    texts = json_differences(row.model_dump(mode="json", exclude={"kept"}), expected)
    found.problems += [(ledger, f"{said}: {text}") for text in texts]
    return found


def regenerated(again: Attempt, scene: Scene) -> RegeneratedEpisode:
    """The episode as `collect` stores it; without pictures where none can be drawn."""
    assert again.recording is not None
    episode, recording = assemble(again, scene.pack), scene.recorded.header.spec.recording
    if recording.look is not None:  # `render` drew it, and the label says so
        look = prepare(scene.recipe, scene.task, scene.pack, look=recording.look).look
        meta, info = episode.phys_meta, episode.scene_info
        meta, info = {**meta, "visual": look.to_json()}, {**info, **look.scene_info()}
        episode = replace(episode, phys_meta=meta, scene_info=info)
    words = schema.checked(schema.Instructions, episode.instructions)
    if not pictures_ready():
        kind = schema.PhysMeta if again.accepted else schema.FailureMeta
        facts = {"recipe": episode.recipe, **episode.phys_meta, "episode": 0}
        label, info = (
            schema.checked(kind, facts),
            schema.checked(schema.SceneEntry, episode.scene_info),
        )
        return RegeneratedEpisode(episode.frames, label, info, words, None)
    states = StateTrajectory.of(again.recording)
    pictures = render_frames(scene.recipe, scene.task, scene.pack, states, recording)
    staged = stage_episode(scene.folder, with_pictures(episode, pictures), recording.layout)
    frames = EpisodeFile(scene.folder / HDF5, recording.layout).frames()
    return RegeneratedEpisode(frames, staged.phys_meta, staged.scene_info, words, scene.folder)


def remade(recorded: RecordedAttempt, folder: Path) -> dict[Path, bytes]:
    """The files of an attempt, simulated and drawn again: where they belong, and their content.

    Raises `RtphysError`: it comes out otherwise here, or nothing can be drawn.
    """
    scene = scene_of(recorded, folder)
    again = scene.attempt()
    if again.accepted != isinstance(recorded.row, Accepted) or not (again.accepted or kept(again)):
        now = "accepted" if again.accepted else f"rejected: {again.reason} ({again.detail})"
        raise RtphysError(f"made again it is {now}")
    made = regenerated(again, scene)
    if made.folder is None:
        raise NoRenderer("no pictures can be drawn here")
    label = pretty(_as_labelled(made, recorded))
    places = targets(recorded.paths)
    return {
        path: label if name == PHYS_META else files.read(made.folder / name, LARGEST_EPISODE)
        for name, path in places.items()
    }


def _as_labelled(made: RegeneratedEpisode, recorded: RecordedAttempt) -> dict[str, JSON]:
    """Its label, with what the dataset calls it, and with the versions of the collection."""
    header = recorded.header
    # The domain is stored beside the spec; the recipe in a label names it as the user did.
    recipe = stored(header.spec.episode.at(recorded.row.seed))
    number = recorded.row.on_disk and recorded.row.on_disk.number
    label = {**made.label, "episode": number, "recipe": recipe}
    return {**label, "versions": {**header.resolved.versions}}


def _compared(made: RegeneratedEpisode, scene: Scene) -> Comparison:
    """With the stored files, and what cannot be compared."""
    recorded, header = scene.recorded, scene.recorded.header
    labelled = replace(made, label=_as_labelled(made, recorded))
    found = compare_episode(recorded.paths, recorded.place.layout, labelled)
    # scene_info.json follows from the ledger, which `verify` compares with it as a whole.
    assert recorded.row.on_disk is not None
    said, ledger = recorded.row.on_disk.scene_info, recorded.place.ledger
    texts = json_differences(said, {**made.scene_info}, "scene_info")
    found.problems += [(ledger, f"seed {recorded.row.seed}: {text}") for text in texts]
    own, name = replace(scene.recipe.spec, ranges=None).domain, recorded.place.name
    if own.digest != header.resolved.domain.get("digest"):
        text = "drawn from the manifest's domain, which is not the task's own here"
        found.notes.append(f"{name}: {text}")
    if made.folder is None:
        text = "pictures, video and camera poses were not drawn again: no device to draw with"
        found.notes.append(f"{name}: {text}")
    return found
