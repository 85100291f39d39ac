"""An articulated object as a mechanism: what its files say it weighs, and how it answers pushes."""

from collections.abc import Callable, Mapping

import numpy as np

from rtphys.core.poses import Array
from rtphys.proofs.measure.matter import Matter
from rtphys.proofs.measure.specimen import REST, hang
from rtphys.sim.engine import TIME_STEP, from_sapien
from rtphys.sim.objects import SceneObject
from rtphys.sim.world import World


class Mechanism:
    """Its degrees of freedom: six of a loose root (at its centre of mass), then the joints.

    Args:
        matter: link -> what it should weigh; links without are mere frames.
    """

    def __init__(self, world: World, thing: SceneObject, matter: Mapping[str, Matter]) -> None:
        self.world, self.thing, self.matter = world, thing, matter
        assert thing.articulation is not None
        self.art = thing.articulation
        self.joints = list(self.art.active_joints)
        self.loose = 0 if thing.prop.fixed else 6
        self.size = self.loose + len(self.joints)
        self._home = np.array(thing.pose.p)
        self.rest()
        # Nothing moves far in an experiment, so these hold throughout.
        self.X = {name: from_sapien(c.entity_pose) for name, c in thing.links.items()}
        self._axes = [self._axis(joint) for joint in self.joints]

    @property
    def names(self) -> list[str]:
        """One for each degree of freedom."""
        root = [f"{self.thing.name} {word}" for word in ("x", "y", "z", "rx", "ry", "rz")]
        return [*root[: self.loose], *(f"{self.thing.name}/{j.name}" for j in self.joints)]

    def rest(self) -> None:
        """Back to where the experiments begin, at rest."""
        hang(self.thing, self._home)

    # ---- what the files say ----------------------------------------------------------------

    def jacobians(self, link: str) -> tuple[Array, Array]:
        """(3, n) velocity of a link's centre of mass, and of its rotation, per unit speed."""
        p = self.X[link] @ self.matter[link].com
        linear, turning = np.zeros((3, self.size)), np.zeros((3, self.size))
        if self.loose:
            arm = p - self._root_centre()
            for axis, e in enumerate(np.eye(3)):
                linear[:, axis], turning[:, 3 + axis] = e, e
                linear[:, 3 + axis] = np.cross(e, arm)
        carriers = self._carriers(link)
        for i, (joint, (u, point)) in enumerate(zip(self.joints, self._axes, strict=True)):
            if joint.child_link not in carriers:
                continue
            if joint.type == "prismatic":
                linear[:, self.loose + i] = u
            else:
                linear[:, self.loose + i] = np.cross(u, p - point)
                turning[:, self.loose + i] = u
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

    def slacken(self) -> None:
        """Take the damping from all joints."""
        for joint in self.joints:
            joint.set_drive_properties(0.0, 0.0)

    # ---- geometry --------------------------------------------------------------------------

    def _root_centre(self) -> Array:
        root = next(n for n, c in self.thing.links.items() if c is self.thing.root)
        return self.X[root] @ (self.matter[root].com if root in self.matter else np.zeros(3))

    def _axis(self, joint) -> tuple[Array, Array]:
        """Direction (3,) and a point (3,) of a joint's axis, world frame."""
        X = from_sapien(joint.get_global_pose())
        return X.R[:, 0], X.p

    def _carriers(self, link: str) -> list[object]:
        """A link and all links between it and the root."""
        found, at = [], self.thing.links[link]
        while at is not None:
            found.append(at)
            at = at.parent  # pyright: ignore[reportAttributeAccessIssue]
        return found
