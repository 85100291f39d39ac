"""Two blocks that look alike: what each one's label says is what pushing and weighing find."""

from pathlib import Path

import pytest
from audited import PATH, audited, stored, unsound

from rtphys.assets.pack import builtin_pack
from rtphys.core.errors import UnknownName
from rtphys.episode.audit import audit_episode
from rtphys.episode.generate import Instance, attempt, prepare
from rtphys.laws.lab import pose_of
from rtphys.physics.handles import GRAVITY
from rtphys.physics.values import Physics
from rtphys.sim.engine import TIME_STEP
from rtphys.spec.episode import EpisodeSpec
from rtphys.task.spec import load_task

pytestmark = pytest.mark.sim
NAMES = ("left_block", "right_block")
SHARES = (0.95, 1.05)  # of the push that Coulomb's law needs
STEPS = 100


@pytest.fixture(autouse=True)
def library(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("RTPHYS_LIBRARY", str(Path(__file__).parent / "twin_blocks"))


def instance(seed: int, protocol: str = "clean") -> Instance:
    spec = EpisodeSpec("twin_blocks", protocol)
    return prepare(spec.at(seed), load_task("twin_blocks"), builtin_pack())


def test_each_block_weighs_what_its_label_says() -> None:
    made = instance(0)
    bodies = {body.name: body for body in made.world.bodies}
    for body in bodies.values():
        body.component.set_disable_gravity(True)
        body.component.add_force_torque([0.0, 0.0, 1.0], [0.0, 0.0, 0.0])
    made.world.step()
    for name in NAMES:
        body = bodies[name]
        mass = TIME_STEP / float(body.component.linear_velocity[2])  # F = 1 N
        assert mass / body.nominal_mass == pytest.approx(
            made.physics.scalar(f"object_mass@{name}"), rel=1e-3
        )
    assert made.physics["object_mass"] == 1.0, "nominal under clean"


def test_each_block_slides_under_the_push_of_its_label() -> None:
    for share in SHARES:
        world = (made := instance(0)).world
        for _ in range(STEPS):
            world.step()
        start = {body.name: pose_of(body).p for body in world.bodies}
        labels = {name: made.physics.scalar(f"friction@{name}") for name in NAMES}
        for _ in range(STEPS):
            for body in world.bodies:
                push = share * labels[body.name] * body.mass * GRAVITY
                body.component.add_force_torque([0.0, push, 0.0], [0.0, 0.0, 0.0])
            world.step()
        for body in world.bodies:
            way = float(pose_of(body).p[1] - start[body.name][1])
            free = 0.05 * labels[body.name] * GRAVITY * (STEPS * TIME_STEP) ** 2 / 2
            slides = way > free / 2
            assert slides == (share > 1), (body.name, share, way, free)


def test_an_audit_finds_what_each_label_says_and_a_lie() -> None:
    made = instance(1, "phys_random_all")
    audit = audited(made, builtin_pack())
    assert not unsound(audit)
    assert audit.sound
    measured = {finding.key for finding in audit.findings}
    assert {f"{key}@{name}" for key in ("friction", "object_mass") for name in NAMES} <= measured
    other = Physics({**made.physics, "friction@right_block": 0.6}, made.physics.varied)
    lie = audit_episode(stored(made), other, builtin_pack(), PATH)
    assert {one.key for one in lie.deviations} == {"friction@right_block"}
    assert lie.problems[0].startswith("friction@right_block: the label says 0.6")


def test_a_label_names_the_prop() -> None:
    labels = stored(instance(1, "phys_random")).attributes
    assert labels["friction@left_block"].source == "domain"
    assert labels["friction@left_block"].varied
    assert labels["center_of_mass@left_block"].could_act
    assert labels["object_mass"].could_act is False, "both blocks have a mass of their own"


def test_the_script_lifts_the_block_and_the_recipe_alone_decides() -> None:
    task, spec = load_task("twin_blocks"), EpisodeSpec("twin_blocks", "clean")
    first, again = (attempt(spec.at(0), task, builtin_pack(), touch=True) for _ in range(2))
    assert first.accepted, (first.reason, first.detail)
    assert first.recording is not None
    assert again.recording is not None
    assert first.recording.hash == again.recording.hash
    assert first.recording.touch is not None
    assert first.recording.touch.friction["left_block"] < first.recording.touch.friction[""]


def test_a_prop_that_the_task_has_not_is_refused() -> None:
    spec = EpisodeSpec("twin_blocks", "clean", overrides={"friction@nobody": 0.2})
    with pytest.raises(UnknownName, match="friction@nobody: unknown prop 'nobody'"):
        prepare(spec.at(0), load_task("twin_blocks"), builtin_pack())
