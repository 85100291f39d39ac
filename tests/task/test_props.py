"""Props whose sizes and masses no body has are refused where they are made."""

import pytest

from rtphys.core.errors import BadValue
from rtphys.core.poses import Pose
from rtphys.task import Draw, Task, hands_open
from rtphys.task.props import Articulated, Ball, Box, Mesh

HERE = Pose((0, 0, 0))


@pytest.mark.parametrize("half", [(0.02, -0.02, 0.02), (0.02, 0.0, 0.02), (0.02, float("nan"), 1)])
def test_a_box_has_three_lengths(half: tuple[float, float, float]) -> None:
    with pytest.raises(BadValue, match=r"prop a: half_size = \(0.02, .*above 0"):
        Box(name="a", pose=HERE, half_size=half)


def test_a_mark_may_be_flat_but_not_less() -> None:
    Box(name="a", pose=HERE, half_size=(0.02, 0.02, 0.0), visual_only=True)
    with pytest.raises(BadValue, match="0 or above"):
        Box(name="a", pose=HERE, half_size=(0.02, 0.02, -0.01), visual_only=True)


@pytest.mark.parametrize("radius", [0.0, -0.1, float("nan"), float("inf")])
def test_a_ball_has_a_radius(radius: float) -> None:
    with pytest.raises(BadValue, match="prop a: radius = "):
        Ball(name="a", pose=HERE, radius=radius)


@pytest.mark.parametrize("number", [0.0, -1.0, float("nan")])
def test_a_body_has_a_mass(number: float) -> None:
    with pytest.raises(BadValue, match="mass_kg = "):
        Mesh(name="a", pose=HERE, category="050_bell", model=0, mass_kg=number)
    with pytest.raises(BadValue, match="density = "):
        Box(name="a", pose=HERE, half_size=(0.1, 0.1, 0.1), density=number)
    with pytest.raises(BadValue, match="density = "):
        Ball(name="a", pose=HERE, radius=0.1, density=number)


def test_an_articulated_prop_weighs_what_its_asset_says() -> None:
    """A mass of its own was ignored."""
    with pytest.raises(BadValue, match=r"prop a: mass_kg = 5\.0 .*what its asset says"):
        Articulated(name="a", pose=HERE, category="015_laptop", model=0, mass_kg=5.0)


def test_the_error_names_the_task() -> None:
    def layout(draw: Draw) -> list[Ball]:
        return [Ball(name="a", pose=HERE, radius=-0.1)]

    task = Task(
        layout=layout, script=lambda _: None, success=hands_open(), step_limit=1, name="roll_it"
    )
    with pytest.raises(BadValue, match=r"^task roll_it, prop a: radius = -0\.1 .*above 0"):
        task.props(0)
