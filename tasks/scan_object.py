"""One hand holds a tea box, the other points the scanner at its bottom from close range.

Success: both are in their hands, off the table, and the beam meets the code in the middle of the
box's bottom from less than 7 cm. Upstream counts closed hands without anything in them.
"""

import numpy as np

from rtphys.task import (
    UP_F,
    UP_Y,
    Draw,
    Infeasible,
    Mesh,
    Pose,
    Robot,
    Scene,
    Task,
    axis_angle,
    condition,
    free_of,
    quat_multiply,
)

RANGE = 0.045  # [m] from the scanner's window to the code
FAR = RANGE + 0.06  # [m] from where it approaches
LEAN = 0.35  # [rad] by which the beam may be askew where it cannot be square; 0.64 is allowed
SQUARE = axis_angle((1, 0, 0), -np.pi / 2)  # the beam (z) along the box's y
MISS = 0.025  # [m] along each axis


def layout(draw: Draw):
    side = draw.choice("side", -1, 1)  # of the scanner
    near, far = (0.05, 0.25), (-0.25, -0.05)
    spot = draw.spot("scanner", x=near if side > 0 else far, y=(-0.15, -0.05), yaw=(-1.2, 1.2))
    model = draw.choice("scanner model", *range(5))
    yield Mesh(name="scanner", category="024_scanner", model=model, pose=spot.pose(UP_F))
    spot = draw.spot("box", x=far if side > 0 else near, y=(-0.2, 0.0), yaw=(-1.2, 1.2))
    model = draw.choice("box model", *range(6))
    yield Mesh(name="box", category="112_tea-box", model=model, pose=spot.pose(UP_Y))


def beam_meets_code(scene: Scene) -> bool:
    window, code = scene.functional("scanner", 0), scene.pose("box").p
    ahead = float((code - window.p) @ window.R[:, 2])
    miss = np.abs(window.p + ahead * window.R[:, 2] - code)
    facing = float(window.R[:, 2] @ scene.pose("box").R[:, 1])
    return bool(0 < ahead < 0.07 and miss.max() < MISS and facing > 0.8)


def both_held(scene: Scene) -> bool:
    hands = [{t for t in ("scanner", "box") if scene.touching(f"{s}_gripper", t)}
             for s in ("left", "right")]  # fmt: skip
    return {"scanner"} in hands and {"box"} in hands


def turned_box(scene: Scene, side: float) -> list[list[Pose]]:
    """Box poses over the middle, its bottom towards the other hand; `side` is where it is held."""
    box = scene.pose("box")
    found = []
    for x, z in ((0.04, 0.93), (0.08, 0.95), (0.0, 0.9)):
        for lean in (0.0, 0.3, 0.6):
            for roll in (0.0, 0.7, -0.7, 1.57, -1.57):
                up = np.array([side * np.cos(lean), -np.sin(lean), 0.0])
                turn = axis_angle(np.cross((0, 0, 1), up), np.arccos(np.clip(up[2], -1, 1)))
                q = quat_multiply(axis_angle(up, roll), quat_multiply(turn, box.q))
                found.append([Pose((x * side, -0.13, z), q)])
    return found


def aimed(scene: Scene) -> list[list[Pose]]:
    """Scanner poses with the beam square to the box's bottom, then ever more askew."""
    box, window = scene.pose("box"), scene.functional("scanner", 0)
    X_WS = window.inverse() @ scene.pose("scanner")
    found = []
    for lean, turns in ((0.0, 16), (LEAN, 8)):
        for towards in np.linspace(0, 2 * np.pi, 4, endpoint=False) if lean else (0.0,):
            q = quat_multiply(axis_angle((np.cos(towards), 0, np.sin(towards)), lean), SQUARE)
            beam = (Pose((0, 0, 0), box.q) @ Pose((0, 0, 0), q)).R[:, 2]
            for turn in np.linspace(0, 2 * np.pi, turns, endpoint=False):
                facing = quat_multiply(axis_angle(beam, turn), quat_multiply(box.q, q))
                near, far = (Pose(box.p - d * beam, facing) @ X_WS for d in (RANGE, FAR))
                found.append([far, near])
    return found


def script(robot: Robot) -> None:
    reader, holder = robot.nearest("scanner"), robot.nearest("box")
    side = 1.0 if holder.side == "right" else -1.0
    robot.do(reader.grasp("scanner", pre=0.08), holder.grasp("box", (0, 1, 2, 3), pre=0.08))
    robot.do(reader.lift(0.13), holder.lift(0.13))
    robot.do(holder.carry("box", *turned_box(robot.scene, side)))
    robot.do(reader.carry("scanner", *aimed(robot.scene)))
    if not beam_meets_code(robot.scene):  # what was held sagged: once more
        robot.do(reader.carry("scanner", *aimed(robot.scene)))
    if not both_held(robot.scene):
        raise Infeasible("slipped", "a hand is empty")


task = Task(
    layout=layout,
    script=script,
    success=condition("the beam meets the code", beam_meets_code)
    & condition("scanner and box are each in a hand", both_held)
    & free_of("scanner", "table")
    & free_of("box", "table"),
    step_limit=500,
    arms="dual",
    mechanism="tool: aim",
    info={"A": "box", "B": "scanner", "a": "arm:box", "b": "arm:scanner"},
)
