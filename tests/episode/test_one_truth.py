"""Under every protocol the label is what an independent measurement of the world gives.

The measurements ask raw SAPIEN, not what the attributes read back: the camera that takes the
pictures.
"""

import numpy as np
import pytest

from rtphys.assets.pack import default_pack
from rtphys.core.poses import Pose
from rtphys.episode.assemble import label as label_of
from rtphys.episode.generate import Instance, prepare
from rtphys.sim import renderer
from rtphys.sim.scene_renderer import SceneRenderer
from rtphys.spec.episode import EpisodeSpec
from rtphys.spec.protocol import BUILTIN, OFFICIAL
from rtphys.spec.recording import RecordingSpec
from rtphys.task.spec import load_task

PACK = default_pack()
NAMES = tuple(row.name for row in BUILTIN)
TASKS = ("click_bell", "place_dual_shoes", "open_laptop")
FROM_CV = np.array([[0, -1, 0, 0], [0, 0, -1, 0], [1, 0, 0, 0], [0, 0, 0, 1]], float)


def labels(instance: Instance) -> dict[str, dict[str, object]]:
    """The attributes of the label that a recording of this instance would have."""
    return label_of(instance)["attributes"]  # pyright: ignore[reportReturnType]


@pytest.mark.sim
@pytest.mark.parametrize("protocol", NAMES)
@pytest.mark.parametrize("name", TASKS)
def test_a_label_says_where_its_height_comes_from(name: str, protocol: str) -> None:
    """That the table stands there is what `test_audit_episodes` measures."""
    heights = []
    for seed in range(2):
        instance = prepare(EpisodeSpec(name, protocol).at(seed), load_task(name), PACK)
        heights.append(labels(instance)["table_height"])
    source = {"clean": "nominal", "official_random": "look"}.get(protocol, "domain")
    assert [one["source"] for one in heights] == [source] * 2
    assert [one["varied"] for one in heights] == [protocol != "clean"] * 2
    if protocol == "official_random":
        values = [float(one["value"]) for one in heights]
        assert -OFFICIAL.table_drop < min(values) < max(values) < 0


@pytest.mark.render
@pytest.mark.parametrize("protocol", NAMES)
def test_pictures_are_taken_from_where_the_label_says(protocol: str) -> None:
    renderer.configure("slim")
    renderer.hold_anchor()
    for seed in range(3):
        recipe = EpisodeSpec("click_bell", protocol).at(seed)
        instance = prepare(recipe, load_task("click_bell"), PACK, visuals=True)
        scene, label = SceneRenderer(instance.world, RecordingSpec(("head",))), labels(instance)
        (camera,) = scene.cameras
        world_to_camera = np.eye(4)  # OpenCV axes, as the renderer has it
        world_to_camera[:3] = camera.component.get_extrinsic_matrix()
        taken = Pose.from_matrix(np.linalg.inv(world_to_camera) @ FROM_CV)
        nominal = instance.world.head_camera.nominal_pose
        moved = float(np.linalg.norm(taken.p - nominal.p))
        assert moved == pytest.approx(float(label["camera_distance"]["value"]), abs=1e-6)
        turned = np.degrees(taken.angle_to(nominal))
        if instance.physics["camera_mode"] != "orbit":  # whose gaze follows from the distance
            assert turned == pytest.approx(float(label["camera_angle"]["value"]), abs=1e-3)
        if protocol in ("clean", "official_random"):
            assert (moved, turned) == (pytest.approx(0, abs=1e-6), pytest.approx(0, abs=1e-3))


@pytest.mark.sim
def test_a_held_height_stays_and_is_told_as_set() -> None:
    spec = EpisodeSpec("click_bell", "official_random", overrides={"table_height": -0.05})
    label = labels(prepare(spec.at(3), load_task("click_bell"), PACK))["table_height"]
    assert (label["value"], label["source"]) == (-0.05, "set")
