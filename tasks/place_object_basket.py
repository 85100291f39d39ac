"""Put a toy car or a pack of cards into a basket, then lift it with the other hand.

Success: the object lies in the basket, touching neither table nor hand, and a hand carries both.
"""

from rtphys.task import UP_Z, Draw, Mesh, Robot, Task

from ._baskets import carrying_basket, fill_and_lift, filled_and_lifted

MODELS = {"081_playingcards": 3, "057_toycar": 6}  # how many of each category


def layout(draw: Draw):
    side = draw.choice("side", -1, 1)  # of the object; the other hand takes the basket
    yield carrying_basket(draw, side)
    x = (0.2, 0.25) if side > 0 else (-0.25, -0.2)
    spot = draw.spot("object", x=x, y=(-0.1, 0.1), yaw=(-0.552, 0.496))
    category = draw.choice("object", *MODELS)
    model = draw.choice("object model", *range(MODELS[category]))
    yield Mesh(name="object", category=category, model=model, pose=spot.pose(UP_Z))


def script(robot: Robot) -> None:
    fill_and_lift(robot, "object")


task = Task(
    layout=layout,
    script=script,
    success=filled_and_lifted("object"),
    step_limit=700,
    arms="dual, in sequence",
    mechanism="place, lift container",
    info={"A": "object", "B": "basket", "a": "arm:object", "b": "arm:basket"},
)
