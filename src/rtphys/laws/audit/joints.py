"""Weighs articulated objects by what their joints, or their loose roots, do under known forces."""

from collections.abc import Callable, Mapping
from functools import partial

import numpy as np

from rtphys.core.poses import Array
from rtphys.laws.audit.files import Matter, describe
from rtphys.laws.audit.specimen import REST, Finding, Measurement, Specimen, Unmeasured, hang
from rtphys.physics.handles import GRAVITY
from rtphys.sim.engine import TIME_STEP, from_sapien
from rtphys.sim.objects import SceneObject
from rtphys.sim.world import World
from rtphys.task.props import Articulated


class Mechanism:
    """Its degrees of freedom: six of a loose root (at its centre of mass), then the joints.

    `matter`: link -> what it should weigh; links without are mere frames.
    """

    def __init__(self, world: World, thing: SceneObject, matter: Mapping[str, Matter]) -> None:
        self.world, self.thing, self.matter = world, thing, matter
        assert thing.articulation is not None
        self.art = thing.articulation
        self.joints = list(self.art.active_joints)
        self.loose = 0 if thing.prop.fixed else 6
        self.size = self.loose + len(self.joints)
        root = [f"{thing.name} {word}" for word in ("x", "y", "z", "rx", "ry", "rz")]
        self.names = [*root[: self.loose], *(f"{thing.name}/{j.name}" for j in self.joints)]
        labelled = {body.name for body in thing.bodies}
        self.labelled = [link for link in matter if f"{thing.name}/{link}" in labelled]
        self._home = np.array(thing.pose.p)
        self.rest()
        # Nothing moves far in an experiment, so these hold throughout.
        self.X = {name: from_sapien(c.entity_pose) for name, c in thing.links.items()}
        self._axes = [from_sapien(joint.get_global_pose()) for joint in self.joints]

    def rest(self) -> None:
        """Back to where the experiments begin, at rest."""
        hang(self.thing, self._home)

    # ---- what the files say ----------------------------------------------------------------

    def jacobians(self, link: str) -> tuple[Array, Array]:
        """(3, n) velocity of a link's centre of mass, and of its rotation, per unit speed."""
        p, links = self.X[link] @ self.matter[link].com, self.thing.links
        linear, turning = np.zeros((3, self.size)), np.zeros((3, self.size))
        if self.loose:
            root = next(name for name, c in links.items() if c is self.thing.root)
            own = self.matter[root].com if root in self.matter else np.zeros(3)
            arm = p - self.X[root] @ own
            for axis, e in enumerate(np.eye(3)):
                linear[:, axis], turning[:, 3 + axis] = e, e
                linear[:, 3 + axis] = np.cross(e, arm)
        carriers, at = list[object](), links[link]
        while at is not None:  # it and all links between it and the root
            carriers.append(at)
            at = at.parent  # pyright: ignore[reportAttributeAccessIssue]
        for i, (joint, X) in enumerate(zip(self.joints, self._axes, strict=True), self.loose):
            if joint.child_link in carriers:
                u = X.R[:, 0]
                slides = joint.type == "prismatic"
                linear[:, i] = u if slides else np.cross(u, p - X.p)
                turning[:, i] = 0.0 if slides else u
        return linear, turning

    def mass_matrix(self) -> Array:
        """(n, n) of the links as the files and the label state them."""
        M = np.zeros((self.size, self.size))
        for link, matter in self.matter.items():
            linear, turning = self.jacobians(link)
            R = self.X[link].R
            M += matter.mass * linear.T @ linear + turning.T @ R @ matter.inertia @ R.T @ turning
        return M

    # ---- what the simulator does -----------------------------------------------------------

    def accelerations(self, push: Callable[[], None]) -> Array:
        """(n,) after one step from rest, in which `push` acted."""
        self.rest()
        push()
        self.world.step()
        return self.velocities() / TIME_STEP

    def velocities(self) -> Array:
        """(n,) speeds now."""
        root = self.thing.root
        loose = np.concatenate([root.linear_velocity, root.angular_velocity])  # pyright: ignore[reportAttributeAccessIssue]
        return np.concatenate([loose[: self.loose], self.art.qvel]).astype(float)

    def push(self, index: int, size: float) -> None:
        """Act on one degree of freedom in the next step [N or N m]."""
        e = np.zeros(max(self.size, 6))
        e[index] = size
        if index < self.loose:
            root = self.thing.root
            root.add_force_torque(e[:3].tolist(), e[3:6].tolist())  # pyright: ignore[reportAttributeAccessIssue]
        else:
            self.art.set_qf(e[self.loose : self.size].astype(np.float32))

    def push_link(self, link: str, force: Array) -> None:
        """Act on a link's centre of mass in the next step (3,) [N]."""
        component = self.thing.links[link]
        component.add_force_torque(force.tolist(), REST)  # pyright: ignore[reportAttributeAccessIssue]


STEPS = 25
WAY = 0.1  # [1] of half the joint's range that the torque should turn it by
LONGEST = 0.05  # [rad or m] and this at most
ACCELERATION = 1.0  # [m/s² or rad/s²] that a test force should give: nothing turns meanwhile
SEEN = 1e-6  # [1] share below which a direction of a centre of mass moves nothing
STILL = 1e-9  # [m/s] per unit speed of a joint: what moves less stands fast


def weigh_articulated(specimen: Specimen) -> list[Finding]:
    """Joint damping, mass, centre of mass and external force of every articulated task object."""
    k = specimen.number("object_scale")
    findings: list[Finding] = []
    for thing in specimen.world.objects.values():
        prop = thing.prop
        if thing.articulation is None:
            continue
        assert isinstance(prop, Articulated)
        mass, damped = (
            specimen.key(key, thing.name) for key in ("object_mass", "object_joint_damping")
        )
        f, offset = specimen.number(mass), specimen.offset(thing.name)
        links, dampings = describe(specimen.pack.articulation(prop.category, prop.model))
        matter: dict[str, Matter] = {}  # where the files state anything; no fixed root
        for name, link in links.items():
            component = thing.links.get(name)
            fast = component is thing.root and prop.fixed
            if link.matter is not None and component is not None and not fast:
                sized, shapes = link.matter.sized(k), component.collision_shapes
                matter[name] = sized.labelled(f, offset) if shapes else sized
        mechanism = Mechanism(specimen.world, thing, matter)
        free = specimen.values.get(damped) is None
        for index, joint in enumerate(mechanism.joints):
            label = dampings[joint.name] if free else specimen.number(damped)
            place, measured = f"{thing.name}/{joint.name}", _damping(mechanism, index, label)
            findings.append(Measurement(damped, place, label, measured))
        for joint in mechanism.joints:
            joint.set_drive_properties(0.0, 0.0)
        expected = np.array(np.linalg.inv(mechanism.mass_matrix()), float)
        columns: list[Array] = []
        for i, size in enumerate(ACCELERATION / np.diag(expected)):
            push = partial(mechanism.push, i, float(size))
            columns.append(mechanism.accelerations(push) / size)
        answer = np.array(columns).T  # (n, n), the inverse of the mass matrix
        for i, name in enumerate(mechanism.names):
            factor = f * expected[i, i] / answer[i, i] if answer[i, i] > 0 else np.inf
            findings.append(Measurement(mass, name, f, float(factor)))
        findings += _centres(specimen, mechanism, answer)
        findings.append(_force(specimen, mechanism, expected))
    return findings


def _damping(mechanism: Mechanism, index: int, label: float) -> float:
    """From the balance of momentum: torque * time = M v + damping * way.

    Under heavy damping PhysX's speed at a step's end is not the one at which the joint moved in
    it, but it is the one that this balance needs, and the way is measured.
    """
    art, dof = mechanism.art, mechanism.loose + index
    M, seconds = mechanism.mass_matrix(), STEPS * TIME_STEP
    inertia = 1 / np.linalg.inv(M)[dof, dof]
    low, high = np.clip(np.asarray(art.qlimits, float)[index], -1.0, 1.0)
    way = min(WAY * (high - low) / 2, LONGEST)
    torque = way * (label / seconds + 2 * inertia / seconds**2)
    mechanism.rest()
    start = float(art.qpos[index])
    for _ in range(STEPS):
        mechanism.push(dof, torque)
        mechanism.world.step()
    moved = float(art.qpos[index]) - start
    if moved == 0:
        return float("inf")
    return float((torque * seconds - M[dof] @ mechanism.velocities()) / moved)


def _centres(specimen: Specimen, mechanism: Mechanism, answer: Array) -> list[Finding]:
    """Where each link's centre of mass lies: a force there pushes each joint by its lever arm."""
    findings: list[Finding] = []
    to_force = np.linalg.inv(answer)
    for link in mechanism.labelled:
        place, (linear, turning) = f"{mechanism.thing.name}/{link}", mechanism.jacobians(link)
        if np.abs(linear).max() < STILL and np.abs(turning).max() < STILL:
            why = "stands fast: its mass and its centre of mass move nothing"
            lost = (specimen.key(name, place) for name in ("object_mass", "center_of_mass"))
            findings += [Unmeasured(key, place, why) for key in lost]
            continue
        force = ACCELERATION * mechanism.matter[link].mass
        pushes = [partial(mechanism.push_link, link, force * e) for e in np.eye(3)]
        answers = np.array([mechanism.accelerations(push) for push in pushes])
        # (3, n), which is turning x (what the centre is off by)
        gap = answers @ to_force.T / force - linear
        levers = np.vstack([np.cross(w, np.eye(3)).T for w in turning.T])
        off, _, rank, _ = np.linalg.lstsq(levers, gap.T.reshape(-1), rcond=SEEN)
        if not rank:
            why = "only slides: no motion of it tells where its centre of mass is"
            findings.append(Unmeasured(specimen.key("center_of_mass", place), place, why))
            continue
        offset = specimen.offset(place)
        aside = offset + mechanism.X[link].R.T @ off
        label, measured = tuple(offset.tolist()), tuple(aside.tolist())
        findings.append(Measurement(specimen.key("center_of_mass", place), place, label, measured))
    return findings


def _force(specimen: Specimen, mechanism: Mechanism, expected: Array) -> Finding:
    """The external force of the policy stage, from what it does to the whole mechanism."""
    world, place = mechanism.world, mechanism.thing.name
    unit = np.zeros(mechanism.size)  # generalised force if every link were pushed by its weight
    for link in mechanism.labelled:
        linear, _ = mechanism.jacobians(link)
        unit += GRAVITY * mechanism.matter[link].mass * linear[0]
    law = expected @ unit
    if np.abs(law).max() < STILL:
        return Unmeasured("external_force", place, "nothing of it can move along +X")

    def begin() -> None:
        world.policy_stage = True

    answer = mechanism.accelerations(begin)
    world.policy_stage = False
    # The share of the law's motion, and whatever is not along it.
    along = float(answer @ law / (law @ law))
    across = float(np.abs(answer - along * law).max() / np.abs(law).max())
    label = (specimen.number("external_force"), 0.0)
    return Measurement("external_force", place, label, (along, across))
