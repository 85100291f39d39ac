"""Small things of everyday life, for tasks in which any of them will do."""

from collections.abc import Callable, Iterable
from math import pi

from rtphys.task import (
    UP_Y,
    Draw,
    Mesh,
    Pose,
    Spot,
    clear_of,
)

MODELS: dict[str, tuple[int, ...]] = {
    "047_mouse": (0, 1, 2),
    "048_stapler": (0, 1, 2, 3, 4, 5, 6),
    "050_bell": (0, 1),
    "057_toycar": (0, 1, 2, 3, 4, 5),
    "073_rubikscube": (0, 1, 2),
    "075_bread": (0, 1, 2, 3, 4, 5, 6),
    "077_phone": (0, 1, 2, 3),  # 4 lies on its face when its y is up
    "079_remotecontrol": (0, 1, 2, 3, 4, 5, 6),
    "081_playingcards": (0, 1, 2),
    "086_woodenblock": (0, 1, 2, 3, 4),
    "107_soap": (0, 1, 2, 3),
    "112_tea-box": (0, 1, 2, 3, 4, 5),
    "113_coffee-box": (0, 1, 2, 3, 4, 5, 6),
}
NO_GRASP = frozenset({"050_bell", "086_woodenblock"})  # nothing that fits between two fingers
PAIRED = tuple(name for name in MODELS if name != "079_remotecontrol")


def everyday(draw: Draw, name: str, pose: Pose, categories: Iterable[str]) -> Mesh:
    """A thing of any of the categories, any model, all equally likely."""
    models = [(category, model) for category in categories for model in MODELS[category]]
    category, model = draw.choice(f"{name} model", *models)
    return Mesh(name=name, category=category, model=model, pose=pose)


def pair(draw: Draw, others_x: Callable[[Spot], tuple[float, float]]) -> tuple[Mesh, Mesh]:
    """A thing to be moved and another beside which it goes, of different categories.

    Spawn ranges: RoboTwin fact sheet, 2.21; 15 cm apart instead of 10, for some are that long.

    Args:
        others_x: where the other may stand [m], given where the first does.

    Raises:
        Infeasible: "layout".
    """
    first = draw.spot("thing", x=(-0.22, 0.22), y=(-0.2, 0.0), yaw=(-pi, pi))
    second = draw.spot(
        "other",
        x=others_x(first),
        y=(-0.2, 0.0),
        yaw=(-pi, pi),
        where=lambda s: clear_of((first, 0.15))(s) and abs(s.y - first.y) >= 0.1,
    )
    kind = draw.choice("kind", *(name for name in PAIRED if name not in NO_GRASP))
    others = [name for name in PAIRED if name != kind]
    return (
        everyday(draw, "thing", first.pose(UP_Y), [kind]),
        everyday(draw, "other", second.pose(UP_Y), others),
    )
