"""Every attribute obeys its law in the simulator, and a broken attribute fails its law test."""

from collections.abc import Callable
from math import radians
from typing import Any

import pytest
from global_domain import GLOBAL, ends_of

from rtphys.assets.pack import builtin_pack
from rtphys.laws.lab import Lab
from rtphys.laws.law import ALL_VARIED, Trial, Values, by_prop, law_test, run_trials, trials_of
from rtphys.physics import attributes, gaze
from rtphys.physics.values import Value

pytestmark = pytest.mark.sim
LAWS = [law_test(key) for key in GLOBAL.keys]


@pytest.fixture(scope="module")
def lab() -> Lab:
    return Lab(builtin_pack())


def assert_passed(trials: list[Trial]) -> None:
    assert trials
    for t in trials:
        numbers = f"law {t.expected:.5g}, measured {t.measured:.5g} {t.unit}"
        assert t.passed, f"{t.setting}: {t.what}: {numbers}, error {t.error:.2%}"


@pytest.mark.parametrize("others", ["nominal", "varied"])
@pytest.mark.parametrize(
    ("key", "value"), [(law.key, value) for law in LAWS for value in law.settings], ids=str
)
def test_law(lab: Lab, key: str, value: Value, others: str) -> None:
    law = law_test(key)
    assert_passed(run_trials(lab, law, value, law.all_others if others == "varied" else {}))


@pytest.mark.parametrize(
    ("key", "others"), [(law.key, others) for law in LAWS for others in law.others], ids=str
)
def test_law_beside_other_attributes(lab: Lab, key: str, others: Values) -> None:
    assert_passed(run_trials(lab, law_test(key), law_test(key).settings[-1], others))


BY_PROP = [law for law in LAWS if attributes()[law.key].by_prop]


@pytest.mark.parametrize(
    ("key", "value"), [(law.key, value) for law in BY_PROP for value in law.settings[1:]], ids=str
)
def test_law_of_each_object_while_all_else_has_another_value(
    lab: Lab, key: str, value: Value
) -> None:
    """Also between two objects, whose pair has the sum of their labels less the smallest."""
    law = law_test(key)
    assert_passed(run_trials(by_prop(lab, law), law, value, law.all_others))


def test_every_attribute_of_an_object_can_be_of_one() -> None:
    assert {law.key for law in BY_PROP} == {
        "center_of_mass", "friction", "object_joint_damping", "object_mass", "restitution",
    }  # fmt: skip


# What acts on the robot itself, and what its fingers do to a thing between them.
OF_THE_ROBOT = ("arm_joint_damping", "friction", "gripper_joint_damping")


@pytest.mark.parametrize("robot", ["franka-panda", "piper"])
@pytest.mark.parametrize("key", OF_THE_ROBOT)
def test_law_on_every_robot(key: str, robot: str) -> None:
    lab, law = Lab(builtin_pack(), embodiment=robot), law_test(key)
    assert_passed(run_trials(lab, law, law.settings[1], law.all_others))


@pytest.mark.slow
@pytest.mark.parametrize("robot", ["franka-panda", "piper", "piper,franka-panda,0.7"])
@pytest.mark.parametrize("key", [law.key for law in LAWS])
def test_all_trials_on_every_robot(key: str, robot: str) -> None:
    assert_passed(list(trials_of(Lab(builtin_pack(), embodiment=robot), law_test(key))))


def test_company_varies_every_attribute() -> None:
    nominal = {key: attribute.nominal for key, attribute in attributes().items()}
    assert nominal.keys() <= ALL_VARIED.keys()
    assert not [key for key, value in nominal.items() if ALL_VARIED[key] == value]
    for law in LAWS:  # only what the law itself excludes is left out
        missing = nominal.keys() - law.all_others.keys() - {law.key}
        assert missing <= {"camera_angle", "camera_distance"}, law.key


@pytest.mark.parametrize("key", GLOBAL.keys)
def test_each_proof_covers_nominal_both_ends_and_other_attributes(key: str) -> None:
    law = law_test(key)
    assert law.key == key
    assert {attributes()[key].nominal, *ends_of(key)} <= set(law.settings)
    assert all(others.keys() <= attributes().keys() for others in law.others)
    assert len(law.others) >= 2


def one_arm_only(self: Any, target: Any, value: Any) -> None:
    for servo in target.arm_servos[:6]:
        servo.set_damping(servo.nominal_damping * value)


def angle_in_the_wrong_unit(self: Any, target: Any, value: Any) -> None:
    gaze.turn_by(target.head_camera, self.mode, self.direction, value / 100)


def orbit_that_does_not_look_back(self: Any, target: Any, value: Any) -> None:
    gaze.move(target.head_camera, "shift", self.direction, value)


def mirrored_offset(self: Any, target: Any, value: Any) -> None:
    for body in target.bodies:
        body.set_com(body.nominal_com - value)


def force_of_twice_the_label(self: Any, target: Any, value: Any) -> None:
    target.external_force = 2 * value


def friction_of_the_object_alone(self: Any, target: Any, value: Any) -> None:
    # PhysX averages the two surfaces: the object's own number is not the pair's.
    for surface in target.surfaces[:1]:
        surface.set_material(value, value, 0.0)


def friction_without_the_fingers(self: Any, target: Any, value: Any) -> None:
    for surface in target.surfaces:
        if "gripper" not in surface.name:
            surface.set_material(value, value, 0.0)


def factor_as_an_absolute_gain(self: Any, target: Any, value: Any) -> None:
    for servo in target.gripper_servos:
        servo.set_damping(value)


def damping_never_written(self: Any, target: Any, value: Any) -> None:
    for joint in target.joints:
        joint.set_friction(0.0)


def mass_without_inertia(self: Any, target: Any, value: Any) -> None:
    for body in target.bodies:
        body.set_mass(body.nominal_mass * value)


def scale_never_used(self: Any, target: Any, value: Any) -> None:
    target.object_scale = 1.0


def restitution_of_the_object_alone(self: Any, target: Any, value: Any) -> None:
    for surface in target.surfaces[:1]:
        surface.set_material(0.5, 0.5, value)


def height_in_centimetres(self: Any, target: Any, value: Any) -> None:
    target.table_height = value / 100


def tilt_the_other_way(self: Any, target: Any, value: Any) -> None:
    target.table_tilt = -radians(value)


# A wrong `apply`, a setting, and the trial that must fail.
BROKEN: dict[Callable[..., None], tuple[str, Value, str]] = {
    one_arm_only: ("arm_joint_damping", 3.0, "right joint"),
    angle_in_the_wrong_unit: ("camera_angle", 10.0, "gaze pixel, pan"),
    orbit_that_does_not_look_back: ("camera_distance", 0.1, "gaze pixel, orbit"),
    mirrored_offset: ("center_of_mass", (0.015, 0.015, 0.015), "balance point"),
    force_of_twice_the_label: ("external_force", 0.1, "a in the air"),
    friction_of_the_object_alone: ("friction", 0.01, "stopping distance"),
    friction_without_the_fingers: ("friction", 1.25, "between finger and object"),
    factor_as_an_absolute_gain: ("gripper_joint_damping", 3.0, "fingers"),
    damping_never_written: ("object_joint_damping", 25.0, "coasting"),
    mass_without_inertia: ("object_mass", 4.0, "alpha about x"),
    scale_never_used: ("object_scale", 0.85, "inertia ratio"),
    restitution_of_the_object_alone: ("restitution", 0.5, "bounce height"),
    height_in_centimetres: ("table_height", -0.08, "contact height"),
    tilt_the_other_way: ("table_tilt", 2.0, "roll of a ball"),
}


@pytest.mark.parametrize("broken", BROKEN, ids=lambda apply: apply.__name__)
def test_a_broken_attribute_fails_its_proof(
    lab: Lab, monkeypatch: pytest.MonkeyPatch, broken: Callable[..., None]
) -> None:
    key, value, by = BROKEN[broken]
    monkeypatch.setattr(type(attributes()[key]), "apply", broken)
    failed = [t.what for t in run_trials(lab, law_test(key), value, {}) if not t.passed]
    assert any(by in what for what in failed), f"only {failed} failed"


def test_every_attribute_has_a_broken_twin() -> None:
    assert {key for key, _, _ in BROKEN.values()} == set(GLOBAL.keys)
