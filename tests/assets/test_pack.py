"""The loader: builtin and official layout alike, errors that name the file, fallback."""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from rtphys.assets.build import build
from rtphys.assets.check import check_pack
from rtphys.assets.glb import glb_bytes
from rtphys.assets.pack import Pack, builtin_pack, default_pack
from rtphys.core.errors import BadFile, BadValue, MissingAsset, RtphysError, UnknownName
from rtphys.visual.clutter import pieces


@pytest.fixture(scope="module")
def pack(tmp_path_factory) -> Pack:
    out = tmp_path_factory.mktemp("packs") / "builtin"
    return Pack(build(out, names=["050_bell", "015_laptop", "aloha-agilex"], workers=1))


def official_like(root: Path, scale: float) -> Pack:
    """A pack with one rigid object in raw units, as the official ones are."""
    folder = root / "objects" / "123_thing"
    for kind in ("visual", "collision"):
        (folder / kind).mkdir(parents=True)
        (folder / kind / "base4.glb").write_bytes(glb_bytes([], []))
    point = np.eye(4)
    point[:3, 3] = 1, 2, 3
    data = {
        "center": [0, 1, 0],
        "extents": [2, 4, 6],
        "scale": [scale] * 3,
        "contact_points_pose": [point.tolist()],
        "functional_matrix": [],
    }
    (folder / "model_data4.json").write_text(json.dumps(data))
    return Pack(root)


def test_a_folder_without_models_is_no_object(tmp_path):
    """RoboTwin's pack has objects/objaverse, with folders of other models in it."""
    pack = official_like(tmp_path, 1.0)
    (tmp_path / "objects/objaverse/apple/1").mkdir(parents=True)
    (tmp_path / "objects/list.json").write_text("[]")
    assert pack.names == ("123_thing",)
    assert [piece.category for piece in pieces(pack)] == []  # it is too wide


def test_scale_reaches_extents_and_points(tmp_path):
    model = official_like(tmp_path, 0.05).model("123_thing", 4)
    np.testing.assert_allclose(model.extents, [0.1, 0.2, 0.3])
    np.testing.assert_allclose(model.contact_points[0][:3, 3], [0.05, 0.1, 0.15])
    assert model.mass_kg is None and model.inertia is None


def test_points_cannot_be_written_to(pack):
    with pytest.raises(ValueError, match="read-only"):
        pack.model("050_bell", 0).contact_points[0][0, 0] = 2


@pytest.mark.parametrize(
    ("ask", "error", "words"),
    [
        (lambda p: p.model("050_bell", 7), MissingAsset, ["model 7 of 050_bell", "it has 0, 1"]),
        (lambda p: p.model("050_bel", 0), MissingAsset, ["050_bel", "nearest: '050_bell'"]),
        (lambda p: p.model("bell", 0), UnknownName, ["did you mean '050_bell'"]),
        (lambda p: p.articulation("015_laptop", 99), MissingAsset, ["model 99 of 015_laptop"]),
        (lambda p: p.embodiment("aloha"), UnknownName, ["did you mean 'aloha-agilex'"]),
        (
            lambda p: p.textures("train", "table"),
            UnknownName,
            ["texture split 'train'", "seen, unseen"],
        ),
    ],
)
def test_errors_name_what_is_missing(pack, ask, error, words):
    with pytest.raises(error) as caught:
        ask(pack)
    assert all(word in str(caught.value) for word in words), str(caught.value)


def test_a_missing_mesh_names_its_file(tmp_path):
    pack = official_like(tmp_path, 1.0)
    mesh = tmp_path / "objects/123_thing/collision/base4.glb"
    mesh.unlink()
    with pytest.raises(MissingAsset, match=r"collision/base4\.glb"):
        pack.model("123_thing", 4)


def test_broken_metadata_names_its_file(tmp_path):
    pack = official_like(tmp_path, 1.0)
    path = tmp_path / "objects/123_thing/model_data4.json"
    path.write_text('{"scale": [1, 1]}')
    with pytest.raises(BadFile, match="model_data4"):
        pack.model("123_thing", 4)


EVEN = np.eye(3).tolist()


@pytest.mark.parametrize(
    ("key", "value", "allowed"),
    [
        ("mass_kg", -1.0, "above 0"),
        ("mass_kg", 0, "above 0"),
        ("mass_kg", "0.2", "a number"),
        ("density", "4", "a number"),
        ("density", 0.0, "above 0"),
        ("inertia", [[1, 0, 0], [0, -1, 0], [0, 0, 1]], "positive definite"),
        ("inertia", [[1, 0.5, 0], [0, 1, 0], [0, 0, 1]], "symmetric"),
        ("scale", [0, 0, 0], "above 0"),
        ("scale", -1, "above 0"),
    ],
)
def test_numbers_that_no_body_has_are_refused(tmp_path, key, value, allowed):
    pack = official_like(tmp_path, 1.0)
    path = tmp_path / "objects/123_thing/model_data4.json"
    data = json.loads(path.read_text())
    path.write_text(json.dumps({**data, "mass_kg": 0.1, "inertia": EVEN, "density": None}))
    assert pack.box("123_thing", 4).stable is False
    Pack(tmp_path).model("123_thing", 4)
    path.write_text(json.dumps({**data, key: value}))
    with pytest.raises(BadValue, match=rf"model_data4\.json: {key} = .*{allowed}"):
        pack.model("123_thing", 4)


@pytest.mark.parametrize("kind", ["visual", "collision"])
def test_what_is_no_mesh_is_refused(tmp_path, kind):
    pack = official_like(tmp_path, 1.0)
    (tmp_path / "objects/123_thing" / kind / "base4.glb").write_bytes(b"garbage" * 50)
    with pytest.raises(BadFile, match=rf"{kind}/base4\.glb: is no readable mesh"):
        pack.model("123_thing", 4)


def test_a_check_looks_at_the_meshes_of_articulations(pack, tmp_path):
    source = pack.root / "objects/015_laptop/0"
    folder = tmp_path / "objects/015_laptop/0"
    shutil.copytree(source, folder)
    assert check_pack(Pack(tmp_path)).problems == ()
    mesh = next(folder.rglob("*.glb"))
    mesh.write_bytes(b"garbage" * 50)
    (problem,) = check_pack(Pack(tmp_path)).problems
    assert f"{mesh.name}: is no readable mesh" in problem


def test_a_folder_that_is_no_pack_is_refused(tmp_path):
    with pytest.raises(BadFile, match="neither objects/ nor embodiments/"):
        Pack(tmp_path)


def test_fallback_stands_in_only_for_what_is_missing(pack, tmp_path):
    both = Pack(official_like(tmp_path, 1.0).root, pack)
    assert both.model("123_thing", 4).visual.is_relative_to(tmp_path)
    assert both.model("050_bell", 1).visual.is_relative_to(pack.root)
    assert both.is_articulated("015_laptop") and both.indices("015_laptop") == tuple(range(11))
    assert both.embodiment().urdf.is_relative_to(pack.root)
    assert both.digest not in (pack.digest, Pack(tmp_path).digest)
    with pytest.raises(RtphysError):
        Pack(tmp_path).model("050_bell", 1)


def test_articulations_by_position_in_numeric_order_or_by_folder(pack, tmp_path):
    source = pack.root / "objects/015_laptop/0"
    for number in ("9748", "10040"):
        folder = tmp_path / "objects/015_laptop" / number
        folder.mkdir(parents=True)
        for name in ("mobility.urdf", "model_data.json"):
            (folder / name).write_bytes((source / name).read_bytes())
    found = Pack(tmp_path)
    assert found.articulation("015_laptop", 0).urdf.parent.name == "9748"
    assert found.articulation("015_laptop", 1).urdf.parent.name == "10040"
    assert found.articulation("015_laptop", 10040).urdf.parent.name == "10040"


def test_default_pack_follows_the_environment(pack, monkeypatch):
    monkeypatch.setenv("RTPHYS_ASSETS", str(pack.root))
    assert default_pack().digest == pack.digest


def test_the_environment_names_a_pack_to_stand_in(monkeypatch, tmp_path):
    (tmp_path / "objects").mkdir()
    monkeypatch.setenv("RTPHYS_ASSETS", str(tmp_path))
    assert default_pack().names == ()
    monkeypatch.setenv("RTPHYS_ASSETS_FALLBACK", "builtin")
    assert default_pack().names == builtin_pack().names
    monkeypatch.setenv("RTPHYS_ASSETS_FALLBACK", "bultin")
    with pytest.raises(UnknownName, match="did you mean 'builtin'"):
        default_pack()


def test_linking_and_unlinking(pack, monkeypatch, tmp_path):
    from rtphys.cli.machine import link

    monkeypatch.delenv("RTPHYS_ASSETS", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    link(pack.root, "", False)
    assert default_pack().root == pack.root
    link(None, "", True)
    assert not (tmp_path / "rtphys/assets/link.json").exists()
    with pytest.raises(BadValue):
        link(None, "", False)
