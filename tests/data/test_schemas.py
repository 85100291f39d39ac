"""The golden label follows the models, and what does not fit them is named."""

import json
import pickle
from pathlib import Path

import pytest
import synthetic

from rtphys.core.errors import BadFile, BadValue
from rtphys.data import schema
from rtphys.data.json_text import plain

GOLDEN = Path(__file__).parent / "golden"


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


def test_an_unsound_file_is_named_across_processes(tmp_path: Path) -> None:
    path = tmp_path / "instruction.json"
    path.write_text('{"seen": ["ring the bell"], "unseen": [3]}')
    with pytest.raises(BadFile) as caught:
        schema.read(schema.Instructions, path)
    error = pickle.loads(pickle.dumps(caught.value))
    assert str(error) == str(caught.value) == f"{path}: unseen.0: input should be a valid string"
