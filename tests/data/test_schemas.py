"""Published schemas and the golden label follow the models."""

import json
import pickle
from importlib.resources import files
from pathlib import Path

import pytest
import synthetic

from rtphys.core.errors import BadFile, BadValue
from rtphys.data import schema
from rtphys.data.json_text import plain, pretty
from rtphys.spec.collection import DATASET_VERSION

GOLDEN = Path(__file__).parent / "golden"


@pytest.mark.parametrize("name", schema.MODELS)
def test_published_schema_is_current(name: str) -> None:
    published = files("rtphys.data") / "schemas" / f"{name}.json"
    text = published.read_text(encoding="utf-8")
    assert text.encode() == pretty(plain(schema.json_schema(name))), (
        "write it again with `python -m rtphys.data.schema`"
    )


def test_golden_phys_meta() -> None:
    """A change here is a change of the file format: raise DATASET_VERSION."""
    golden = json.loads((GOLDEN / "phys_meta.json").read_text())
    assert schema.checked(schema.PhysMeta, golden) == golden
    assert schema.checked(schema.PhysMeta, label()) == golden


def label(**changes: object) -> dict[str, object]:
    return {**plain(synthetic.phys_meta(1)), "episode": 0, "recipe": {}, **changes}


@pytest.mark.parametrize(
    ("changes", "place"),
    [
        ({"seed": -1}, "seed"),
        ({"seed": "7"}, "seed"),
        ({"colour": "red"}, "colour"),
        ({"attributes": {}}, "attributes"),
        (
            {"attributes": {"friction": {"value": float("nan"), "unit": "1", "varied": True}}},
            "value",
        ),
        (
            {"cameras": {"head_camera": {"position": [0, 0], "quaternion_wxyz": [1, 0, 0, 0]}}},
            "position",
        ),
        ({"verdict": {}}, "accepted"),
    ],
)
def test_mistakes_are_named(changes: dict[str, object], place: str) -> None:
    with pytest.raises((schema.SchemaError, BadValue), match=place):
        schema.checked(schema.PhysMeta, label(**changes))


@pytest.mark.parametrize("name", schema.MODELS)
def test_schemas_are_json_schema(name: str) -> None:
    """Every reference inside resolves, and the version stands in the identifier."""
    document = schema.json_schema(name)
    assert str(document["$id"]).endswith(f"-{DATASET_VERSION}.json")
    text = json.dumps(document)
    for reference in {part.split('"')[0] for part in text.split('"#/$defs/')[1:]}:
        assert reference in document["$defs"]


def test_an_unsound_file_is_named_across_processes(tmp_path: Path) -> None:
    path = tmp_path / "instruction.json"
    path.write_text('{"seen": ["ring the bell"], "unseen": [3]}')
    with pytest.raises(BadFile) as caught:
        schema.read(schema.Instructions, path)
    error = pickle.loads(pickle.dumps(caught.value))
    assert str(error) == str(caught.value) == f"{path}: unseen.0: input should be a valid string"
