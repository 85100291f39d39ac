"""One arm: forward kinematics, inverse kinematics, straight tool lines; and both of a robot."""

from functools import lru_cache
from math import sqrt
from pathlib import Path

import numpy as np
import pinocchio as pin  # pyright: ignore[reportMissingImports]  (lives behind a .pth file)
from scipy.linalg import get_lapack_funcs

from rtphys.assets.embodiment import Embodiment, Limb
from rtphys.assets.pack import Pack
from rtphys.core.errors import BadFile, UnknownName
from rtphys.core.poses import Array, Pose
from rtphys.core.seeds import stream

(_SOLVE_POSITIVE,) = get_lapack_funcs(("posv",))

POSITION_TOLERANCE, ANGLE_TOLERANCE = 1e-4, 1e-3  # [m], [rad] at which a goal is reached
_ITERATIONS = 48  # a solve that succeeds takes 4 to 12
_PATIENCE = 4  # iterations allowed without a 20 % better error
_LARGEST_STEP = 0.7  # [rad] a joint per iteration; the model is linear only near by
_ATLAS = 2000  # postures whose tool pose is known beforehand
_ATLAS_LENGTH = 0.15  # [m] that count as much as a radian
_SAME_BRANCH = 1.0  # weighted distance below which no other branch can be nearer
_RESTARTS = 8  # postures from the atlas to start from; half as many are random
_LARGEST_JUMP = 0.35  # [rad] between neighbours of a line; more is another branch
_LINE_STEP, _ANGLE_STEP = 0.01, 0.05  # [m], [rad] between neighbours of a line
_LEAN = 0.1  # [rad] a joint per iteration, towards the bent posture, of an arm with joints to spare


@lru_cache(maxsize=8)
def _model(urdf: Path) -> pin.Model:
    try:
        return pin.buildModelFromUrdf(str(urdf))
    except (ValueError, RuntimeError) as error:
        raise BadFile(urdf, f"no readable URDF: {error}") from error


def ee_frame(model: pin.Model, limb: Limb) -> int:
    """The frame of an arm's end effector in a model; it is added where it is no link's own."""
    frame = model.getFrameId(limb.ee.link)
    if limb.ee.offset is None:
        return frame
    name, offset, host = f"{limb.side} ee", limb.ee.offset, model.frames[frame]
    if not model.existFrame(name):
        placement = host.placement * pin.SE3(offset.R, offset.p)
        kind = pin.FrameType.OP_FRAME
        model.addFrame(pin.Frame(name, host.parentJoint, frame, placement, kind))
    return model.getFrameId(name)


class ArmKinematics:
    """Kinematics of one arm in the world frame.

    `q` is always (n,) in radians, one number for each of the limb's n joints. The end-effector
    frame is its `ee`, whose x is the approach and whose y the closing direction.
    """

    def __init__(self, urdf: Path, limb: Limb, X_WB: Pose) -> None:
        """Read one arm from a URDF of any size; all other joints are locked at zero.

        The limits are the limb's. The file's own are not used: the official model states ±10 rad,
        which invites solutions wound round by 2 pi.

        Args:
            urdf: file; parsed once per process.
            limb: the arm; its joints form a serial chain, base first.
            X_WB: pose of the URDF's root link in the world.

        Raises:
            BadFile: no URDF, or the joints are no chain.
            UnknownName: a joint or link that the URDF lacks.
        """
        full = _model(urdf)
        for name in limb.joints:
            if not full.existJointName(name):
                raise UnknownName("joint", name, list(full.names)[1:], urdf)
        locked = [i for i, name in enumerate(full.names) if i > 0 and name not in limb.joints]
        self._model = model = pin.buildReducedModel(full, locked, pin.neutral(full))
        if list(model.names)[1:] != list(limb.joints):
            raise BadFile(urdf, f"joints {list(limb.joints)} are no serial chain in this order")
        # The world placement goes into the first joint: free at run time.
        model.jointPlacements[1] = pin.SE3(X_WB.R, X_WB.p) * model.jointPlacements[1]
        if not model.existBodyName(limb.ee.link):
            links = [frame.name for frame in model.frames if frame.type == pin.FrameType.BODY]
            raise UnknownName("link", limb.ee.link, links, urdf)

        self._frame = ee_frame(model, limb)
        self._data = model.createData()
        self._X_JE = pin.SE3(model.frames[self._frame].placement)
        self._joint = model.frames[self._frame].parentJoint
        self._bent, self._weights = limb.bent, limb.weights
        self._redundant = model.nq > 6
        self.limits = np.array(limb.limits, float)
        self.limits.setflags(write=False)
        self._low, self._high = self.limits[:, 0].copy(), self.limits[:, 1].copy()
        self._ranges = self.limits.tolist()  # plain floats: at this size they beat arrays
        self._atlas = stream(0, "kinematics").uniform(self._low, self._high, (_ATLAS, model.nq))
        poses = np.array([self.ee_matrix(q) for q in self._atlas])
        self._atlas_p, self._atlas_R = poses[:, :3, 3], poses[:, :3, :3].reshape(-1, 9)

    def _forward(self, q: Array) -> pin.SE3:
        pin.forwardKinematics(self._model, self._data, q)
        return self._data.oMi[self._joint] * self._X_JE

    def ee_pose(self, q: Array) -> Pose:
        """World pose of the end-effector frame at q (n,)."""
        return Pose.from_matrix(self.ee_matrix(q))

    def ee_matrix(self, q: Array) -> Array:
        """World pose of the end-effector frame at q (n,) as a (4, 4) matrix."""
        return self._forward(np.asarray(q, float)).homogeneous

    def tool_points(self, tcp: float) -> Array:
        """Points (k, 3) that the TCP, `tcp` ahead of the ee, has in the postures of the atlas."""
        return self._atlas_p + tcp * self._atlas_R[:, 0::3]

    def wrench(self, q: Array, efforts: Array, point: Array) -> Array:
        """(6,) force [N] and moment [N m] about a point that things exert on the end effector.

        Args:
            q: (n,) posture at rest.
            efforts: (n,) what the joints exert [N m]; the arm itself weighs nothing.
            point: (3,) [m] in the end-effector frame.

        World axes. It is the least one that explains the efforts.
        """
        pin.computeJointJacobians(self._model, self._data, q)
        X_WE = pin.updateFramePlacement(self._model, self._data, self._frame)
        axes = pin.LOCAL_WORLD_ALIGNED
        J = pin.getFrameJacobian(self._model, self._data, self._frame, axes)
        J[:3] -= np.cross(X_WE.rotation @ point, J[3:], axisb=0, axisc=0)
        return np.linalg.lstsq(J.T, -efforts, rcond=None)[0]

    def _descend(
        self,
        goal: pin.SE3,
        seed: Array,
        position_tolerance: float = POSITION_TOLERANCE,
        angle_tolerance: float = ANGLE_TOLERANCE,
    ) -> Array | None:
        """Damped least squares from one seed on the local 6-vector error, clamped to the limits.

        The damping is proportional to the squared error (Sugihara 2011): cautious far away and at
        singularities, Gauss-Newton close by.
        """
        q = np.minimum(np.maximum(seed, self._low), self._high)
        best, patience = np.inf, _PATIENCE
        small_p, small_r = position_tolerance**2, angle_tolerance**2
        clamped = True
        for _ in range(_ITERATIONS):
            # Not computeFrameJacobian: that one leaves the joints' placements as they were.
            pin.computeJointJacobians(self._model, self._data, q)
            X_WE = pin.updateFramePlacement(self._model, self._data, self._frame)
            e = pin.log6(X_WE.actInv(goal)).vector
            p, r = e[:3], e[3:]
            position, angle = float(p.dot(p)), float(r.dot(r))
            if position < small_p and angle < small_r:
                return q
            error = position + angle
            if error < 0.8 * best:
                best, patience = error, _PATIENCE
            else:
                patience -= 1
                if patience == 0:
                    return None
            moved = q + self._step(q, e, error, clamped)
            q = np.minimum(np.maximum(moved, self._low), self._high)
            clamped = q.tolist() != moved.tolist()
        return None

    def _step(self, q: Array, e: Array, error: float, clamped: bool) -> Array:
        """The next step (n,) of `_descend` from where its Jacobian was computed."""
        J = pin.getFrameJacobian(self._model, self._data, self._frame, pin.LOCAL)
        push = e.dot(J)
        if clamped:
            # A joint pressed against its limit must not spend the step: let others move.
            for i, (at, towards) in enumerate(zip(q.tolist(), push.tolist(), strict=True)):
                low, high = self._ranges[i]
                if (at <= low and towards < 0) or (at >= high and towards > 0):
                    J[:, i] = push[i] = 0
        H = J.T.dot(J)
        diagonal = H.reshape(-1)[:: len(H) + 1]
        damping = 0.02 * error + 1e-6
        diagonal += damping
        if self._redundant:
            # H⁻¹ damping is the projection onto what moves the joints but not the tool.
            lean = np.minimum(np.maximum(self._bent - q, -_LEAN), _LEAN) * J.any(axis=0)
            push = push + damping * lean
        step = _SOLVE_POSITIVE(H, push)[1]
        size = max(map(abs, step.tolist()))
        return step if size <= _LARGEST_STEP else step * (_LARGEST_STEP / size)

    def solve_near(self, X_WE: Pose, q_near: Array, rng: np.random.Generator) -> Array | None:
        """The solution (n,) within the limits nearest to q_near (n,) among several searches.

        Searches start at q_near, at the limb's bent posture and at the postures of a fixed atlas
        whose tool is nearest to the goal; random postures are tried last, if nothing was found. Of
        1000 poses that the aloha's arms do reach, 99.8 % are found this way, 97 % by as many random
        restarts. The generator always advances by the same number of draws.

        Args:
            X_WE: wanted world pose of the end-effector frame.
            rng: source of the random postures.
        """
        near = np.asarray(q_near, float)
        random = rng.uniform(self._low, self._high, (_RESTARTS // 2, len(self._low)))
        goal = pin.SE3(X_WE.R, X_WE.p)
        nearest, least = None, np.inf
        for seed in (near, self._bent, *self._atlas_near(X_WE)):
            q = self._descend(goal, seed)
            if q is None:
                continue
            offset = (q - near) * self._weights
            distance = sqrt(offset.dot(offset))
            if distance < _SAME_BRANCH:
                return q
            if distance < least:
                nearest, least = q, distance
        if nearest is None:
            found = (self._descend(goal, seed) for seed in random)
            nearest = next((q for q in found if q is not None), None)
        return nearest

    def _atlas_near(self, X_WE: Pose) -> Array:
        """The few postures (k, n) of the atlas whose tool pose is nearest."""
        offset = self._atlas_p - X_WE.p
        # 3 - trace(R_a^T R_b) is 2 (1 - cos of the angle between).
        turn = 3 - self._atlas_R @ X_WE.R.reshape(9)
        cost = np.einsum("kd,kd->k", offset, offset) / _ATLAS_LENGTH**2 + turn
        few = np.flatnonzero(cost <= np.partition(cost, _RESTARTS - 1)[_RESTARTS - 1])
        return self._atlas[few[np.argsort(cost[few], kind="stable")[:_RESTARTS]]]

    def line(self, q_start: Array, X_goal: Pose) -> Array | None:
        """A straight line of the tool from its pose at q_start (n,) to the world pose X_goal.

        Position moves linearly, orientation turns at a constant rate; neighbours are at most 1 cm
        and 0.05 rad apart.

        Returns:
            (k, n) postures, the first equal to q_start, or None when the line leaves the reach or
            would have to change branch.
        """
        q = np.asarray(q_start, float)
        X_start = self._forward(q)
        R, start, end = X_start.rotation.copy(), X_start.translation.copy(), X_goal.p
        turn = pin.log3(R.T @ X_goal.R)
        distance, angle = float(np.linalg.norm(end - start)), float(np.linalg.norm(turn))
        n = max(int(np.ceil(max(distance / _LINE_STEP, angle / _ANGLE_STEP) - 1e-9)), 1)
        path, previous = [q], q
        for s in np.linspace(0, 1, n + 1)[1:]:
            p = (1 - s) * start + s * end
            X_WE = pin.SE3(R @ pin.exp3(s * turn), p)
            guess = 2 * q - previous if len(path) > 1 else q
            q_next = self._descend(X_WE, guess, 2e-5, 2e-4)
            if q_next is None or np.abs(q_next - q).max() > _LARGEST_JUMP:
                return None
            previous, q = q, q_next
            path.append(q)
        return np.array(path)


# ---- both arms of a robot ------------------------------------------------------------------------


@lru_cache(maxsize=4)
def arm_kinematics(embodiment: Embodiment) -> dict[str, ArmKinematics]:
    """Side -> kinematics, world frame.

    Raises:
        BadFile, UnknownName: the URDF does not hold the arms that the embodiment names.
    """
    urdf, base = embodiment.urdf, embodiment.base
    return {limb.side: ArmKinematics(urdf, limb, base) for limb in embodiment.limbs}


# Where tasks put things, with room above: x, y, z from and to [m], world.
WORKSPACE = np.array([[-0.4, 0.4], [-0.3, 0.25], [0.75, 1.1]])
MIN_REACH = 5  # of the 2000 postures of an arm's atlas that must end there


def check_robot(pack: Pack, name: str) -> Embodiment:
    """The robot of this name, once it is sure that episodes can be tried with it.

    Raises:
        UnknownName, BadValue, MissingAsset, BadFile: as `Pack.embodiment`; an arm reaches nothing
            on the table.
    """
    robot = pack.embodiment(name)
    for limb in robot.limbs:
        low, high = WORKSPACE.T
        tools = arm_kinematics(robot)[limb.side].tool_points(limb.hand.tcp)
        there = ((low < tools) & (tools < high)).all(axis=1).sum()
        if there < MIN_REACH:
            at = np.round(robot.base.p, 3).tolist()
            problem = f"the {limb.side} arm reaches nothing on the table; see `robot_pose`"
            raise BadFile(robot.urdf, f"{problem} of {name!r} (root at {at})")
    return robot
