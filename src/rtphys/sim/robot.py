"""The dual-arm robot in the simulator: servos, commands, and what it measures of itself."""

from collections.abc import Iterable

import numpy as np
import sapien
from numpy.typing import NDArray
from sapien import physx

from rtphys.assets.embodiment import Embodiment, Limb
from rtphys.core.poses import Array, Pose
from rtphys.sim.body import SimServo, SimSurface, shape_points
from rtphys.sim.engine import from_sapien
from rtphys.sim.urdf import build_articulation

# [m] Soft pads: what is this near to them shares in a grip's friction, so that a load does not
# turn about the one point at which rigid faces would meet.
PAD_OFFSET = 0.02
# [m^2/s^2] PhysX's own 0.005 puts an arm to sleep that still sinks under its load by 2 mrad/s.
SLEEP = 1e-12

_NEAR = 0.02  # [m] from a joint: a shape that reaches there belongs to the joint's housing

Link = physx.PhysxArticulationLinkComponent


class SimArm:
    """One arm and its gripper: drive targets in, joint states out."""

    def __init__(self, limb: Limb, robot: "SimRobot") -> None:
        self.limb, self.side = limb, limb.side
        art = robot.articulation
        names = [j.name for j in art.active_joints]
        self.index = np.array([names.index(j) for j in limb.joints])
        self.finger_index = np.array([names.index(j) for j in limb.finger_joints])
        self._finger_columns = list(zip(self.finger_index.tolist(), limb.finger_signs, strict=True))
        self.joints = [art.active_joints[i] for i in self.index]
        self._fingers = [art.active_joints[i] for i in self.finger_index]
        self._mimics = [(1.0, 0.0), *((m.multiplier, m.offset) for m in limb.mimics)]
        efforts = zip(self.joints, limb.effort.tolist(), strict=True)
        self.servos = [SimServo(joint, limb.drive, effort) for joint, effort in efforts]
        self.finger_servos = [
            SimServo(joint, limb.gripper_drive, limb.finger_effort) for joint in self._fingers
        ]
        self.ee_link = art.find_link_by_name(limb.ee.link)
        self.finger_links = [j.child_link for j in self._fingers]
        self.links = [*(j.child_link for j in self.joints), *self.finger_links]
        self._articulation = art
        # Bound once: they are called at every step.
        self._send_q = [joint.set_drive_target for joint in self.joints]
        self._send_qd = [joint.set_drive_velocity_target for joint in self.joints]
        self._send_fingers = [joint.set_drive_target for joint in self._fingers]
        # Plain floats: handing SAPIEN numpy's own costs half as much again, at every step.
        self._q: list[float] = np.asarray(limb.home, float).tolist()
        self._qd = [0.0] * len(self._q)
        self.gripper = 1.0  # commanded opening, 0 closed .. 1 open
        for send, home in zip(self._send_q, self._q, strict=True):
            send(home)
        for send in self._send_qd:
            send(0.0)
        self._send_gripper()

    @property
    def target(self) -> Array:
        """Commanded joint positions (n,) [rad]."""
        return np.array(self._q)

    @property
    def commanded(self) -> list[float]:
        """Commanded joint positions [rad] and opening, n + 1 numbers."""
        return [*self._q, self.gripper]

    def drive(self, q: list[float], qd: list[float]) -> None:
        """Set the joints' drive targets [rad] and velocities [rad/s] from the next step on.

        Only changes are sent. The lists are kept: do not write into them.
        """
        if q != self._q:
            for send, now, before in zip(self._send_q, q, self._q, strict=True):
                if now != before:
                    send(now)
            self._q = q
        if qd != self._qd:
            for send, now, before in zip(self._send_qd, qd, self._qd, strict=True):
                if now != before:
                    send(now)
            self._qd = qd

    def stop(self) -> None:
        """Keep the commanded posture from the next step on."""
        self.drive(self._q, [0.0] * len(self._q))

    def grip(self, opening: float) -> None:
        """Gripper drive target, 0 closed .. 1 open."""
        if opening != self.gripper:
            self.gripper = float(opening)
            self._send_gripper()

    def _send_gripper(self) -> None:
        for send, target in zip(self._send_fingers, self.finger_targets, strict=True):
            send(target)

    @property
    def finger_targets(self) -> list[float]:
        """Drive targets of the finger joints [m]."""
        # Closed commands -1 cm: the target is never reached, so the servo keeps pressing.
        base = self.limb.finger_target(self.gripper)
        return [multiplier * base + offset for multiplier, offset in self._mimics]

    def measured(self) -> Array:
        """Measured joint positions (n,) [rad]."""
        return np.asarray(self._articulation.qpos, float)[self.index]

    def gap(self) -> float:
        """Distance between the finger pads [m], from joint positions."""
        return self._gap_at(self._articulation.qpos)

    def _gap_at(self, qpos: NDArray[np.float32]) -> float:
        number = qpos.item
        return sum([sign * number(i) for i, sign in self._finger_columns])

    def opening(self) -> float:
        """Measured opening 0..1: the gap over the gap that a fully open command makes."""
        return self.opening_at(self._articulation.qpos)

    def opening_at(self, qpos: NDArray[np.float32]) -> float:
        """The opening at these joint positions of the whole robot."""
        return min(max(self._gap_at(qpos) / (2 * self.limb.hand.finger_open), 0.0), 1.0)

    def ee(self) -> Pose:
        """Measured end-effector pose, world."""
        return self.ee_on(self.ee_link.entity_pose)

    def ee_on(self, link: sapien.Pose) -> Pose:
        """The end-effector pose where `ee_link` has this pose."""
        X_WL, offset = from_sapien(link), self.limb.ee.offset
        return X_WL if offset is None else X_WL @ offset

    def tcp(self) -> Pose:
        """Measured tool centre point, world."""
        return self.ee() @ Pose((self.limb.hand.tcp, 0, 0))


class SimRobot:
    """Both arms at home with open grippers, gravity compensated, driven by PD servos."""

    def __init__(self, scene: sapien.Scene, embodiment: Embodiment) -> None:
        self.scene, self.embodiment = scene, embodiment
        art = build_articulation(scene, embodiment.urdf, embodiment.base, folded=True)
        art.set_name(embodiment.name)
        art.set_sleep_threshold(SLEEP)
        self.articulation: physx.PhysxArticulation = art
        links = [link.name for link in art.links]
        rows = [links.index(joint.child_link.name) for joint in art.active_joints]
        # Force, then torque, in the joint's own frame, whose x is the axis.
        self._along_axis = rows, [0 if j.type == "prismatic" else 3 for j in art.active_joints]
        for joint in art.active_joints:
            joint.set_friction(0.0)
        for link in art.links:
            # Gravity compensation. compute_passive_force must not be added to this: it ignores
            # the flag, and both together push the arm up by 30 mrad.
            link.set_disable_gravity(True)
        self.left, self.right = (SimArm(limb, self) for limb in embodiment.limbs)
        self.arms = self.left, self.right
        self._outwards = np.ones(art.dof)  # +1 or, for a finger that opens downwards, -1
        for arm in self.arms:
            self._outwards[arm.finger_index] = arm.limb.finger_signs
        # Every joint that is no arm's is held (rear arms and wheels of the official URDF).
        used = {int(i) for arm in self.arms for i in (*arm.index, *arm.finger_index)}
        for i, joint in enumerate(art.active_joints):
            if i not in used:
                joint.set_drive_properties(1e4, 1e3)
                joint.set_drive_target(0.0)
        self._overlook_contacts()
        qpos = np.zeros(art.dof)
        for arm in self.arms:
            qpos[arm.index] = arm.target
            qpos[arm.finger_index] = arm.limb.hand.finger_open * np.array(arm.limb.finger_signs)
        art.set_qpos(qpos.astype(np.float32))
        self.pads: list[SimSurface] = []
        for arm in self.arms:
            for link in arm.finger_links:
                for shape in link.collision_shapes:
                    shape.contact_offset = PAD_OFFSET
                self.pads.append(
                    SimSurface(f"{arm.side}_gripper/{link.name}", link.collision_shapes)
                )
        fingers = {link for arm in self.arms for link in arm.finger_links}
        self.body = SimSurface(
            "robot", _shapes_of(link for link in art.links if link not in fingers)
        )

    def arm(self, side: str) -> SimArm:
        return self.left if side == "left" else self.right

    def _overlook_contacts(self) -> None:
        """Let the shapes of each arm before its hand, of each hand's fingers and of the rest pass.

        Fingers need no contact with each other: their joint limits stop them where they meet.
        The links of an arm overlap or nearly touch when it is folded, as at home: PhysX would push
        against the overlap and solve its contacts, half of a step, for nothing. What a hand can
        hit stays solid: the partner, its own arm, the rest of the robot.
        """
        moving = {link for arm in self.arms for link in arm.links}

        def hangs(link: Link) -> bool:
            """Whether a link moves, or is fixed, directly or not, to one: a wrist camera is."""
            return link in moving or (link.parent is not None and hangs(link.parent))

        groups = []
        for arm in self.arms:
            joints = arm.joints[:-1]
            anchor = np.asarray(joints[0].pose_in_parent.p, float)
            housing = []  # of the first joint
            for shape in joints[0].parent_link.collision_shapes:
                corners = shape_points(shape)
                inside = corners.min(0) - _NEAR <= anchor, anchor <= corners.max(0) + _NEAR
                if np.all(inside):
                    housing.append(shape)
            groups.append([*housing, *_shapes_of(joint.child_link for joint in joints)])
        groups += [_shapes_of(arm.finger_links) for arm in self.arms]
        groups.append(_shapes_of(link for link in self.articulation.links if not hangs(link)))
        for bit, shapes in enumerate(groups):
            for shape in shapes:
                words = shape.get_collision_groups()
                words[2] |= 1 << bit  # two shapes that share a bit of this word never collide
                shape.set_collision_groups(words)

    def effort(self) -> Array:
        """(dof,) what each joint exerted on its link in the last step: [N m], or [N] if it slides.

        Measured: what the joint transmits along its own axis, positive where that pushes the joint
        up, or the finger outwards. The links weigh nothing (gravity is compensated), so at rest it
        is -JᵀF, with F what loads and contacts do to the robot.
        """
        return self.effort_of(self.articulation.link_incoming_joint_forces)

    def effort_of(self, forces: NDArray[np.float32]) -> Array:
        """The effort where links have these incoming joint forces (n, 6)."""
        return np.asarray(forces, float)[self._along_axis] * self._outwards

    def link_owner(self) -> dict[str, str]:
        """Link name -> "left_gripper", "right_arm", ... or "robot", for contact queries."""
        owners = {link.name: "robot" for link in self.articulation.links}
        for arm in self.arms:
            for joint in arm.joints:
                owners[joint.child_link.name] = f"{arm.side}_arm"
            for link in arm.finger_links:
                owners[link.name] = f"{arm.side}_gripper"
        return owners


def _shapes_of(links: Iterable[Link]) -> list[physx.PhysxCollisionShape]:
    return [shape for link in links for shape in link.collision_shapes]
