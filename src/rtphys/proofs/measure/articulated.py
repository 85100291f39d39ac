"""Weighs articulated objects by what their joints, or their loose roots, do under known forces."""

from functools import partial

import numpy as np

from rtphys.core.poses import Array
from rtphys.physics.handles import GRAVITY
from rtphys.proofs.measure.description import Description, describe
from rtphys.proofs.measure.finding import Finding, Measurement, Unmeasured
from rtphys.proofs.measure.joint_damping import damp
from rtphys.proofs.measure.matter import Matter
from rtphys.proofs.measure.mechanism import Mechanism
from rtphys.proofs.measure.specimen import Specimen
from rtphys.sim.objects import SceneObject
from rtphys.task.props import Articulated

ACCELERATION = 1.0  # [m/s² or rad/s²] that a test force should give: nothing turns meanwhile
SEEN = 1e-6  # [1] share below which a direction of a centre of mass moves nothing
STILL = 1e-9  # [m/s] per unit speed of a joint: what moves less stands fast


def weigh_articulated(specimen: Specimen) -> list[Finding]:
    """Joint damping, mass, centre of mass and external force of every articulated task object."""
    findings: list[Finding] = []
    for thing in specimen.articulated():
        prop = thing.prop
        assert isinstance(prop, Articulated)
        described = describe(specimen.pack.articulation(prop.category, prop.model))
        mechanism = Mechanism(specimen.world, thing, _matter(specimen, thing, described))
        findings += damp(specimen, mechanism, described.damping)
        mechanism.slacken()
        findings += _weigh(specimen, mechanism)
    return findings


def _matter(specimen: Specimen, thing: SceneObject, described: Description) -> dict[str, Matter]:
    """Link -> what it should weigh, where the files state anything; a fixed root is left out."""
    f, offset = specimen.number("object_mass"), specimen.vector("center_of_mass")
    k, found = specimen.number("object_scale"), dict[str, Matter]()
    for name, link in described.links.items():
        component = thing.links.get(name)
        standing = component is thing.root and thing.prop.fixed
        if link.matter is None or component is None or standing:
            continue
        sized = link.matter.sized(k)
        found[name] = sized.labelled(f, offset) if component.collision_shapes else sized
    return found


def _weigh(specimen: Specimen, mechanism: Mechanism) -> list[Finding]:
    f = specimen.number("object_mass")
    expected = np.array(np.linalg.inv(mechanism.mass_matrix()), float)
    sizes = ACCELERATION / np.diag(expected)
    columns = [
        mechanism.accelerations(partial(mechanism.push, i, float(size))) / size
        for i, size in enumerate(sizes)
    ]
    answer = np.array(columns).T  # (n, n), the inverse of the mass matrix
    findings: list[Finding] = []
    for i, name in enumerate(mechanism.names):
        factor = f * expected[i, i] / answer[i, i] if answer[i, i] > 0 else np.inf
        findings.append(Measurement("object_mass", name, f, float(factor)))
    findings += _centres(specimen, mechanism, answer)
    return [*findings, *_force(specimen, mechanism, expected)]


def _centres(specimen: Specimen, mechanism: Mechanism, answer: Array) -> list[Finding]:
    """Where each link's centre of mass lies: a force there pushes each joint by its lever arm."""
    findings: list[Finding] = []
    label = tuple(float(x) for x in specimen.vector("center_of_mass"))
    to_force = np.linalg.inv(answer)
    for link in _labelled(mechanism):
        place, (linear, turning) = f"{mechanism.thing.name}/{link}", mechanism.jacobians(link)
        if np.abs(linear).max() < STILL and np.abs(turning).max() < STILL:
            why = "stands fast: its mass and its centre of mass move nothing"
            findings += [Unmeasured(key, place, why) for key in ("object_mass", "center_of_mass")]
            continue
        force = ACCELERATION * mechanism.matter[link].mass
        answers = [
            mechanism.accelerations(partial(mechanism.push_link, link, force * e))
            for e in np.eye(3)
        ]
        # (3, n), which is turning x (what the centre is off by)
        gap = np.array(answers) @ to_force.T / force - linear
        levers = np.vstack([_cross(w) for w in turning.T])
        off, _, rank, _ = np.linalg.lstsq(levers, gap.T.reshape(-1), rcond=SEEN)
        if not rank:
            why = "only slides: no motion of it tells where its centre of mass is"
            findings.append(Unmeasured("center_of_mass", place, why))
            continue
        aside = np.array(label) + mechanism.X[link].R.T @ off
        measured = tuple(float(x) for x in aside)
        findings.append(Measurement("center_of_mass", place, label, measured))
    return findings


def _force(specimen: Specimen, mechanism: Mechanism, expected: Array) -> list[Finding]:
    """The external force of the policy stage, from what it does to the whole mechanism."""
    c, world = specimen.number("external_force"), mechanism.world
    unit = np.zeros(mechanism.size)  # generalised force if every link were pushed by its weight
    for link in _labelled(mechanism):
        linear, _ = mechanism.jacobians(link)
        unit += GRAVITY * mechanism.matter[link].mass * linear[0]
    law = expected @ unit
    place = mechanism.thing.name
    if np.abs(law).max() < STILL:
        return [Unmeasured("external_force", place, "nothing of it can move along +X")]

    def begin() -> None:
        world.policy_stage = True

    answer = mechanism.accelerations(begin)
    world.policy_stage = False
    # The share of the law's motion, and whatever is not along it.
    along = float(answer @ law / (law @ law))
    across = float(np.abs(answer - along * law).max() / np.abs(law).max())
    return [Measurement("external_force", place, (c, 0.0), (along, across))]


def _labelled(mechanism: Mechanism) -> list[str]:
    """Links to which the label applies."""
    named = {body.name for body in mechanism.thing.bodies}
    return [link for link in mechanism.matter if f"{mechanism.thing.name}/{link}" in named]


def _cross(w: Array) -> Array:
    """(3, 3) that multiplies a vector by w x."""
    x, y, z = w
    return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
