"""The ten domains against numbers typed from the paper's two tables, not from the YAML."""

import pytest

from rtphys.physics import domain_for_task, load_domain
from rtphys.physics.distribution import By, Fixed, SameAs, Uniform
from rtphys.physics.values import Interval

# Appendix A, table of global ranges; lengths in metres, angles in degrees.
PAPER_GLOBAL = {
    "object_mass": (0.125, 4.0),
    "center_of_mass": (-0.015, 0.015),
    "object_scale": (0.85, 1.05),
    "table_tilt": (0.0, 2.0),
    "table_height": (-0.08, 0.0),
    "external_force": (0.0, 0.1),
    "friction": (0.01, 1.25),
    "restitution": (0.0, 0.5),
    "object_joint_damping": (0.0, 25.0),
    "arm_joint_damping": (0.5, 3.0),
}
PAPER_CAMERA = {"orbit": 0.10, "shift": 0.03, "rotate": 10.0}

# Appendix B, task-specific configurations. A single number is a fixed value.
PAPER_TASKS = {
    "dump_bin_bigbin": {"center_of_mass": (-0.001, 0.001)},
    "grab_roller": {"center_of_mass": (-0.002, 0.002)},
    "beat_block_hammer": {"center_of_mass": (-0.002, 0.002)},
    "put_bottles_dustbin": {"center_of_mass": (-0.002, 0.002)},
    "open_microwave": {"object_joint_damping": (0.0, 0.25)},
    "turn_switch": {"object_joint_damping": (0.0, 1.0)},
    "put_object_cabinet": {"object_scale": 1.0, "arm_joint_damping": 1.0},
    "scan_object": {"center_of_mass": (-0.002, 0.002), "camera": 0.5},
    "place_bread_skillet": {
        "center_of_mass": (-0.001, 0.001),
        "object_scale": (0.9, 1.05),
        "table_tilt": (0.0, 1.0),
        "camera": 0.5,
    },
}


def rule_of(expected):
    return Fixed(expected) if isinstance(expected, float) else Uniform(Interval(*expected))


def check_camera(domain, share):
    far = {mode: share * limit for mode, limit in PAPER_CAMERA.items()}
    zero = Fixed(0.0)
    orbit, shift, turn = (Uniform(Interval(0.0, far[m])) for m in ("orbit", "shift", "rotate"))
    moved = By("camera_mode", {"orbit": orbit, "shift": shift, "rotate": zero})
    turned = By("camera_mode", {"orbit": zero, "shift": zero, "rotate": turn})
    assert domain.rules["camera_distance"] == moved
    assert domain.rules["camera_angle"] == turned


def test_global_is_the_papers_table():
    domain = load_domain("global")
    for key, expected in PAPER_GLOBAL.items():
        assert domain.rules[key] == rule_of(expected), key
    assert domain.rules["gripper_joint_damping"] == SameAs("arm_joint_damping")
    check_camera(domain, 1.0)
    assert len(domain.keys) == 13


@pytest.mark.parametrize("task", PAPER_TASKS)
def test_dedicated_domain_is_the_papers_row(task):
    domain, row = domain_for_task(task), dict(PAPER_TASKS[task])
    check_camera(domain, row.pop("camera", 1.0))
    for key, expected in (PAPER_GLOBAL | row).items():
        assert domain.rules[key] == rule_of(expected), key
    assert domain.rules["gripper_joint_damping"] == SameAs("arm_joint_damping")
    changed = {key for key, source in domain.sources.items() if source == task}
    camera = {"camera_distance", "camera_angle"} if "camera" in PAPER_TASKS[task] else set()
    assert changed == row.keys() | camera


def test_any_other_task_has_the_global_domain():
    assert domain_for_task("click_bell").name == "global"
    assert domain_for_task("scan_object").name == "scan_object"


def test_digest_tells_rules_apart_and_nothing_else():
    scan, hammer = load_domain("scan_object"), load_domain("beat_block_hammer")
    assert scan.digest != hammer.digest != load_domain("global").digest
    assert load_domain("grab_roller").digest == hammer.digest  # same row of the paper
