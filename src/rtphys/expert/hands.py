"""Both grippers: closing on a prop, how fast it may go, feeling its contact, letting go."""

from collections.abc import Callable

import numpy as np

from rtphys.assets.action_layout import SIDES
from rtphys.assets.embodiment import Limb
from rtphys.core.arithmetic import total
from rtphys.core.errors import Infeasible
from rtphys.core.poses import Array, Pose
from rtphys.expert.planner import DualArmPlanner
from rtphys.physics.handles import GRAVITY
from rtphys.plan.trajectory import stroke
from rtphys.sim.engine import TIME_STEP, from_sapien
from rtphys.sim.rollout import Rollout
from rtphys.task.arm import Grip

STROKE_TIME = 0.4  # [s] for the whole stroke at the real gripper's greatest speed, 11 cm/s a finger
GRIP_LIMIT = 400  # [steps] for the fingers to stop: damped ones creep over thin objects
OPEN_LIMIT = 250  # [steps] for them to open: thrice the damping makes them lag by 0.6 s
CLOSED = 0.3  # commanded opening; hands that are made slim for a purpose stay wider
OPENED = 0.05  # of the stroke that may be missing
STOPPED = 0.003  # [m/s] a finger slower than this has stopped
CALM = 0.1  # [rad/s] a load that turns slower hangs still
CALM_LIMIT = 125  # [steps]
SAGGED, SHIFTED = 0.1, 0.01  # [rad], [m] of a load in its hand that planning must know of
PAUSE = 5  # [steps] between two looks at what should come to rest
FEEL_STEPS = 12  # contact may flicker for a few steps
PATCH = 0.015  # [m] arm with which friction on a pad resists turning


class Hands:
    """Both grippers of one rollout and the props that they hold."""

    def __init__(self, rollout: Rollout, planner: DualArmPlanner) -> None:
        self.rollout, self.planner = rollout, planner
        self.world, self.scene = rollout.world, rollout.scene
        # Side -> prop. Not a set of props: the order of a set differs between processes.
        self.holding: dict[str, str] = {}
        self.grasped: dict[str, Pose] = {}  # side -> the load in the commanded ee's frame, at first
        self.belief = self.scene.physics  # what it takes the physics to be
        self.care = 1.0  # share of the usual pace, for a load that has slipped before
        self._known: dict[str, Pose] = {}  # as `grasped`, where the planner has the load

    # ---- fingers ---------------------------------------------------------------------------------

    def ramp(self, side: str, opening: float) -> Array:
        """Commands (n,) from the present one to `opening`."""
        now = self.world.robot.arm(side).gripper
        seconds = max(STROKE_TIME * abs(opening - now), 0.02)
        return stroke(now, opening, seconds)

    def closed(self, side: str, grip: Grip) -> None:
        """Take note of what a gripper motion has taken or released.

        Raises:
            Infeasible: "grasp_missed".
        """
        arm, other = self.world.robot.arm(side), "right" if side == "left" else "left"
        load = self.holding.get(side)
        if load and (grip.releases == load or grip.opening > 0.5):
            del self.holding[side], self.grasped[side]
            self._known.pop(side, None)
            self.planner.checker.detach(side)
            if self.holding.get(other) == load:
                self.planner.checker.detach(other)
                self._attach(other)
        if grip.holds or grip.opening < 0.5:
            # From places, not from the solver's speeds: on a load that is pressed from both sides
            # those never fall to zero, though nothing moves.
            def fingers() -> Array:
                return np.array(self.world.robot.articulation.qpos, float)[arm.finger_index]

            def stopped(before: Array, now: Array) -> bool:
                return bool(np.abs(now - before).max() < STOPPED * PAUSE * TIME_STEP)

            self._wait_until_still(fingers, stopped, GRIP_LIMIT)
        else:
            for _ in range(OPEN_LIMIT):
                if arm.opening() > grip.opening - OPENED:
                    break
                self.rollout.tick()
        if grip.holds:
            if not self.presses(side, grip.holds):
                raise Infeasible("grasp_missed", f"{grip.holds} is not between the fingers")
            self.holding[side] = grip.holds
            self.grasped[side] = self._in_hand(side)
            if self.holding.get(other) != grip.holds:  # a load of both moves with the first hand
                self._attach(side)
        self.planner.fingers[side] = float(np.clip(arm.gap() / 2, 0.0, arm.limb.hand.finger_travel))

    def _wait_until_still(
        self, look: Callable[[], Array], still: Callable[[Array, Array], bool], limit: int
    ) -> None:
        """Wait until two looks, PAUSE apart, show no motion; at most `limit` steps."""
        before = look()
        for _ in range(0, limit, PAUSE):
            for _ in range(PAUSE):
                self.rollout.tick()
            now = look()
            if still(before, now):
                return
            before = now

    def _attach(self, side: str) -> None:
        """Show the planner a hand's load as it is there now."""
        prop = self.holding[side]
        self._known[side] = self._in_hand(side)
        scene_object = self.world.object(prop)
        ee = self.planner.kinematics[side].ee_pose(self.world.robot.arm(side).target)
        for link, parts in scene_object.parts.items():
            X_EL = ee.inverse() @ scene_object.link_pose(link)
            for part in parts:
                self.planner.checker.attach(side, prop, X_EL @ part)

    # ---- feeling ---------------------------------------------------------------------------------

    def presses(self, side: str, prop: str) -> bool:
        """Whether the gripper, or its load, presses on a prop in this step."""
        if self.scene.touching(f"{side}_gripper", prop):
            return True
        load = self.holding.get(side)
        return load is not None and load != prop and self.scene.touching(load, prop)

    def lost(self, side: str) -> bool:
        """Whether the hand's load is gone, or the hand has just closed on nothing."""
        prop = self.holding.get(side)
        if prop is None:
            return self.world.robot.arm(side).gripper < CLOSED
        return not self.scene.touching(f"{side}_gripper", prop)

    def still_held(self) -> None:
        """Check that every load is still in its hand; wait until it has stopped swinging there.

        The planner is shown a load that turned in its hand as it hangs there now.

        Raises:
            Infeasible: "slipped".
        """
        for side, prop in self.holding.items():
            for _ in range(FEEL_STEPS):
                if self.scene.touching(f"{side}_gripper", prop):
                    break
                self.rollout.tick()
            else:
                raise Infeasible("slipped", f"{prop} left the {side} hand")
        for prop in dict.fromkeys(self.holding.values()):
            self._wait_for_calm(prop)
        for side, then in list(self._known.items()):
            now = self._in_hand(side)
            if now.angle_to(then) > SAGGED or np.linalg.norm(now.p - then.p) > SHIFTED:
                self.planner.checker.detach(side)
                self._attach(side)

    def _wait_for_calm(self, prop: str) -> None:
        scene_object = self.world.object(prop)

        def turns() -> Array:
            return np.array([scene_object.link_pose(link).q for link in scene_object.links], float)

        def calm(before: Array, now: Array) -> bool:
            # Half an angle is the length of its quaternion difference, either sign.
            change = np.minimum(
                np.linalg.norm(now - before, axis=1), np.linalg.norm(now + before, axis=1)
            )
            return bool(2 * change.max(initial=0.0) < CALM * PAUSE * TIME_STEP)

        self._wait_until_still(turns, calm, CALM_LIMIT)

    def turned(self, side: str) -> float:
        """How far the load has turned in the hand since that closed [rad]."""
        if side not in self.grasped:
            return 0.0
        return self._in_hand(side).angle_to(self.grasped[side])

    def _in_hand(self, side: str) -> Pose:
        """Frame of the load in the commanded ee's."""
        ee = self.planner.kinematics[side].ee_pose(self.world.robot.arm(side).target)
        return ee.inverse() @ self.world.object(self.holding[side]).pose

    def pace(self) -> float:
        """Share of the usual speed that the loads allow: full from a margin of 5 on, then less."""
        margins = [self._margin(prop) for prop in dict.fromkeys(self.holding.values())]
        paces = (float(np.interp(margin, [1.2, 5.0], [0.35, 1.0])) for margin in margins)
        return self.care * min(paces, default=1.0)

    def _margin(self, prop: str) -> float:
        """How many times its weight (in one hand also its turning moment) the grip could bear.

        Where the belief is the truth, what it adds is 0, and its factor 1, to the last bit.
        """
        true, taken = (
            (p.scalar(p.key_of("object_mass", prop)), p.scalar(p.key_of("friction", prop)),
             np.array(p.vector(p.key_of("center_of_mass", prop))))
            for p in (self.scene.physics, self.belief)
        )  # fmt: skip
        bodies = list(self.world.object(prop).bodies)
        weight = max(total(body.mass for body in bodies) * GRAVITY, 1e-6)
        weight *= taken[0] / true[0]
        pad = min((m[0] for pad in self.world.robot.pads for m in pad.materials()), default=0.5)
        own = (m[0] for surface in self.world.object(prop).surfaces for m in surface.materials())
        mu = (pad + min(own, default=pad)) / 2 + (taken[1] - true[1])  # PhysX takes the mean
        arms = [self.world.robot.arm(side) for side in SIDES if self.holding.get(side) == prop]
        friction = total(2 * mu * grip_force(arm.gap(), arm.limb) for arm in arms)
        margin = friction / weight
        if len(arms) == 1:
            masses = np.array([body.mass for body in bodies])
            shift = taken[2] - true[2]
            points = [from_sapien(b.component.entity_pose) @ (b.com + shift) for b in bodies]
            centre = masses @ np.array(points) / masses.sum()  # (3,) world frame [m]
            offset = centre - arms[0].tcp().p
            lever = float(np.hypot(offset[0], offset[1]))
            margin = min(margin, friction * PATCH / (weight * max(lever, 1e-3)))
        return margin


def grip_force(gap: float, limb: Limb) -> float:
    """Normal force of one finger on a load that keeps the pads `gap` [m] apart [N]."""
    # A closed command lies past the middle, so an empty hand still presses.
    closed = limb.finger_signs[0] * limb.gripper_scale[0]
    return limb.gripper_drive.stiffness * (gap / 2 - closed)
