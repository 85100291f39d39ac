"""The big dustbin that stands on the ground to the left of the table."""

from collections.abc import Sequence

from rtphys.task import UP_Y, Mesh, Pose, Robot, Scene

BESIDE = 0.22  # [m] from its middle to the edge of the table's slab: half its rim, and 1.5 mm
EDGE = -0.3  # [m] x of that edge, in both tasks
DUSTBIN = Mesh(
    name="dustbin",
    category="011_dustbin",
    model=0,
    pose=Pose((EDGE - BESIDE, 0.0, 0.0), UP_Y),  # a world pose, whatever the table does
    fixed=True,
    on_table=False,
    anchor=(0.0, 0.0, BESIDE),  # however large it is, it stands beside the slab
    catches=True,
)
HALF_LENGTH, HALF_WIDTH, RIM = 0.325, 0.221, 0.74  # [m] between its walls; height above its foot
PAUSES = 6  # at most, until what fell into it lies still


def in_dustbin(
    scene: Scene, props: Sequence[str], heights: tuple[float, float], scale: float = 1.0
) -> bool:
    """Whether the origin of every prop is between the walls, at heights [m] above the ground.

    Args:
        scale: of the bin, with which all bounds shrink.
    """
    X_BT = scene.pose("dustbin").inverse()
    low, high = heights
    for prop in props:
        along, height, across = (X_BT @ scene.pose(prop)).p / scale
        if not (abs(along) < HALF_LENGTH and abs(across) < HALF_WIDTH and low < height < high):
            return False
    return True


def wait_for_rest(robot: Robot, props: Sequence[str], pause: float, slower_than: float) -> None:
    """Keep still, `pause` [s] at a time, until every prop in the bin is slower than that [m/s]."""
    for _ in range(PAUSES):
        robot.do(robot.left.wait(pause))
        if all(robot.scene.speed(prop) < slower_than for prop in props):
            return
