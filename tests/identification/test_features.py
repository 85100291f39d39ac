"""Features: statistics of each stage, by the role that an arm has in an episode."""

import pytest
from senses import recording

from rtphys.assets.embodiment import Embodiment
from rtphys.identification.features import (
    STATISTICS,
    features_of,
    group_of,
    normalised,
    packed,
    unpacked,
)


@pytest.mark.parametrize(
    ("stage", "name"),
    [
        ("left grasp pot + right grasp pot", "grasp pot"),
        ("left place can + right lift", "place can + lift"),
        ("recover left grasp can", "recover grasp can"),
        ("right", "right"),
        ("start", "start"),
    ],
)
def test_a_stage_has_one_name_whatever_the_arm(stage: str, name: str) -> None:
    assert normalised(stage) == name


def test_statistics_are_those_of_the_stage_alone(embodiment: Embodiment) -> None:
    found = features_of(recording(embodiment), embodiment).values
    name = "lift/hand/effort/effort_1"  # 0.1 k in rows 8 to 11
    assert found[f"{name}/mean"] == pytest.approx(0.95)
    assert found[f"{name}/least"] == pytest.approx(0.8)
    assert found[f"{name}/most"] == found[f"{name}/final"] == pytest.approx(1.1)
    assert found[f"{name}/change"] == pytest.approx(0.3)
    assert found["lift/duration"] == pytest.approx(0.18)
    assert found["whole/duration"] == pytest.approx(19 * 0.06)
    assert found["grasp block 2/hand/touch/touch/mean"] == 1
    assert found["grasp block/hand/touch/touch/mean"] == 0


def test_the_arm_that_moves_is_the_hand_and_an_idle_one_has_no_features(
    embodiment: Embodiment,
) -> None:
    for side, number in (("left", 0), ("right", 1)):
        found = features_of(recording(embodiment, moved=side), embodiment)
        assert (found.side, found.values["whole/side"]) == (side, number)
        assert not [name for name in found.values if "/other/" in name]
    both = features_of(recording(embodiment, moved="both"), embodiment)
    assert both.side == "left"
    assert [name for name in both.values if "/other/" in name]


def test_packing_loses_nothing(embodiment: Embodiment) -> None:
    values = features_of(recording(embodiment, moved="both"), embodiment).values
    assert unpacked(packed(values)) == values
    assert len(packed(values)["lift"]["hand"]["touch"]["touch"]) == len(STATISTICS)  # type: ignore[index,arg-type,call-overload]


def test_every_feature_belongs_to_a_group() -> None:
    assert group_of("lift/hand/effort/force_z/mean") == "effort"
    assert group_of("lift/duration") == group_of("whole/side") == "timing"
