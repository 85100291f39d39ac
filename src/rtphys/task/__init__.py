"""Everything a task file may import."""

from rtphys.errors import Infeasible
from rtphys.poses import Pose, axis_angle, quat_multiply
from rtphys.task.arm import Aim, Arm, Motion, Placing, Robot
from rtphys.task.draw import Draw, Spot, clear_of, off_centre, reachable
from rtphys.task.orientation import DOWN, IDENTITY, UP_F, UP_S, UP_Y, UP_Z, yawed
from rtphys.task.props import (
    BLUE,
    COLOURS,
    GREEN,
    RED,
    SHORT_COLOURS,
    TABLE_TOP,
    Articulated,
    Ball,
    Box,
    Mesh,
    Prop,
)
from rtphys.task.scene import LEFT, RIGHT, Scene
from rtphys.task.spec import Phrases, Task, load_task, task_names
from rtphys.task.success import (
    Condition,
    above,
    at_rest,
    claim,
    free_of,
    hands_open,
    held_by,
    joint_beyond,
    lifted,
    near,
    opened,
    points_meet,
    pressed,
    touching,
    turned_to,
    upright,
)

__all__ = [
    "BLUE", "COLOURS", "DOWN", "GREEN", "IDENTITY", "LEFT", "RED", "RIGHT", "SHORT_COLOURS",
    "TABLE_TOP", "UP_F", "UP_S", "UP_Y", "UP_Z", "Aim", "Arm", "Articulated", "Ball", "Box",
    "Condition", "Draw", "Infeasible", "Mesh", "Motion", "Phrases", "Placing", "Pose", "Prop", "Robot",
    "Scene", "Spot", "Task", "above", "at_rest", "axis_angle", "claim", "clear_of", "free_of", "hands_open",
    "held_by", "joint_beyond", "lifted", "load_task", "near", "off_centre", "opened",
    "points_meet", "pressed", "quat_multiply", "reachable", "task_names", "touching", "turned_to",
    "upright", "yawed",
]  # fmt: skip
