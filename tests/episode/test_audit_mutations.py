"""No false value of an attribute escapes an audit."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from audited import audited, unsound

from rtphys.assets.pack import builtin_pack
from rtphys.episode.generate import Instance, prepare
from rtphys.physics import attributes
from rtphys.spec.episode import EpisodeSpec
from rtphys.task.spec import load_task

PACK = builtin_pack()
pytestmark = pytest.mark.sim

# All differ from nominal by so much that a tenth of the difference shows.
VALUES = {
    "arm_joint_damping": 2.0,
    "camera_distance": 0.05,
    "camera_mode": "orbit",
    "center_of_mass": (0.004, 0.006, -0.005),
    "external_force": 0.08,
    "friction": 0.9,
    "gripper_joint_damping": 0.6,
    "object_joint_damping": 4.0,
    "object_mass": 3.0,
    "object_scale": 0.9,
    "restitution": 0.4,
    "table_height": -0.05,
    "table_tilt": 1.5,
}
# What is not built at its size has another mass too; what does not weigh what it should is slowed
# by inertia where damping should slow it; and a hinge feels where the centre of mass is.
FOLLOWS = {
    "object_scale": {"object_mass", "center_of_mass", "object_joint_damping"},
    "object_mass": {"object_joint_damping"},
    "center_of_mass": {"object_mass"},
}
TURNED = {"camera_mode": "rotate", "camera_angle": 6.0}


Apply = Callable[[Any, Any, Any], None]


def nothing(_: Apply) -> Apply:
    return lambda self, target, value: None


def a_tenth_off(apply: Apply) -> Apply:
    """A tenth of the value, or of its distance from 1 where 1 is nominal."""

    def mutated(self: Any, target: Any, value: Any) -> None:
        base = 1.0 if self.nominal == 1.0 else 0.0
        apply(self, target, base + 0.9 * (np.array(value) - base))

    return mutated


@pytest.fixture(scope="module")
def honest() -> dict[str, Instance]:
    """Two episodes of a task with rigid bodies and with joints."""
    task, instances = load_task("put_object_cabinet"), {}
    for mode, extra in (("orbit", {}), ("rotate", TURNED)):
        values = {**VALUES, **extra}
        if extra:
            values.pop("camera_distance")
        spec = EpisodeSpec("put_object_cabinet", "phys_random_all", overrides=values)
        instances[mode] = prepare(spec.at(0), task, PACK)
    return instances


@pytest.mark.parametrize("mutation", [nothing, a_tenth_off])
@pytest.mark.parametrize("key", attributes())
def test_experiments_find_every_mutation_of_apply(
    key: str,
    mutation: Callable[[Apply], Apply],
    honest: dict[str, Instance],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    mode = "rotate" if key == "camera_angle" else "orbit"
    cls = type(attributes()[key])
    monkeypatch.setattr(cls, "apply", mutation(cls.apply))
    audit = audited(honest[mode], PACK)
    found = {measurement.key for measurement in audit.deviations}
    assert key in found
    assert found <= {key} | FOLLOWS.get(key, set())


def test_the_same_labels_pass_where_apply_is_honest(honest: dict[str, Instance]) -> None:
    for instance in honest.values():
        assert not unsound(audited(instance, PACK))


def test_a_read_back_that_lies_hides_nothing(
    honest: dict[str, Instance], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The audit of before compared read-back with read-back: a twin error in both escaped it."""
    cls = type(attributes()["object_mass"])
    monkeypatch.setattr(cls, "apply", nothing(cls.apply))
    monkeypatch.setattr(cls, "disagreements", lambda self, world, value: [])
    audit = audited(honest["orbit"], PACK)
    assert {m.key for m in audit.deviations} <= {"object_mass", "object_joint_damping"}
    weighed = [m.measured for m in audit.deviations if m.key == "object_mass"]
    assert weighed == pytest.approx([1.0] * len(weighed), rel=0.01)
    assert len(weighed) > 3


def test_one_body_that_is_too_heavy_is_named(
    honest: dict[str, Instance], monkeypatch: pytest.MonkeyPatch
) -> None:
    cls = type(attributes()["object_mass"])
    honest_apply, names = cls.apply, list[str]()

    def apply(self: Any, target: Any, value: float) -> None:
        honest_apply(self, target, value)
        heavy = next(body for body in target.bodies if "/" not in body.name)  # no link
        heavy.set_mass(heavy.mass * 1.03)
        names.append(heavy.name)

    monkeypatch.setattr(cls, "apply", apply)
    audit = audited(honest["orbit"], PACK)
    assert [m.place for m in audit.deviations if m.key == "object_mass"] == names
