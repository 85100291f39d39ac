"""Records a row every 15 steps: commands, measurements, packed poses; and hashes the states."""

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from rtphys.assets.action_layout import ActionLayout
from rtphys.core.poses import Array
from rtphys.physics.handles import Happened
from rtphys.sim.contacts import Contacts
from rtphys.sim.engine import TIME_STEP
from rtphys.sim.strain import Strain
from rtphys.sim.touch import TouchRecorder, TouchTrack
from rtphys.sim.world import World

RECOVER = "recover"  # how the names of stages begin that follow the loss of a load
FRAME_STEPS = 15  # RoboTwin's save_freq: 60 ms, 16.67 Hz


@dataclass
class Row:
    """One instant. Poses are world frame, xyz [m] + wxyz."""

    time: float  # [s]
    stage: int
    arms: Array  # commands of both arms, see `Recording.layout`
    ee: Array  # (2, 7) measured end-effector poses, left and right
    qpos: Array  # (n,)
    qvel: Array  # (n,)
    effort: Array  # (n,) measured, `SimRobot.effort`
    objects: dict[str, Array]  # name -> (7,)
    touched: dict[str, tuple[bool, bool]]  # name -> by the left, by the right gripper
    packed: bytes  # scene.pack_poses(): all that a picture needs


@dataclass
class Recording:
    """Rows of one episode, in order, and the names of its stages."""

    joint_names: tuple[str, ...]
    layout: ActionLayout  # of the rows' commands
    rows: list[Row] = field(default_factory=list)
    stages: list[str] = field(default_factory=list)
    hash: str = ""  # SHA-256 over the state vectors of all rows
    strain: Strain = field(default_factory=Strain)
    happened: Happened | None = None  # if somebody asked
    touch: TouchTrack | None = None  # a row each, if it was asked for

    @property
    def recovered(self) -> bool:
        """Whether a load was lost and taken again."""
        return any(stage.startswith(RECOVER) for stage in self.stages)


class Recorder:
    """Takes a row at the start of the policy stage and every 15 steps after it."""

    def __init__(
        self,
        world: World,
        contacts: Contacts,
        friction: Mapping[str, float] | None = None,
        all_rows: bool = True,
    ) -> None:
        """Takes the first row.

        Args:
            friction: as `TouchTrack` has it; None: nobody asked what the fingers feel.
            all_rows: false: rows after the first are hashed alone, at a tenth of the cost.
        """
        self._world, self._contacts, self._all_rows = world, contacts, all_rows
        self.touch = None if friction is None else TouchRecorder(world, contacts, friction)
        self._digest = hashlib.sha256()
        art = world.robot.articulation
        names = tuple(j.name for j in art.active_joints)
        self.recording = Recording(names, world.robot.embodiment.action_layout)
        self.recording.touch = self.touch and self.touch.track
        self.enter("start")
        self.record(0)

    def enter(self, stage: str) -> None:
        """Name the stage that following rows belong to."""
        stages = self.recording.stages
        if not stages or stages[-1] != stage:
            stages.append(stage)

    def keep_rows(self) -> None:
        """From now on keep all rows, not their hash alone."""
        self._all_rows = True

    def tick(self, step: int) -> None:
        """After every physics step of the policy stage; `step` counts from 1."""
        if self.touch is not None:
            self.touch.step()
        if step % FRAME_STEPS == 0:
            self.record(step)

    def record(self, step: int) -> None:
        if self.touch is not None:
            self.touch.frame()  # before the row, which takes what is pressed from it
        if self._all_rows or not self.recording.rows:
            self.recording.rows.append(self._row(step))
        self._digest.update(self._world.state().tobytes())
        self.recording.hash = self._digest.hexdigest()

    def _row(self, step: int) -> Row:
        world, pressing = self._world, (self.touch or self._contacts).pressing
        robot, art = world.robot, world.robot.articulation
        return Row(
            time=step * TIME_STEP,
            stage=len(self.recording.stages) - 1,
            arms=np.array([value for arm in robot.arms for value in arm.commanded], float),
            ee=np.array([arm.ee().flat for arm in robot.arms]),
            qpos=np.array(art.qpos, float),
            qvel=np.array(art.qvel, float),
            effort=robot.effort(),
            objects={o.name: o.pose.flat for o in world.scene_objects.values()},
            touched={
                name: (pressing("left_gripper", name), pressing("right_gripper", name))
                for name in world.scene_objects
            },
            packed=world.scene.pack_poses(),
        )
