"""The renderer on whatever Vulkan device there is: shader edits, pictures, camera matrices."""

import shutil
import subprocess
import sys
import textwrap
from math import radians
from pathlib import Path

import numpy as np
import pytest
import sapien

from rtphys.core.errors import BadValue, NoRenderer, UnknownName
from rtphys.core.poses import Pose
from rtphys.sim import camera as cameras
from rtphys.sim import renderer, shader
from rtphys.sim.shader import EDITS, UNUSED_FILES
from rtphys.spec.recording import RecordingSpec

SOURCE = Path(sapien.__file__).parent / "vulkan_shader"


def run(script: str, *arguments: str) -> str:
    """Run a script in a process of its own: SAPIEN's shader choice is global to a process."""
    done = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", textwrap.dedent(script), *arguments],
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


SCENE = """
    import sys
    import numpy as np, sapien
    from rtphys.core.poses import Pose
    from rtphys.sim import renderer
    from rtphys.sim.camera import CameraSpec, SimCamera, looking, HEAD

    renderer.configure(sys.argv[1])
    scene = sapien.Scene()
    renderer.Lights(scene)

    def box(half, at, colour, roughness=1.0, metallic=0.0):
        material = sapien.render.RenderMaterial(base_color=[*colour, 1], roughness=roughness)
        material.specular, material.metallic = 1 - roughness, metallic
        builder = scene.create_actor_builder()
        builder.add_box_visual(half_size=half, material=material)
        builder.initial_pose = sapien.Pose(at)
        builder.build_static()

    box([0.6, 0.35, 0.025], [0, 0, 0.715], [0.8, 0.7, 0.6])
    box([0.03, 0.03, 0.03], [-0.05, 0.0, 0.77], [0.9, 0.1, 0.1], roughness=0.3)
    box([0.02, 0.04, 0.06], [0.10, 0.05, 0.80], [0.1, 0.2, 0.9])
    box([0.05, 0.05, 0.01], [-0.18, 0.05, 0.75], [0.8, 0.8, 0.3], roughness=0.4, metallic=0.6)
    eye = SimCamera(scene, CameraSpec("head_camera", pose=looking(*HEAD)))
    scene.update_render()
    np.save(sys.argv[2], renderer.capture(eye.component))
"""


@pytest.mark.slow
@pytest.mark.render
def test_slim_draws_what_the_default_shader_draws(tmp_path: Path) -> None:
    pictures = {}
    for name in ("slim", "default"):
        run(SCENE, name, str(tmp_path / f"{name}.npy"))
        pictures[name] = np.load(tmp_path / f"{name}.npy")
    slim, default = pictures["slim"].astype(int), pictures["default"].astype(int)
    assert slim.shape == (240, 320, 3)
    assert slim.std() > 20, "nothing to see"
    red, blue = slim[..., 0] - slim[..., 2] > 80, slim[..., 2] - slim[..., 0] > 80
    assert red.sum() > 300 and blue.sum() > 300
    difference = np.abs(slim - default).max(axis=2)
    # Only the penumbra differs: slim averages 3x3 shadow texels, the default 5x5.
    assert (difference > 3).mean() < 0.03
    assert difference.max() < 60


@pytest.mark.render
def test_same_picture_in_two_processes(tmp_path: Path) -> None:
    for name in ("a", "b"):
        run(SCENE, "slim", str(tmp_path / f"{name}.npy"))
    assert np.array_equal(np.load(tmp_path / "a.npy"), np.load(tmp_path / "b.npy"))


@pytest.mark.render
def test_anchor_and_second_choice() -> None:
    run("""
        import pytest
        from rtphys.core.errors import BadValue
        from rtphys.sim import renderer
        assert not renderer.pictures_ready()
        renderer.hold_anchor()
        renderer.hold_anchor()
        renderer.configure("slim")
        assert renderer.pictures_ready()
        with pytest.raises(BadValue, match="already draws with 'slim'"):
            renderer.configure("default")
    """)


@pytest.mark.slow
@pytest.mark.render
def test_a_pack_that_sapien_refuses_is_replaced_by_the_default(tmp_path: Path) -> None:
    run(
        """
        import os, sys, warnings
        from pathlib import Path
        os.environ["RTPHYS_CACHE"] = sys.argv[1]
        from rtphys.sim import renderer
        pack = Path(renderer._shader_folder("slim"))
        assert pack.is_relative_to(sys.argv[1])
        (pack / "deferred.frag").write_text("no shader at all")
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            renderer.hold_anchor()
        assert any("slower default shader" in str(w.message) for w in caught), caught
        """,
        str(tmp_path),
    )


def test_where_no_shader_draws_the_reason_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    def refused() -> None:
        raise RuntimeError("no queue")

    monkeypatch.setattr(renderer, "_first_frame", refused)
    monkeypatch.setattr(renderer, "_anchors", {})
    monkeypatch.setattr(renderer, "_configured", ["slim"])
    before = sapien.render.get_camera_shader_dir()
    with pytest.warns(UserWarning, match="slower"), pytest.raises(NoRenderer, match="no queue"):
        renderer.hold_anchor()
    sapien.render.set_camera_shader_dir(before)


def test_unknown_shader_names_the_known_ones() -> None:
    with pytest.raises(BadValue, match="slim, default, minimal, rt"):
        renderer.configure("slimm")


def test_slim_pack_is_derived_once_and_keyed_by_its_source(tmp_path: Path) -> None:
    first = shader.slim_pack(SOURCE, "1.0", tmp_path)
    text = "".join(p.read_text() for p in first.iterdir())
    assert "samplerEnvironment" not in text and "samplerBRDFLUT" not in text
    assert not any([*first.glob(pattern)] for pattern in UNUSED_FILES)
    stamp = (first / "deferred.frag").stat().st_mtime_ns
    assert shader.slim_pack(SOURCE, "1.0", tmp_path) == first
    assert (first / "deferred.frag").stat().st_mtime_ns == stamp
    second = shader.slim_pack(SOURCE, "2.0", tmp_path)
    assert second != first
    assert {p.name for p in tmp_path.iterdir()} == {first.parent.name, second.parent.name}


@pytest.mark.parametrize("file", sorted(EDITS))
def test_changed_shaders_are_noticed(tmp_path: Path, file: str) -> None:
    copy = tmp_path / "source"
    shutil.copytree(SOURCE, copy)
    changed = copy / file.replace("slim/", "default/")
    changed.write_text("// another SAPIEN\n")
    with pytest.raises(shader.ShaderMismatch, match=changed.name):
        shader.slim_pack(copy, "1.0", tmp_path / "cache")
    assert not list((tmp_path / "cache").glob("slim-*")), "a half-made pack was left behind"


# ---- cameras -----------------------------------------------------------------------------------


def test_head_camera_looks_at_the_table() -> None:
    pose = cameras.looking(*cameras.HEAD)
    point = pose.p + pose.R[:, 0] * 0.7625  # measured: the gaze meets the nominal table top here
    assert np.allclose(point, [-0.032, 0.0075, 0.74], atol=1e-9)
    spec = cameras.CameraSpec("head_camera", pose=pose)
    pixel = spec.intrinsic_cv @ cameras.extrinsic_cv(pose) @ np.append(point, 1)
    assert np.allclose(pixel[:2] / pixel[2], [160, 120], atol=1e-3)


@pytest.mark.render
def test_matrices_are_the_simulator_s_own() -> None:
    scene = sapien.Scene()
    pose = cameras.looking((0.3, -0.2, 1.1), (-0.4, 0.5, -0.7), (-0.5, -0.4, 0.1))
    spec = cameras.CameraSpec("front_camera", 320, 180, radians(45), pose)
    eye = cameras.SimCamera(scene, spec)
    assert np.allclose(spec.intrinsic_cv, eye.component.get_intrinsic_matrix(), atol=1e-3)
    assert np.allclose(
        cameras.extrinsic_cv(eye.pose), eye.component.get_extrinsic_matrix(), atol=1e-6
    )
    assert np.allclose(cameras.cam2world_gl(eye.pose), eye.component.get_model_matrix(), atol=1e-6)
    moved = Pose((0, 0, 2), (1, 0, 0, 0))
    eye.set_pose(moved)
    assert np.allclose(eye.pose.matrix, moved.matrix)


def test_points_project_where_they_are() -> None:
    pose = cameras.looking(*cameras.FRONT)
    P = cameras.CameraSpec("front_camera", pose=pose).intrinsic_cv @ cameras.extrinsic_cv(pose)

    def pixel(*point: float) -> np.ndarray:
        u, v, w = P @ np.append(pose @ np.array(point), 1)
        return np.array([u, v]) / w

    right, up = pixel(1.0, -0.1, 0.0), pixel(1.0, 0.0, 0.1)  # y is left, so -y is right
    assert right[0] > 160 and right[1] == pytest.approx(120, abs=1e-3)
    assert up[1] < 120 and up[0] == pytest.approx(160, abs=1e-3)


def test_unknown_camera_is_named() -> None:
    with pytest.raises(UnknownName, match="did you mean 'head'"):
        RecordingSpec(("haed",))
