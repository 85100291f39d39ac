"""Audits labels: builds the world of each episode again from its recipe, and measures there."""

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from rtphys.assets.pack import Pack, default_pack, pack_with
from rtphys.core.errors import Infeasible, RtphysError
from rtphys.core.poses import Array, Pose
from rtphys.data.dataset import Dataset
from rtphys.data.schema import PhysMeta
from rtphys.episode.assemble import RESTITUTION, left_out, other_restitution
from rtphys.episode.generate import POLL, Instance, prepare, settle, start
from rtphys.expert.robot import ExpertRobot
from rtphys.laws.audit import measure
from rtphys.laws.audit.demonstration import Demonstration, replay
from rtphys.laws.audit.overlaps import overlaps
from rtphys.laws.audit.specimen import TOLERANCES, Finding, Measurement, Specimen, Unmeasured
from rtphys.physics import attributes
from rtphys.physics.enforce import disagreements, enforce
from rtphys.physics.reach import keys_of, split
from rtphys.physics.values import Physics
from rtphys.sim.rollout import Rollout, RolloutOptions
from rtphys.sim.touch import in_hand
from rtphys.sim.world import World
from rtphys.spec.episode import Recipe
from rtphys.spec.recording import HEAD
from rtphys.spec.stored import load
from rtphys.task.spec import load_task

# Axes x forward, y left, z up -> those of OpenCV: x right, y down, z forward.
TO_OPENCV = np.array([[0, -1, 0, 0], [0, 0, -1, 0], [1, 0, 0, 0], [0, 0, 0, 1]], float)


def rebuild(meta: PhysMeta, labelled: Physics, pack: Pack) -> tuple[World, list[str]]:
    """The initial world of an episode, and a sentence for each value that its recipe gives and its
    label has not.

    Raises `RtphysError`, `ValueError`: its recipe or its task cannot be read, or gives no world.
    """
    recipe = load(Recipe, meta.recipe, "its recipe")
    instance = prepare(recipe, load_task(recipe.task), pack)
    given = instance.physics
    return instance.world, [
        f"{key}: the label says {labelled.get(key)}, its recipe gives {given.get(key)}"
        for key in sorted({*labelled, *given})
        if labelled.get(key) != given.get(key)
    ]


@dataclass(frozen=True)
class Audit:
    """What became of one episode's label."""

    path: Path  # of the label
    problems: tuple[str, ...] = ()  # sentences: rebuilding, recipe
    notes: tuple[str, ...] = ()  # what this label cannot show
    findings: tuple[Finding, ...] = field(default=(), repr=False)

    @property
    def deviations(self) -> list[Measurement]:
        """Values that experiments found elsewhere than the label says."""
        return [f for f in self.findings if isinstance(f, Measurement) and not f.passed]

    @property
    def sound(self) -> bool:
        return not self.problems and not self.deviations


def audit_episode(
    meta: PhysMeta,
    physics: Physics,
    pack: Pack,
    path: Path,
    cameras: Mapping[str, Pose] | None = None,
    ends: Mapping[str, Pose] | None = None,
) -> Audit:
    """Rebuild and measure one episode.

    Args:
        meta: the label, and `physics`: its attributes and draws as values.
        pack: the assets with which it was collected.
        path: of its label, for reports.
        cameras: where other files say that the head camera was.
        ends: object -> its last pose, as other files say.
    """
    try:
        world, problems = rebuild(meta, physics, pack)
    except (RtphysError, ValueError) as error:
        return Audit(path, (f"cannot be rebuilt: {error}",))
    deep = overlaps(world).items()
    problems += [f"{a} lies {1000 * d:.1f} mm deep in {b} at the start" for (a, b), d in deep]
    # Attributes of a user's library, which no experiment knows, are read back instead. Then they
    # are held at their nominal values, because drag would slow a body that is weighed.
    own = {key: value for key, value in physics.items() if split(key)[0] not in TOLERANCES}
    problems += disagreements(world, Physics(own))
    nominal = {key: a.nominal for key, a in attributes().items() if key not in TOLERANCES}
    enforce(world, Physics(own | nominal))
    stored = dict(cameras or {})
    if head := meta.cameras.get(HEAD):
        stored["label"] = Pose(head.position, head.quaternion_wxyz)
    acting = {key for key, label in meta.attributes.items() if label.could_act}
    scopes = (meta.attributes[key].scope for key in keys_of("friction", meta.attributes))
    exempt = {name for scope in scopes for name in left_out(scope)}
    findings = measure(Specimen(world, pack, dict(physics)), acting, stored, ends, exempt)
    return Audit(path, tuple(problems), findings=tuple(findings))


def watched(
    recipe: Recipe, pack: Pack, gentle: bool = False
) -> tuple[Instance, Rollout, Demonstration]:
    """Lets the expert demonstrate an episode, and watches; the rollout is not finished yet.

    Raises `Infeasible`: it cannot, or, if `gentle`, a link is pressed too hard.
    """
    task = load_task(recipe.task)
    instance = prepare(recipe, task, pack)
    settle(instance)
    rollout = start(instance, RolloutOptions(task.step_limit, POLL, gentle=gentle))
    seen = Demonstration(instance.world, in_hand(instance.physics))
    task.script(ExpertRobot(rollout, recipe.stream("expert"), recipe.spec.recovery))
    return instance, rollout, seen


def repeated(meta: PhysMeta, pack: Pack) -> list[str]:
    """Lets the expert demonstrate an episode once more; sentences on what deviates.

    No link but a finger may be pressed for long, nothing may creep in a hand, and where the label
    says that restitution did not act, the same commands under another must give the same bits.
    """
    recipe = load(Recipe, meta.recipe, "its recipe")
    try:
        instance, rollout, seen = watched(recipe, pack)
        rollout.finish()
    except Infeasible as problem:
        return [f"the expert does not demonstrate it again: {problem}"]
    if rollout.recorder.recording.hash != meta.state_hash:
        return ["the expert demonstrates it otherwise now: other states"]
    problems = seen.problems()
    if meta.attributes[RESTITUTION].acted is False:
        other = prepare(recipe, instance.task, pack)
        held = other_restitution(instance.physics)
        enforce(other.world, Physics(held))  # before it settles: it would wake what has
        settle(other)
        if (step := replay(other.world, seen.commands, seen.states)) is not None:
            why = f"with {held[RESTITUTION]} step {step} has other bits"
            problems.append(f"{RESTITUTION}: the label says that it did not act, but {why}")
    return problems


def audited(dataset: Dataset, repeats: int = 0) -> Iterator[Audit]:
    """Audits every episode, each with its own assets, in the dataset's order.

    `repeats`: of how many episodes the demonstration is repeated, too.

    Where the asset pack of the collection is not on this machine, the pack in use stands in, and
    the audit says so.
    """
    packs: dict[str, Pack] = {}
    digests = [
        entry.resolved.assets.get("digest", "")
        for entry in dataset.task_datasets
        for _ in range(entry.episodes)
    ]
    for episode, digest in zip(dataset, digests, strict=True):
        if digest not in packs:
            packs[digest] = pack_with(digest) or default_pack()
        pack, path = packs[digest], episode.paths.phys_meta
        try:
            camera = episode.frames.cameras.get(HEAD)
            where = {} if camera is None else {"pictures": from_opencv(camera.extrinsic_cv[0])}
            tracks = episode.frames.object_poses
            ends = {name: Pose(p[-1, :3], p[-1, 3:]) for name, p in tracks.items()}
            audit = audit_episode(episode.meta, episode.physics, pack, path, where, ends)
            if (repeats := repeats - 1) >= 0:
                found = repeated(episode.meta, pack)
                audit = replace(audit, problems=(*audit.problems, *found))
        except RtphysError as error:
            audit = Audit(path, (str(error),))
        if digest != pack.digest:
            note = "measured with other assets than it was collected with"
            audit = replace(audit, notes=(note,))
        yield audit


def from_opencv(extrinsic: Array) -> Pose:
    """World pose (x forward, y left, z up) of a camera from its matrix (3, 4), world -> camera."""
    world_to_camera = np.vstack([extrinsic, [0.0, 0.0, 0.0, 1.0]])
    return Pose.from_matrix(np.linalg.inv(world_to_camera) @ TO_OPENCV)


@dataclass
class Totals:
    """What many audits say together."""

    episodes: int = 0
    sound: int = 0
    worst: dict[str, Measurement] = field(default_factory=dict[str, Measurement])
    measured: Counter[str] = field(default_factory=Counter[str])
    unmeasured: Counter[tuple[str, str]] = field(default_factory=Counter[tuple[str, str]])

    def add(self, audit: Audit) -> None:
        """Count one more; the worst is what takes up the largest share of its tolerance."""
        self.episodes += 1
        self.sound += audit.sound
        for finding in audit.findings:
            if isinstance(finding, Unmeasured):
                self.unmeasured[finding.key, finding.why] += 1
                continue
            self.measured[finding.key] += 1
            worst = self.worst.setdefault(finding.key, finding)
            if finding.deviation / finding.tolerance > worst.deviation / worst.tolerance:
                self.worst[finding.key] = finding
