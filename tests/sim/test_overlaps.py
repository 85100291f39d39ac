"""Nothing lies in anything else at the start, and what falls into a bin does not go through it."""

import pytest
from sapien import physx

from rtphys.assets.pack import default_pack
from rtphys.core.errors import Infeasible
from rtphys.episode.generate import attempt, prepare
from rtphys.laws.audit.overlaps import overlaps
from rtphys.sim.world import World
from rtphys.spec.episode import EpisodeSpec
from rtphys.task import load_task, task_names

pytestmark = pytest.mark.sim

BINS = ("put_bottles_dustbin", "dump_bin_bigbin")


def world_of(task: str, seed: int, protocol: str, **held: float) -> World:
    recipe = EpisodeSpec(task, protocol, overrides=held).at(seed)
    return prepare(recipe, load_task(task), default_pack()).world


@pytest.mark.parametrize("task", BINS)
@pytest.mark.parametrize("scale", [0.85, 1.0, 1.05])
def test_the_dustbin_stands_beside_the_slab_at_any_size(task: str, scale: float) -> None:
    world = world_of(task, 1, "phys_random", object_scale=scale)
    assert not overlaps(world)
    right = world.object("dustbin").points()[:, 0].max()
    edge = world.room.plan.shift[0] - 0.6
    assert 0 < edge - right < 0.01


@pytest.mark.slow
@pytest.mark.parametrize("task", task_names())
def test_nothing_overlaps_at_the_start(task: str) -> None:
    for protocol in ("clean", "phys_random_all"):
        for seed in (1, 2):
            try:
                world = world_of(task, seed, protocol)
            except Infeasible:
                continue
            assert not overlaps(world), (protocol, seed)


def drop(world: World, height: float) -> tuple[float, float]:
    """Least height of a ball over the bin's floor [m], and its rebound's speed over its fall's."""
    bin_, ball = world.object("dustbin").root, world.object("ball0").root
    assert isinstance(ball, physx.PhysxRigidDynamicComponent)
    pose, radius = ball.entity_pose, 0.008
    pose.set_p([bin_.entity_pose.p[0], 0.0, height])
    ball.entity.set_pose(pose)
    lowest, fastest, rebound = 1.0, 0.0, 0.0
    for _ in range(120):
        world.step()
        lowest = min(lowest, float(ball.entity_pose.p[2]) - radius - 0.215)
        speed = float(ball.linear_velocity[2])
        fastest, rebound = min(fastest, speed), max(rebound, speed)
    return lowest, rebound / -fastest


@pytest.mark.parametrize("restitution", [0.2, 0.5])
def test_what_falls_into_the_bin_stops_at_its_floor(restitution: float) -> None:
    for step in range(4):
        held = {"restitution": restitution, "object_scale": 1.0, "external_force": 0.0}
        world = world_of("dump_bin_bigbin", 1, "phys_random", **held)
        lowest, rebound = drop(world, 0.7 + 0.003 * step)
        assert lowest > -0.001
        assert rebound == pytest.approx(restitution, abs=0.05)


@pytest.mark.slow
@pytest.mark.parametrize("task", BINS)
def test_no_demonstration_has_things_deep_in_the_bin(task: str) -> None:
    """More than 3 mm, for more than 5 steps."""
    deep: dict[int, int] = {}

    def look(world: World) -> None:
        bin_ = world.object("dustbin").root
        now = {
            other.entity.per_scene_id
            for contact in world.solver.get_contacts()
            for other in contact.bodies
            if bin_ in contact.bodies and other is not bin_
            if any(point.separation < -0.003 for point in contact.points)
        }
        for body in now:
            deep[body] = deep.get(body, 0) + 1
        for body in deep.keys() - now:
            deep[body] = 0
        assert max(deep.values(), default=0) <= 5

    step = World.step
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(World, "step", lambda world: (step(world), look(world)))
        for seed in (1, 2):
            attempt(EpisodeSpec(task, "phys_random").at(seed), load_task(task), default_pack())
