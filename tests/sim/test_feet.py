"""Objects stand on round feet, slide as Coulomb says, and are otherwise what they were."""

from itertools import pairwise

import numpy as np
import pytest
from slip import slips

from rtphys.assets.pack import builtin_pack
from rtphys.core.poses import Pose
from rtphys.laws.lab import Lab, pose_of
from rtphys.sim.body import SINGLE, body_points, own_shapes
from rtphys.sim.engine import to_sapien
from rtphys.sim.feet import INSET, PROUD, RINGS, footing, has_feet, off_feet
from rtphys.task.props import TABLE_TOP, Articulated, Ball, Box, Mesh, Prop

UPRIGHT = Pose((0, 0, 0), (0.5**0.5, 0.5**0.5, 0, 0))
SQUARE = np.array([(-0.02, -0.02), (0.02, -0.02), (0.02, 0.02), (-0.02, 0.02), (0.0, 0.0)])


def can(**changes: object) -> Mesh:
    return Mesh(**{"name": "can", "pose": UPRIGHT, "category": "071_can", "model": 0, **changes})


def block(**changes: object) -> Box:
    plain = {"name": "block", "pose": Pose((0, 0, 0)), "half_size": (0.025, 0.025, 0.025)}
    return Box(**{**plain, **changes})


@pytest.fixture(scope="module")
def lab() -> Lab:
    return Lab(builtin_pack())


def test_feet_lie_inside_the_corners_of_a_face() -> None:
    spots = footing(SQUARE)
    assert {tuple(spot) for spot in np.round(np.abs(spots), 9)} == {(0.02 - INSET,) * 2}
    assert len(spots) == 4


def test_a_round_face_has_few_feet_that_stay_inside_it() -> None:
    angles = np.arange(24) * np.pi / 12
    ring = 0.03 * np.c_[np.cos(angles), np.sin(angles)]
    spots = footing(ring)
    assert len(spots) == 4
    assert np.linalg.norm(spots, axis=1).max() < 0.03 - 0.9 * INSET
    turns = np.sort(np.arctan2(spots[:, 1], spots[:, 0]))
    assert max(b - a for a, b in pairwise(turns)) == pytest.approx(np.radians(90), abs=0.01)


@pytest.mark.parametrize(
    "face", [SQUARE[:1], SQUARE[:2], SQUARE * (1.0, 0.2)], ids=("point", "line", "narrow")
)
def test_what_stands_on_little_has_no_feet(face: np.ndarray) -> None:
    assert len(footing(face)) == 0


@pytest.mark.sim
def test_feet_change_neither_mass_nor_hull_and_lift_by_micrometres(lab: Lab) -> None:
    body = lab.world([block()], {}).bodies[0]
    assert has_feet(body.component)
    side = 2 * 0.025
    assert body.mass == pytest.approx(450 * side**3, rel=1e-6)
    assert body.inertia == pytest.approx(body.mass * side**2 / 6, rel=1e-6)
    assert len(own_shapes(body.component)) == 1
    assert len(body_points(body.component)) == len(body.hull) == 8


@pytest.mark.sim
def test_a_block_comes_to_rest_on_its_feet(lab: Lab) -> None:
    world = lab.world([block()], {})
    for _ in range(150):
        world.step()
    height = pose_of(world.bodies[0]).p[2] - 0.025 - TABLE_TOP
    assert height == pytest.approx(PROUD, abs=2e-6)


@pytest.mark.sim
@pytest.mark.parametrize(
    "prop",
    [
        block(resting=False, pose=Pose((0, 0, 0.9))),
        block(fixed=True),
        can(rolls_about=1),
        Ball(name="ball", pose=Pose((0, 0, 0)), radius=0.03),
        Articulated(
            name="box", pose=Pose((0, 0, 0)), category="044_microwave", model=0, fixed=True
        ),
    ],
    ids=("floating", "fixed", "rolling", "ball", "fixed articulation"),
)
def test_only_what_stands_has_feet(lab: Lab, prop: Prop) -> None:
    world = lab.world([prop], {})
    assert not any(has_feet(c) for o in world.objects.values() for c in o.links.values())


@pytest.mark.sim
@pytest.mark.parametrize("prop", [block(), can()], ids=("block", "can"))
@pytest.mark.parametrize("mu", [0.1, 0.3])
def test_objects_slide_at_the_label_wherever_their_mass_is(lab: Lab, prop: Prop, mu: float) -> None:
    aside = [np.array(p) for p in ((0, 0, 0), (0, 0.01, 0), (0.007, -0.007, 0))]
    measured = [slip for slip in slips(lab, prop, mu, aside) if slip is not None]
    assert measured
    for slip in measured:
        assert slip.share == pytest.approx(1, abs=0.03)
        assert slip.turned < 10  # without feet a can turns by 80 degrees


@pytest.mark.sim
def test_light_bodies_slide_beside_others(lab: Lab) -> None:
    """Solved four at once, PhysX holds these for ever."""
    plate = Box(name="plate", pose=Pose((0, 0, 0)), half_size=(0.04, 0.04, 0.01), mass_kg=0.02)
    for slip in slips(lab, plate, 0.01, [np.zeros(3)] * 8):
        assert slip is not None
        assert slip.share == pytest.approx(1, abs=0.04)


@pytest.mark.sim
def test_every_shape_with_the_friction_label_is_solved_alone(lab: Lab) -> None:
    shapes = [s for surface in lab.world([block()], {}).surfaces for s in surface.shapes]
    assert {round(shape.patch_radius, 9) for shape in shapes} == {SINGLE}


@pytest.mark.sim
@pytest.mark.parametrize(
    ("prop", "off"), [(block(), False), (can(), False), (can(rolls_about=1), True)]
)
def test_what_bears_an_object_is_told(lab: Lab, prop: Prop, off: bool) -> None:
    world = lab.world([prop], {})
    for _ in range(150):
        world.step()
    assert off_feet(world.bodies[0].component, world.solver.get_contacts()) is off


@pytest.mark.sim
def test_what_stands_beyond_the_edge_of_another_object_stands_on_feet(lab: Lab) -> None:
    lower = block(name="lower", pose=Pose((0.1, -0.15, 0)))
    world = lab.world([lower, block(name="upper")], {})
    below, body = (world.object(name).root for name in ("lower", "upper"))
    assert len(body.collision_shapes) == 1 + 4 * (1 + len(RINGS))  # the table has its own
    on_top = world.object("lower").pose.moved((0.012, 0, 2 * 0.025 + 1e-4))
    body.entity.set_pose(to_sapien(on_top))
    for _ in range(100):
        world.step()
    contacts = world.solver.get_contacts()
    assert any({below, body} == set(contact.bodies) for contact in contacts)
    assert not off_feet(body, contacts)
