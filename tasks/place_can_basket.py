"""Put a can into a basket, then lift the basket by its handle with the other hand.

Success: the can lies in the basket, touching neither table nor hand, and a hand carries both.
"""

from rtphys.task import UP_Z, Draw, Mesh, Robot, Task

from ._baskets import carrying_basket, fill_and_lift, filled_and_lifted

FROM_ABOVE = tuple(range(8, 16))  # contact points of a can
EMPTY_CAN = 0.08  # [kg]: a full one is more than a hand lifts by the arch
DEPTH = 0.02  # [m] of the TCP above the can's contact point when the hand closes


def layout(draw: Draw):
    side = draw.choice("side", -1, 1)  # of the can; the other hand takes the basket
    yield carrying_basket(draw, side)
    x = (0.2, 0.25) if side > 0 else (-0.25, -0.2)
    spot = draw.spot("can", x=x, y=(0.0, 0.1), yaw=(-0.028, -0.028))
    model = draw.choice("can model", 0, 1, 2, 3, 5, 6)
    pose = spot.pose(UP_Z)
    yield Mesh(name="can", category="071_can", model=model, pose=pose, mass_kg=EMPTY_CAN)


def script(robot: Robot) -> None:
    fill_and_lift(robot, "can", FROM_ABOVE, depth=DEPTH)


task = Task(
    layout=layout,
    script=script,
    success=filled_and_lifted("can"),
    step_limit=700,
    arms="dual, in sequence",
    mechanism="place, lift container",
    info={"A": "can", "B": "basket", "a": "arm:can"},
)
