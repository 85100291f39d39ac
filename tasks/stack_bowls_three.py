"""Nest three bowls in the middle of the table.

Success: each further bowl rests centred in the one below, a nest's height above it, the first on
the table, and both hands are open. Upstream bounds heights from above only and asks for no rest.
"""

import numpy as np

from rtphys.task import (
    DOWN,
    UP_Y,
    Aim,
    Draw,
    Mesh,
    Placing,
    Pose,
    Robot,
    Spot,
    Task,
    at_rest,
    clear_of,
    hands_open,
    near,
    off_centre,
    on_table,
    reachable,
)

CENTRE = (0.0, -0.1)
NEST = 0.035  # [m] between the bowls' feet, at most 2 cm off
NESTED = {"within": (0.04, 0.04, 0.02), "offset": (0, 0, NEST)}
OUTER = {"left": (2, 3), "right": (0, 1)}  # the rim on the arm's own side
INTO = Placing(mode="free", pre=0.09, gap=0.005, along="point")


def layout(draw: Draw):
    taken: list[tuple[Spot | tuple[float, float], float]] = [(CENTRE, 0.13)]
    spots: list[Spot] = []
    for number in (1, 2, 3):
        free = clear_of(*taken)

        def room(spot: Spot, free=free) -> bool:
            return off_centre(0.09)(spot) and reachable(spot) and free(spot)

        spot = draw.spot(f"bowl{number}", x=(-0.3, 0.3), y=(-0.15, 0.15), where=room)
        spots.append(spot)
        taken.append((spot, 0.14))
    for number, spot in enumerate(sorted(spots, key=lambda s: s.y), 1):
        yield Mesh(name=f"bowl{number}", category="002_bowl", model=3, pose=spot.pose(UP_Y))


def script(robot: Robot) -> None:
    target, last = Pose((*CENTRE, 0.74), DOWN), None
    for name in ("bowl1", "bowl2", "bowl3"):
        arm = robot.nearest(name)
        away = [last.home()] if last and last is not arm else []
        robot.do(arm.grasp(name, OUTER[arm.side], pre=0.1, aim=Aim(target, 0, INTO)), *away)
        robot.do(arm.lift(0.1))
        robot.do(arm.place(name, target, point=0, how=INTO))
        robot.do(arm.lift(0.09))
        target, last = Pose(robot.scene.pose(name).p + np.array([0, 0, NEST]), DOWN), arm


task = Task(
    layout=layout,
    script=script,
    success=near("bowl2", "bowl1", **NESTED)
    & near("bowl3", "bowl2", **NESTED)
    & on_table("bowl1")
    & at_rest("bowl3")
    & hands_open(),
    step_limit=1200,
    mechanism="nest",
    info={"A": "bowl1"},
)
