"""Observations in the format of RoboTwin's `get_obs`: nested dicts, plain lists, RGB pictures."""

from rtphys.assets.action_layout import SIDES
from rtphys.episode import Observation
from rtphys.sim.camera import SHORT

Robotwin = dict[str, object]


def official(now: Observation, pictures: bool = True) -> Robotwin:
    """Convert an observation to RoboTwin's `observation`, `pointcloud`, `joint_action`, `endpose`.

    Joint actions are drive targets, grippers 0 closed .. 1 open. End poses are lists, xyz [m] +
    wxyz in the world frame: adapters concatenate them with `+`.

    Args:
        pictures: False leaves `observation` empty and draws nothing.
    """
    views = now.cameras if pictures else {}
    cameras = {SHORT[name]: vars(view).copy() for name, view in views.items()}
    joints: Robotwin = {}
    ends: Robotwin = {}
    for side, part in zip(SIDES, now.embodiment.action_layout.sides, strict=True):
        *arm, gripper = now.vector[part].tolist()
        joints[f"{side}_arm"], joints[f"{side}_gripper"] = arm, gripper
        ends[f"{side}_endpose"], ends[f"{side}_gripper"] = now.endposes[side].tolist(), gripper
    return {
        "observation": cameras,
        "pointcloud": [],
        "joint_action": {**joints, "vector": now.vector.copy()},
        "endpose": ends,
    }
