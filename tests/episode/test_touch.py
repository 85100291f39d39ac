"""What the fingers feel is what holds the load, by its weight, the servo's law and its motion."""

from functools import cache

import numpy as np
import pytest

from rtphys.assets.pack import default_pack
from rtphys.core.poses import Pose
from rtphys.episode.generate import Instance, attempt
from rtphys.episode.touch import felt, felt_now
from rtphys.senses.touch import Touch
from rtphys.sim.recorder import Recording, Row
from rtphys.sim.touch import POSE_STEPS, TouchTrack
from rtphys.spec.episode import EpisodeSpec
from rtphys.task.spec import load_task

pytestmark = pytest.mark.sim
GRAVITY = 9.81
STILL = 2e-4  # [m] between two frames


@cache
def tried(touch: bool) -> tuple[Instance, Recording]:
    """Two loaves, one in each hand, under physics of its own."""
    recipe = EpisodeSpec("place_bread_basket", "phys_random").at(0)
    made = attempt(recipe, load_task(recipe.task), default_pack(), touch=touch)
    assert made.instance is not None and made.recording is not None
    return made.instance, made.recording


def track() -> TouchTrack:
    found = tried(True)[1].touch
    assert found is not None
    return found


@cache
def touch() -> Touch:
    return felt(track())


def held(side: int, load: str) -> list[int]:
    """Frames in which a hand alone holds a loaf still in the air."""
    rows, index = tried(True)[1].rows, touch().objects.index(load)
    fingers = slice(2 * side, 2 * side + 2)
    found = []
    for k in range(3, len(rows) - 1):
        places = np.array([row.objects[load][:3] for row in rows[k - 2 : k + 2]])
        still = np.abs(np.diff(places, axis=0)).max() < STILL
        lifted = places[0, 2] > rows[0].objects[load][2] + 0.015
        shut = rows[k].arms[-1] == rows[k - 1].arms[-1] == 0
        if still and lifted and shut and touch().pressed[k, fingers, index].min() > 0:
            found.append(k)
    return found


def test_recording_it_moves_nothing() -> None:
    with_it, without = tried(True)[1], tried(False)[1]
    assert with_it.hash == without.hash and without.touch is None
    pairs = zip(with_it.rows, without.rows, strict=True)
    assert all(one.touched == other.touched for one, other in pairs)


def test_all_frames_at_once_are_each_frame_by_itself() -> None:
    whole = touch()
    for t in range(0, len(track().rows), 9):
        alone = felt_now(track(), track().rows[t])
        for key, values in alone.arrays().items():
            columns = [whole.objects.index(name) for name in alone.objects]
            wanted = whole.arrays()[key][t]
            wanted = wanted[:, columns] if key == "pressed" else wanted
            assert values[0] == pytest.approx(wanted, rel=1e-6, abs=1e-9), (t, key)


def test_a_frame_that_has_not_ended() -> None:
    """Its steps are those of the frame that holds them, cut off."""
    row = track().rows[held(1, "bread1")[5]]
    for n in (1, 7, 15):
        poses = row.packed[: 1 + -(-n // POSE_STEPS)]
        now = felt_now(track(), row._replace(wrenches=row.wrenches[:n], packed=poses))
        arm = np.array(row.wrenches)[:n, list(track().links), :3]
        size = np.linalg.norm(arm, axis=2)[:, 2:]
        both = np.hypot(now.normal_peak[0, 2:], now.tangential_peak[0, 2:])
        assert both == pytest.approx(size.max(axis=0), rel=0.01), n


def test_the_fingers_together_carry_the_weight_against_the_external_force() -> None:
    instance, _ = tried(True)
    weight = next(b.mass for b in instance.world.bodies if b.name == "bread1") * GRAVITY
    pushed = float(str(instance.physics["external_force"])) * weight
    frames = held(1, "bread1")
    assert len(frames) > 20
    total = touch().force[frames, 2:].sum(axis=1)
    assert total[:, 2] == pytest.approx(weight, rel=0.05)
    assert total[:, 0] == pytest.approx(-pushed, abs=0.05 * weight)
    assert total[:, 1] == pytest.approx(0.0, abs=0.05 * weight)


def test_a_finger_presses_as_its_servo_does() -> None:
    """k e: the law of a servo at rest, from positions alone."""
    instance, recording = tried(True)
    arm = instance.world.robot.right
    frames = held(1, "bread1")
    for finger, column in enumerate(arm.finger_index.tolist()):
        q = np.array([recording.rows[k].qpos[column] for k in frames])
        law = arm.limb.gripper_drive.stiffness * (q - arm.limb.finger_target(0.0))
        assert touch().normal[frames, 2 + finger] == pytest.approx(law, rel=0.03)
        # And it is what the contacts say, which know nothing of joints.
        pressed = touch().pressed[frames, 2 + finger].sum(axis=1)
        assert touch().normal[frames, 2 + finger] == pytest.approx(pressed, rel=0.03)


def test_no_more_friction_than_the_cone_allows() -> None:
    frames = held(1, "bread1")
    assert (touch().margin[frames, 2:] > 0).all()
    assert (touch().tangential <= touch().tangential_peak + 1e-5).all()
    idle = touch().normal_peak == 0
    assert (touch().margin[idle] == 1).all()


def in_hand(row: Row, name: str) -> Pose:
    """Of an object in the left hand's frame."""
    hand, thing = row.ee[0], row.objects[name]
    return Pose(hand[:3], hand[3:]).inverse() @ Pose(thing[:3], thing[3:])


def test_a_load_that_slides_slides_past_the_pads() -> None:
    """A phone slides out of a hand; its own motion against the hand says how fast."""
    recipe = EpisodeSpec("place_phone_stand", "phys_random_all").at(71)
    made = attempt(recipe, load_task(recipe.task), default_pack(), touch=True)
    recording = made.recording
    assert made.reason == "slipped" and recording is not None and recording.touch is not None
    found = felt(recording.touch)
    index = found.objects.index("phone")
    compared = []
    for k in range(1, len(recording.rows)):
        if found.pressed[k, :2, index].min() <= 0 or found.pressed[k - 1, :2, index].min() <= 0:
            continue
        # The phone's point between the pads, as the hand saw it a frame ago and sees it now.
        before, now = recording.rows[k - 1], recording.rows[k]
        X_HO = [in_hand(row, "phone") for row in (before, now)]
        tip = np.array([0.13, 0.0, 0.0])
        way = tip - (X_HO[0] @ X_HO[1].inverse() @ Pose(tip)).p
        speed = float(np.linalg.norm(way[[0, 2]])) / 0.06
        compared.append((speed, float(found.slip[k, :2].mean())))
    own, slip = np.array(compared).T
    fast = own > 0.02
    assert fast.any()
    assert slip[fast] == pytest.approx(own[fast], rel=0.25)
    assert found.slip[:, 2:].max() == 0, "the other hand holds nothing"
