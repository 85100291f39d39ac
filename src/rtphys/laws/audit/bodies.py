"""Weighs floating bodies: a force gives mass, torques inertia, a spin the centre of mass."""

import numpy as np

from rtphys.core.poses import Array
from rtphys.laws.audit.files import Matter, describe, matter_of, parts_of
from rtphys.laws.audit.specimen import Finding, Measurement, Specimen, Unmeasured, hang
from rtphys.physics.handles import GRAVITY
from rtphys.sim.engine import TIME_STEP, from_sapien
from rtphys.sim.objects import SceneObject
from rtphys.task.props import Articulated, Ball

ACCELERATION = 25.0  # [m/s²] that the test force should give
SPIN_UP = 50.0  # [rad/s²] that the test torque should give
SPIN, SPINNING = 60.0, 4  # [rad/s], [steps]: about a radian in all


def weigh_bodies(specimen: Specimen) -> list[Finding]:
    """Mass, inertia, centre of mass and external force of every rigid task body."""
    k = specimen.number("object_scale")
    sized = [matter_of(o.prop, specimen.pack).sized(k) for o in specimen.rigid()]
    if not sized:
        return []
    trial = _Trial(specimen, sized)
    return [*trial.masses(), *trial.centres(), *trial.forces()]


class _Trial:
    """Experiments on all rigid bodies at once, each of which begins at rest.

    `sized`: what each body weighs as the asset's files state it, at the label's scale.
    """

    def __init__(self, specimen: Specimen, sized: list[Matter]) -> None:
        self._specimen, self._world, self._sized = specimen, specimen.world, sized
        self._things = specimen.rigid()
        self._components = [thing.bodies[0].component for thing in self._things]
        self._home = [np.array(thing.pose.p) for thing in self._things]
        self._keys = [specimen.key("object_mass", thing.name) for thing in self._things]
        labels = zip(self._things, self._keys, strict=True)
        of_each = [(specimen.number(key), specimen.offset(thing.name)) for thing, key in labels]
        self._expected = [m.labelled(*label) for m, label in zip(sized, of_each, strict=True)]

    def masses(self) -> list[Finding]:
        """Factors on the assets' mass and inertia, from one step under a force and a torque along
        each axis."""
        pushed: list[Array] = []  # (bodies, 6) velocities [m/s], [rad/s] of each axis
        for axis, direction in enumerate(np.eye(3)):
            self._rest()
            for component, matter in zip(self._components, self._expected, strict=True):
                force = ACCELERATION * matter.mass * direction
                torque = SPIN_UP * matter.inertia[axis, axis] * direction
                component.add_force_torque(force.tolist(), torque.tolist())
            self._world.step()
            pushed.append(self._velocities())
        speed = ACCELERATION * TIME_STEP
        findings: list[Finding] = []
        for i, (thing, matter) in enumerate(zip(self._things, self._expected, strict=True)):
            key = self._keys[i]
            f = self._specimen.number(key)
            gained = [float(pushed[axis][i, axis]) for axis in range(3)]
            masses = [f * speed / v if v else np.inf for v in gained]
            mass = float(max(masses, key=lambda m: abs(m - f)))
            findings.append(Measurement(key, thing.name, f, mass))
            response = np.array([pushed[axis][i, 3:] for axis in range(3)]).T  # columns: I^-1 τ
            worst = f * max(_principal_ratios(thing, response, matter), key=lambda r: abs(r - 1))
            findings.append(Measurement(key, f"{thing.name}, inertia", f, worst))
        return findings

    def centres(self) -> list[Finding]:
        """Offsets of the centres of mass, own frame: the points about which bodies turn."""
        rows: list[list[Array]] = [[] for _ in self._things]
        moved: list[list[Array]] = [[] for _ in self._things]
        for axis in range(3):
            self._rest()
            for thing in self._things:
                spin = (SPIN * np.eye(3)[axis]).tolist()
                thing.root.set_angular_velocity(spin)  # pyright: ignore[reportAttributeAccessIssue]
            for _ in range(SPINNING):
                self._world.step()
            for i, thing in enumerate(self._things):
                X = from_sapien(thing.root.entity_pose)
                # The centre stays where it was: p' + R' c = p + c.
                rows[i].append(X.R - np.eye(3))
                moved[i].append(self._home[i] - X.p)
        findings: list[Finding] = []
        for thing, matter, a, b in zip(self._things, self._sized, rows, moved, strict=True):
            c = np.linalg.lstsq(np.vstack(a), np.hstack(b), rcond=None)[0]
            aside = tuple((c - matter.com).tolist())
            key = self._specimen.key("center_of_mass", thing.name)
            label = tuple(self._specimen.offset(thing.name).tolist())
            findings.append(Measurement(key, thing.name, label, aside))
        return findings

    def forces(self) -> list[Finding]:
        """The external force of the policy stage, as a share of the weight, and its moment."""
        self._rest()
        self._world.policy_stage = True
        self._world.step()
        self._world.policy_stage = False
        findings: list[Finding] = []
        label = (self._specimen.number("external_force"), 0.0, 0.0)
        for thing, m, v in zip(self._things, self._expected, self._velocities(), strict=True):
            force = tuple((v[:3] / (GRAVITY * TIME_STEP)).tolist())
            findings.append(Measurement("external_force", thing.name, label, force))
            arm = np.sqrt(np.trace(m.inertia) / 2 / m.mass)  # [m] radius of gyration
            moment = m.inertia @ v[3:] / TIME_STEP / (m.mass * GRAVITY * arm)
            turn = float(np.linalg.norm(moment))
            findings.append(Measurement("external_force", f"{thing.name}, moment", 0.0, turn))
        return findings

    def _rest(self) -> None:
        for thing, p in zip(self._things, self._home, strict=True):
            hang(thing, p)

    def _velocities(self) -> Array:
        """(bodies, 6) of the centres of mass [m/s], and of the rotation [rad/s]."""
        every = [[*c.linear_velocity, *c.angular_velocity] for c in self._components]
        return np.array(every, float)


def _principal_ratios(thing: SceneObject, response: Array, expected: Matter) -> list[float]:
    """Moments of inertia, along the axes in which the expected one is a unit tensor.

    `response`: (3, 3) angular velocities that three torques gave, as columns.
    """
    decay = thing.prop.spin_decay if isinstance(thing.prop, Ball) else 0.0
    # A soft ball loses this share of its spin in every step, whatever its inertia.
    gained = response / (1 - decay * TIME_STEP)
    torques = SPIN_UP * np.diag(np.diag(expected.inertia))
    try:
        measured = torques @ np.linalg.inv(gained / TIME_STEP)
    except np.linalg.LinAlgError:
        return [float("inf")]
    L = np.linalg.inv(np.linalg.cholesky(expected.inertia))
    whitened = L @ measured @ L.T
    return np.linalg.eigvalsh((whitened + whitened.T) / 2).tolist()


def size_up(specimen: Specimen) -> list[Finding]:
    """The scale of every task object with shapes, at the link where it is furthest off."""
    k = specimen.number("object_scale")
    findings: list[Finding] = []
    for thing in specimen.world.objects.values():
        if not any(c.collision_shapes for c in thing.links.values()):
            continue  # a mark that nothing can touch
        ratios: list[float] = []
        for link, nominal in _nominal(specimen, thing).items():
            box = np.array(thing.links[link].compute_global_aabb_tight(), float)
            # Of its three sides: PhysX simplifies hulls, and a corner that it cuts off can
            # shorten one side (by 5 % at the worst, a loaf's) without being a scale.
            ratios.append(float(np.median((box[1] - box[0]) / nominal)))
        if ratios:
            worst = max(ratios, key=lambda ratio: abs(ratio - k))
            findings.append(Measurement("object_scale", thing.name, k, worst))
        else:
            why = "its shapes are round, and none of them is read here"
            findings.append(Unmeasured("object_scale", thing.name, why))
    return findings


def _nominal(specimen: Specimen, thing: SceneObject) -> dict[str, Array]:
    """Link without round shapes -> size (3,) [m] of the box around it at scale 1, world axes."""
    prop = thing.prop
    if isinstance(prop, Ball):
        return {"": np.full(3, 2 * prop.radius)}
    if not isinstance(prop, Articulated):
        parts = np.vstack(parts_of(prop, specimen.pack))
        return {"": np.ptp(parts @ thing.pose.R.T, axis=0)}
    links, _ = describe(specimen.pack.articulation(prop.category, prop.model))
    found: dict[str, Array] = {}
    for name, link in links.items():
        component = thing.links.get(name)
        if component is not None and component.collision_shapes and link.parts:
            R = from_sapien(component.entity_pose).R
            found[name] = np.ptp(np.vstack(link.parts) @ R.T, axis=0)
    return found
