"""Assembles an attempt and its pictures into the episode that the files hold."""

from collections.abc import Iterable
from contextlib import suppress
from dataclasses import asdict, replace
from typing import cast

import numpy as np

from rtphys.assets.pack import Pack
from rtphys.core.errors import Infeasible
from rtphys.data.episode import Episode, Frames
from rtphys.data.writer import Rejection
from rtphys.episode.failure import went_wrong
from rtphys.episode.fingerprint import versions
from rtphys.episode.generate import Attempt, Instance, attempt
from rtphys.episode.render import RenderedFrames
from rtphys.physics import Physics, could_act, readback
from rtphys.physics.attribute import attribute, is_attribute
from rtphys.physics.domain import CENTER_OF_MASS
from rtphys.physics.enforce import acted, check_in_force
from rtphys.physics.handles import Happened
from rtphys.physics.reach import keys_of, reach
from rtphys.physics.values import Value
from rtphys.sim.feet import off_feet
from rtphys.sim.recorder import Recording
from rtphys.sim.world import World
from rtphys.spec.stored import stored
from rtphys.task.instructions import instructions, scene_info
from rtphys.task.props import Articulated, Mesh, Prop, parts
from rtphys.task.spec import load_task
from rtphys.visual.clutter import disturbed

RESTITUTION = "restitution"
NOT_AT_THE_END = "; not at the end: "  # then the names of what friction's `scope` leaves out


def left_out(scope: str) -> list[str]:
    """Objects that the `scope` of an episode's friction leaves out."""
    _, found, names = scope.partition(NOT_AT_THE_END)
    return names.split(", ") if found else []


def kept(attempt: Attempt) -> bool:
    """Whether a failed attempt can be assembled: something has happened in it."""
    rows = attempt.recording.rows if attempt.recording else ()
    return not attempt.accepted and attempt.instance is not None and len(rows) > 1


def assemble(tried: Attempt, pack: Pack) -> Episode:
    """The episode of an attempt without its pictures; of a failure also why and when it failed.

    It can be pickled. `with_pictures` makes it ready to be written.

    Raises `FalseLabel`: the physics in force is not the physics that was drawn; `ValueError`: it
    failed before anything had happened (see `kept`).
    """
    recipe, instance, recording = tried.recipe, tried.instance, tried.recording
    if instance is None or recording is None or not (tried.accepted or kept(tried)):
        raise ValueError(f"{recipe} was rejected: {tried.reason}")
    check_in_force(instance.world, instance.physics, f"{recipe.task}, seed {recipe.seed}")
    frames, rows, outcome = _frames(recording), recording.rows, tried.outcome
    scenery = [piece.name for piece in instance.look.clutter]
    first: dict[int, float] = {}  # stage -> time of its first frame; one shorter than a frame: none
    for row in rows:
        first.setdefault(row.stage, row.time)
    verdict = {
        "accepted": tried.accepted,
        "recovered": recording.recovered,
        # Unknown where it ended before it could be judged.
        "first_success_time": outcome.first_success if outcome else None,
        "held": outcome.held if outcome else None,
        "strain": asdict(recording.strain),
        "stages": [{"name": recording.stages[i], "time": time} for i, time in first.items()],
    }
    if scenery:
        moved = disturbed({n: np.array([row.objects[n] for row in rows]) for n in scenery})
        verdict |= {"clutter_disturbed": bool(moved), "disturbed": list(moved)}
    failure: dict[str, object] = {}
    if not tried.accepted:
        instant = went_wrong(frames, tried.reason, tried.detail, scenery)
        why = {"reason": tried.reason, "detail": tried.detail}
        failure["failure"] = {**why, **asdict(instant), "time": rows[instant.frame].time}
    known = label(instance, _happened(tried, pack))
    if leaning := _off_feet(instance.world):
        labels = cast(dict[str, dict[str, object]], known["attributes"])
        for key in keys_of("friction", labels):
            if off := [name for name in leaning if reach(key, labels).has(name)]:
                labels[key]["scope"] = f"{labels[key]['scope']}{NOT_AT_THE_END}{', '.join(off)}"
    return Episode(
        recipe=stored(recipe),
        frames=frames,
        phys_meta={
            **known,
            "cameras": {},
            "verdict": verdict,
            "versions": versions(instance.task, recipe.spec.embodiment),
            "state_hash": recording.hash,
            **failure,
        },
        instructions=instructions(instance.task, recipe.seed, describer(pack)),
        scene_info={**instance.look.scene_info(), "info": scene_info(instance.task, recipe.seed)},
        images=(),
    )


def with_pictures(episode: Episode, rendered: RenderedFrames) -> Episode:
    """What `assemble` made, with pictures and where their cameras were."""
    return replace(
        episode,
        frames=replace(episode.frames, cameras=rendered.cameras),
        phys_meta={**episode.phys_meta, "cameras": rendered.poses_json()},
        images=rendered.images,
        sensed=rendered.sensed,
    )


def rejection(tried: Attempt) -> Rejection:
    """The record of a rejected attempt, with its physics as far as it can be known."""
    recipe, known = tried.recipe, dict[str, object]()
    if tried.instance is not None:
        known = values(tried.instance.physics, tried.instance.props)
    else:
        with suppress(Infeasible):
            props = load_task(recipe.task).props(recipe.seed)
            known = values(recipe.spec.draw(recipe.seed), props)
            # It is redrawn until it lies inside bodies that nobody built.
            for key in keys_of(CENTER_OF_MASS, known):
                del known[key]
    return Rejection(recipe.seed, tried.reason, tried.detail, known)


def unpaired(accepted: Attempt, failed: Attempt) -> Attempt:
    """A success that gives no episode: its seed failed under another protocol, or value."""
    why = f"under {failed.recipe.spec.variation}: {failed.reason}"
    return replace(accepted, reason="unpaired", detail=why)


def label(instance: Instance, happened: Happened | None = None) -> dict[str, object]:
    """The part of a label file that is known before anyone acts, and which attributes did act."""
    recipe, physics = instance.recipe, instance.physics
    rules, able = recipe.spec.rules, could_act(physics, parts(instance.props))
    return {
        "seed": recipe.seed,
        "task": recipe.task,
        "protocol": recipe.protocol,
        "domain": {"name": instance.domain.name, "digest": instance.domain.digest},
        "attributes": {
            key: {
                "value": physics[key],
                "unit": attribute(key).unit,
                "varied": key in physics.varied,
                "source": rules.source(key, physics),
                "could_act": key in able,
                "acted": (happened and acted(key, physics, happened)) if key in able else False,
                "tolerance": attribute(key).deviation(physics[key]),
                "scope": attribute(key).scope,
            }
            for key in filter(is_attribute, physics)
        },
        "draws": {key: physics[key] for key in physics if not is_attribute(key)},
        "readback": readback(instance.world),
        **({} if rules.visual is None else {"visual": instance.look.to_json()}),
    }


def _happened(tried: Attempt, pack: Pack) -> Happened | None:
    """What happened; where the monitor saw no impact, another restitution tells.

    It does not watch while the world settles, a light touch hardly slows a heavy lid, and deep in a
    grip the solver's velocities are not those of the poses.
    """
    instance, recording = tried.instance, tried.recording
    assert instance is not None and recording is not None
    if recording.happened is None or recording.happened.impact:
        return recording.happened
    spec = tried.recipe.spec
    spec = replace(spec, overrides={**spec.overrides, **other_restitution(instance.physics)})
    again = attempt(spec.at(tried.recipe.seed), instance.task, pack).recording
    same = again is not None and again.hash == recording.hash
    return replace(recording.happened, impact=not same)


def other_restitution(physics: Physics) -> dict[str, Value]:
    """Another coefficient for all objects, and for each that has its own."""
    return {key: 0.0 if physics[key] else 0.5 for key in keys_of(RESTITUTION, physics)}


def _off_feet(world: World) -> list[str]:
    """Task objects that something bears at the end, and not by their feet: they lie or lean."""
    robot = set(world.robot.articulation.links)
    contacts = [c for c in world.solver.get_contacts() if robot.isdisjoint(c.bodies)]
    rigid = [o for o in world.objects.values() if o.articulation is None and o.bodies]
    return [thing.name for thing in rigid if off_feet(thing.root, contacts)]


def _frames(recording: Recording) -> Frames:
    rows = recording.rows
    arms, ends = np.array([row.arms for row in rows]), np.array([row.ee for row in rows])
    left_arm, right_arm = recording.layout.arms
    left_gripper, right_gripper = recording.layout.grippers
    return Frames(
        time=np.array([row.time for row in rows]),
        left_arm=arms[:, left_arm],
        right_arm=arms[:, right_arm],
        left_gripper=arms[:, left_gripper],
        right_gripper=arms[:, right_gripper],
        left_endpose=ends[:, 0],
        right_endpose=ends[:, 1],
        qpos=np.array([row.qpos for row in rows]),
        qvel=np.array([row.qvel for row in rows]),
        effort=np.array([row.effort for row in rows]),
        joint_names=recording.joint_names,
        object_poses={n: np.array([r.objects[n] for r in rows], float) for n in rows[0].objects},
        contacts={n: np.array([r.touched[n] for r in rows], np.bool_) for n in rows[0].touched},
        stage=np.array([row.stage for row in rows], np.int32),
        stages=tuple(recording.stages),
        cameras={},
    )


def describer(pack: Pack):
    """What a pack calls the models of props, for `task.instructions`."""

    def describe(prop: Prop) -> tuple[str, ...]:
        if isinstance(prop, Articulated):
            return pack.articulation(prop.category, prop.model).description
        return pack.model(prop.category, prop.model).description if isinstance(prop, Mesh) else ()

    return describe


def values(physics: Physics, props: Iterable[Prop]) -> dict[str, object]:
    """Attribute -> value of those that could act, for the record of a rejection."""
    return {key: physics[key] for key in sorted(could_act(physics, parts(props)))}
