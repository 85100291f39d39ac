"""Each experiment tells what was done to a world behind its label's back."""

from collections.abc import Callable

import numpy as np
import pytest

from rtphys.assets.pack import builtin_pack
from rtphys.core.poses import Pose, axis_angle
from rtphys.laws.audit.bodies import weigh_bodies
from rtphys.laws.audit.demonstration import CREEP, DEEP, ENOUGH, LOOK, Demonstration
from rtphys.laws.audit.joints import weigh_articulated
from rtphys.laws.audit.robot import drag, locate
from rtphys.laws.audit.specimen import Finding, Measurement, Specimen, lift
from rtphys.laws.audit.stands import drop_objects, push_stands
from rtphys.laws.audit.surfaces import hit_surfaces, survey
from rtphys.laws.lab import Lab, block
from rtphys.physics.values import Value
from rtphys.sim.engine import to_sapien
from rtphys.sim.world import World
from rtphys.task.props import Articulated, Box, Prop

pytestmark = pytest.mark.sim
PACK = builtin_pack()
LAB = Lab(PACK)
BLOCK = block((0.03, 0.04, 0.05), (0, 0, 1))
HINGED = [n for n in PACK.names if PACK.is_articulated(n)]


def specimen(props: list[Prop], values: dict[str, Value]) -> Specimen:
    """A world of the laboratory; its label is what was asked for."""
    return Specimen(LAB.world(props, values), PACK, dict(LAB.physics(values)))


def stand(category: str) -> Articulated:
    model = PACK.indices(category)[0]
    return Articulated(name="it", pose=Pose((0, 0, 1)), category=category, model=model, fixed=True)


def wrong(findings: list[Finding]) -> dict[str, Measurement]:
    """Place -> what deviates there."""
    return {f.place: f for f in findings if isinstance(f, Measurement) and not f.passed}


def test_a_shape_with_another_material_is_hit() -> None:
    one = specimen([BLOCK], {"friction": 0.6, "restitution": 0.3})
    lift(one.world)
    assert not wrong(hit_surfaces(one))
    slippery = one.world.scene.create_physical_material(0.5, 0.5, 0.3)
    one.world.object("block").root.collision_shapes[0].set_physical_material(slippery)
    found = wrong(hit_surfaces(one))
    assert found.keys() == {"block"}
    assert found["block"].measured == pytest.approx((0.5 + 0.6) / 2, abs=1e-3)  # with the table


def test_static_friction_beyond_the_label_does_not_hide_kinetic_friction() -> None:
    one = specimen([], {"friction": 0.6})
    one.world.room.table_surface.set_material(0.6, 0.4, 0.0)
    found = wrong(hit_surfaces(one))
    assert found.keys() == {"table"}
    assert found["table"].measured < 0.59


@pytest.mark.parametrize("lean", [0.0, 0.01])
def test_a_table_that_stands_elsewhere_is_found(lean: float) -> None:
    one = specimen([], {"table_height": -0.03, "table_tilt": 1.0})
    assert not wrong(survey(one))
    table = one.world.room.table
    higher = Pose(table.pose.p + np.array([0, 0, 2e-3]), table.pose.q)
    table.set_pose(to_sapien(higher @ Pose(q=axis_angle((0, 1, 0), lean))))
    found = {m.key: m for m in wrong(survey(one)).values()}
    if lean:
        tilt, aside = found["table_tilt"].measured  # type: ignore[misc]
        assert (tilt, aside) == pytest.approx((1.0, np.degrees(lean)), abs=0.02)
    else:
        assert found.keys() == {"table_height"}
        assert found["table_height"].measured == pytest.approx(-0.028, abs=1e-5)


def raw_push(world: World) -> None:
    world.external_force *= 1.03


ASKEW, ASIDE = np.array([1.0, 1.0, 1.03]), np.array([0, 1e-4, 0])
# Where a change is felt -> what is done to the world.
CHANGES: dict[str, Callable[[World], None]] = {
    "object_mass at block, inertia": lambda w: w.bodies[0].set_inertia(w.bodies[0].inertia * ASKEW),
    "object_mass at block": lambda w: w.bodies[0].set_mass(1.03 * w.bodies[0].mass),
    "center_of_mass at block": lambda w: w.bodies[0].set_com(w.bodies[0].com + ASIDE),
    "external_force at block": raw_push,
    "": lambda world: None,
}


@pytest.mark.parametrize("place", CHANGES)
def test_what_is_done_to_a_body_is_felt(place: str) -> None:
    values = {"object_mass": 2.0, "center_of_mass": (0.0, 0.01, 0.005), "external_force": 0.1}
    one = specimen([BLOCK], values)
    CHANGES[place](one.world)
    lift(one.world)
    found = wrong(weigh_bodies(one))
    assert {f"{m.key} at {m.place}" for m in found.values()} == ({place} if place else set())


@pytest.mark.parametrize("damping", [0.0, 0.01, 0.25, 2.0, 25.0])
@pytest.mark.parametrize("category", HINGED)
def test_joints_are_damped_as_labelled(category: str, damping: float) -> None:
    one = specimen([stand(category)], {"object_joint_damping": damping, "object_mass": 2.0})
    lift(one.world)
    findings = weigh_articulated(one)
    assert not wrong(findings)
    assert any(f.key == "object_joint_damping" for f in findings)


def test_a_joint_with_other_damping_and_a_heavier_link_are_felt() -> None:
    for key in ("object_joint_damping", "object_mass"):
        one = specimen([stand("044_microwave")], {"object_joint_damping": 2.0})
        if key == "object_mass":
            one.world.bodies[-1].set_mass(1.05 * one.world.bodies[-1].mass)  # the door
        else:
            one.world.joints[0].set_damping(2.05)
        lift(one.world)
        assert key in {m.key for m in wrong(weigh_articulated(one)).values()}


def test_one_servo_of_many_is_found() -> None:
    one = specimen([], {"arm_joint_damping": 0.7, "gripper_joint_damping": 2.0})
    servo, finger = one.world.arm_servos[4], one.world.gripper_servos[1]
    servo.set_damping(1.05 * servo.damping)
    finger.set_damping(0.95 * finger.damping)
    found = wrong(drag(one))
    assert found.keys() == {servo.name, finger.name}
    assert found[servo.name].measured == pytest.approx(0.735, rel=0.01)
    assert found[finger.name].measured == pytest.approx(1.9, rel=0.01)


@pytest.mark.parametrize(
    ("mode", "distance", "angle"),
    [("orbit", 0.08, 0.0), ("shift", 0.02, 0.0), ("rotate", 0.0, 7.0)],
)
def test_the_camera_is_found_where_it_is(mode: str, distance: float, angle: float) -> None:
    aux = {"camera_mode": mode, "camera_direction": (0.0, 0.6, 0.8)}
    one = specimen([], {**aux, "camera_distance": distance, "camera_angle": angle})
    there = one.world.head_camera.pose
    assert not wrong(locate(one, {"label": there}))
    turned = there @ Pose((0.001, 0, 0), axis_angle((1, 0, 0), 0.01))
    assert {p.split(", ")[1] for p in wrong(locate(one, {"label": turned}))} == {"label"}


def standing(name: str, x: float, half: tuple[float, float, float]) -> Box:
    return Box(name=name, pose=Pose((x, 0, 0)), half_size=half)


def test_an_object_that_bounces_otherwise_is_found() -> None:
    can = standing("can", 0.1, (0.03, 0.03, 0.04))
    found = drop_objects(specimen([can], {"restitution": 0.3}))
    assert len(found) == 4
    assert not wrong(found)
    one = specimen([can], {"restitution": 0.3})
    one.world.surfaces[0].set_material(0.5, 0.5, 0.6)  # the mean of two surfaces acts
    assert wrong(drop_objects(one)).keys() >= {"can, impact at 2 m/s"}


@pytest.mark.parametrize("feels", [True, False])
def test_what_slides_early_on_another_object_is_found(feels: bool) -> None:
    """Without feet a plate with its mass aside slides at 0.9 of the law."""
    props: list[Prop] = [
        standing("block", -0.1, (0.03, 0.03, 0.03)),
        standing("plate", 0.1, (0.03, 0.03, 0.006)),
    ]
    one = specimen(props, {"friction": 0.5, "center_of_mass": (0.01, 0.01, 0.0)})
    block, plate = (one.world.object(name) for name in ("block", "plate"))
    if not feels:
        for shape in block.root.collision_shapes:
            shape.set_collision_groups([1, 1, 0, 0])
    on_top = Pose(block.pose.p + np.array([0.01, 0, 0.0361]), plate.pose.q)
    found = push_stands(one, {"block": block.pose, "plate": on_top})
    assert {f.place for f in found} == {"plate on block"}
    assert bool(wrong(found)) != feels
    (left,) = push_stands(one, {"block": block.pose, "plate": on_top}, exempt={"plate"})
    assert isinstance(left, Measurement) == feels, (
        "what stands on its feet is measured all the same"
    )


WRIST_DOWN = np.array([-0.14, 2.7, 0.76, 0.0, -0.82, 0.0])  # [rad] 0.8 rad into the table


@pytest.mark.parametrize("joints", [WRIST_DOWN, 0.5 * WRIST_DOWN])
def test_a_wrist_that_is_pressed_on_the_table_is_seen(joints: np.ndarray) -> None:
    one = specimen([], {})
    seen = Demonstration(one.world, {"": 0.5})
    one.world.robot.left.drive(joints.tolist(), [0.0] * len(joints))
    for _ in range(500):
        one.world.step()
    presses = joints is WRIST_DOWN
    assert bool(seen.pressed.steps) == presses
    assert any("table press with over 30 N" in problem for problem in seen.problems()) == presses


@pytest.mark.parametrize(
    ("depth", "steps", "counts"), [(0.006, 9, 1), (0.006, 5, 0), (0.001, 9, 0)]
)
def test_what_stays_deep_in_another_body_is_found(depth: float, steps: int, counts: int) -> None:
    one = specimen([standing("block", 0.0, (0.03, 0.03, 0.03))], {})
    block = one.world.object("block")
    above, seen = block.pose, Demonstration(one.world, {"": 0.5})
    for _ in range(steps):
        block.root.entity.set_pose(to_sapien(Pose(above.p - [0, 0, depth], above.q)))
        one.world.step()
    (pair,) = seen.deep.steps if depth > DEEP else [None]
    assert pair is None or set(pair) == {"block", "table"}
    assert len(seen.problems()) == counts


@pytest.mark.parametrize("speed", [0.0, 0.5 * CREEP, 2 * CREEP])
def test_what_creeps_in_a_hand_is_found(speed: float) -> None:
    """A block floats between the fingers, and something draws it towards their tips."""
    world = LAB.world([], {})
    at = world.robot.left.tcp()
    held = Box(name="block", pose=at, half_size=(0.02, 0.02, 0.02), resting=False, on_table=False)
    one = specimen([held], {"friction": 1.0})
    body = one.world.object("block").root
    one.world.robot.left.grip(0.0)

    def keep(way: float) -> None:
        body.entity.set_pose(to_sapien(at.moved(way * at.R[:, 0])))
        body.set_linear_velocity([0.0, 0.0, 0.0])  # type: ignore[union-attr]
        one.world.step()

    for _ in range(150):
        keep(0.0)
    seen = Demonstration(one.world, {"": 1.0})
    for step in range(LOOK * (ENOUGH + 5)):
        keep(step / 250 * speed)
    ((grip, speeds),) = seen.creep().items()
    assert grip == ("left", "block")
    assert np.median(speeds) == pytest.approx(speed, abs=0.1 * CREEP)
    assert len(seen.problems()) == (speed > CREEP)
