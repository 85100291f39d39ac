"""README and Croissant metadata say what the manifest says."""

import json
import os
import re
import subprocess
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import synthetic
import yaml
from collected import collect, write

from rtphys.core.errors import BadValue
from rtphys.data.dataset import Dataset
from rtphys.data.rewrite import convert
from rtphys.data.state_digests import state_digest
from rtphys.data.verify import verify
from rtphys.export.card import CardText, card, croissant, write_card

TEXT = CardText("Bells", "CC-BY-4.0", url="https://example.org/bells", published="2026-11-21")


@pytest.fixture(scope="module", autouse=True)
def _written(dataset: Dataset) -> None:
    """Beside the manifest; no other file of a dataset changes."""
    write_card(dataset, TEXT)


def metadata(dataset: Dataset) -> dict:
    return json.loads((dataset.path / "croissant.json").read_text())


def test_card_counts(dataset: Dataset) -> None:
    text = card(dataset, TEXT)
    front = text.split("---")[1].splitlines()
    assert 'license: "cc-by-4.0"' in front and "- robotics" in front and "- n<1K" in front
    assert "| click_bell | phys_random | aloha-agilex | 3 | 4 | 75% |" in text
    assert "by reason: slipped 1." in text
    assert "3 bimanual demonstrations (12 frames at 16.67 Hz)" in text
    frictions = [float(e.physics.scalar("friction")) for e in dataset]
    assert f"| `friction` | 1 | 3 | {min(frictions):.4g} | {max(frictions):.4g} |" in text


def test_a_date_that_is_none_is_refused() -> None:
    for text in ("soon", "2026-13-01", "21.11.2026", "20261121", "2026-W47-6"):
        with pytest.raises(BadValue, match=rf"published = '{text}'.*allowed: YYYY-MM-DD"):
            CardText(published=text)


def test_a_name_that_is_not_utf8_is_refused() -> None:
    with pytest.raises(BadValue, match=r"name = .*UTF-8"):
        CardText(name="caf\udce9")


def test_the_licence_is_spelled_as_each_reader_spells_it(dataset: Dataset) -> None:
    assert 'license: "cc-by-4.0"' in card(dataset, TEXT)
    assert metadata(dataset)["license"] == "https://spdx.org/licenses/CC-BY-4.0"


@pytest.mark.parametrize(
    ("frames", "category"),
    [(999, "n<1K"), (1000, "1K<n<10K"), (999_999, "100K<n<1M"), (10**6, "1M<n<10M"),
     (12_345_678, "10M<n<100M"), (10**12 - 1, "100B<n<1T"), (10**12, "n>1T")],
)  # fmt: skip
def test_the_size_is_one_of_hugging_faces_categories(
    dataset: Dataset, monkeypatch: pytest.MonkeyPatch, frames: int, category: str
) -> None:
    (entry,) = dataset.task_datasets
    large = replace(entry, frames=frames)
    monkeypatch.setattr(Dataset, "task_datasets", (large,))
    front = yaml.safe_load(card(dataset, TEXT).split("---")[1])
    assert front["size_categories"] == [category]


def test_robots_are_told_apart(tmp_path: Path) -> None:
    collect(tmp_path, 2)
    collect(tmp_path, 3, synthetic.header(embodiment="piper"))
    both = Dataset(tmp_path)
    text = card(both, TEXT)
    assert "| click_bell | phys_random | aloha-agilex | 2 | 2 | 100% |" in text
    assert "| click_bell | phys_random | piper | 3 | 4 | 75% |" in text
    (records,) = croissant(both, TEXT)["recordSet"]  # type: ignore[misc]
    robots = [row["episodes/embodiment"] for row in records["data"]]
    assert robots == ["aloha-agilex"] * 2 + ["piper"] * 3


def test_any_name_is_one_in_the_front_matter(dataset: Dataset) -> None:
    text = card(dataset, CardText(name="Bells: the first set"))
    assert yaml.safe_load(text.split("---")[1])["pretty_name"] == "Bells: the first set"


def test_a_card_says_who_acted(dataset: Dataset, tmp_path: Path) -> None:
    collect(tmp_path, 1, synthetic.header(policy="feels"))
    assert "by the policy `feels`: rtphys" in card(Dataset(tmp_path), TEXT)
    assert "by a scripted expert: rtphys" in card(dataset, TEXT)


def test_a_card_names_the_folders_that_are_there(dataset: Dataset, tmp_path: Path) -> None:
    """Of either layout, and of both where a dataset has both."""
    convert(dataset.path, tmp_path / "legacy", "legacy")
    collect(tmp_path / "both", 1)
    collect(tmp_path / "both", 1, synthetic.header("legacy", overrides={"friction": 0.1}))
    for folder in (dataset.path, tmp_path / "legacy", tmp_path / "both"):
        expected, red = set[str](), set[bool]()
        for entry in (data := Dataset(folder)).task_datasets:
            spec, place = entry.spec, entry.below(folder)
            named = place.name.replace(spec.name, "<config>").replace(spec.episode.task, "<task>")
            expected.add(named.replace(place.embodiment, "<embodiment>") + "/ledger.jsonl")
            expected |= {f"…/{path.parent.name}/" for path in place.episode(0).all()}
            red.add(spec.recording.layout == "legacy")
        text = card(data, TEXT)
        table = re.findall(r"^\| `([^`]+)` \|", text.split("## Files")[1], re.MULTILINE)
        assert {*table} == expected | {"manifest.json"}
        assert ("XPL-RGB1" in text) is (False in red) and ("exchanged" in text) is (True in red)


def test_nobody_is_given_a_licence(dataset: Dataset) -> None:
    assert "license" not in card(dataset, CardText()).lower()
    assert "license" not in croissant(dataset, CardText())


def test_croissant_lists_every_file_with_its_checksum(dataset: Dataset) -> None:
    listed = {f["contentUrl"]: f["sha256"] for f in metadata(dataset)["distribution"]}
    expected = {path: facts.sha256 for path, facts in dataset.files()}
    assert expected.items() <= listed.items()
    assert set(listed) - set(expected) == {"manifest.json"}


def test_croissant_has_a_record_per_episode(dataset: Dataset) -> None:
    (records,) = metadata(dataset)["recordSet"]
    fields = {field["@id"] for field in records["field"]}
    assert [set(row) for row in records["data"]] == [fields] * 3
    assert [row["episodes/seed"] for row in records["data"]] == [0, 1, 3]
    assert records["data"][1]["episodes/friction"] == dataset[1].physics["friction"]


def test_croissant_has_every_field_in_each_record(tmp_path: Path) -> None:
    """Mlcroissant refuses a record set in which a line lacks a column."""
    collect(tmp_path, 1)
    header = synthetic.header(overrides={"friction@bell": 0.1})
    one: Any = synthetic.episode(0, spec=header.spec.episode)
    one.phys_meta["attributes"]["friction@bell"] = one.phys_meta["attributes"]["friction"]
    data = write(tmp_path, one, what=header)
    (records,) = croissant(data, TEXT)["recordSet"]  # type: ignore[misc]
    fields = {field["@id"] for field in records["field"]}
    assert "episodes/friction@bell" in fields
    assert [set(row) for row in records["data"]] == [fields] * 2
    assert records["data"][1]["episodes/friction@bell"] is None


def test_the_card_identifies_the_dataset_and_each_episode(dataset: Dataset) -> None:
    digest = re.findall(r"`(sha256:[0-9a-f]{64})`", card(dataset, TEXT))
    assert [verify(dataset.path).digest] == digest
    (records,) = metadata(dataset)["recordSet"]
    listed = [row["episodes/state_digest"] for row in records["data"]]
    assert listed == [state_digest(one)[:16] for one in dataset]
    assert len({*listed}) == 3


def test_the_dataset_stays_sound_and_the_card_repeats(dataset: Dataset) -> None:
    before = [path.read_bytes() for path in write_card(dataset, TEXT)]
    assert [path.read_bytes() for path in write_card(dataset, TEXT)] == before
    assert verify(dataset.path).problems == []


def test_metadata_of_many_episodes_do_not_hold_their_arrays_and_labels(dataset: Dataset) -> None:
    """0.3 MB an episode, and 0.03 MB: a large dataset did not fit into memory."""
    fresh = Dataset(dataset.path)
    write_card(fresh, TEXT)
    assert not any({"frames", "meta"} & {*vars(one)} for one in fresh)


@pytest.mark.slow
def test_mlcroissant_accepts_it(dataset: Dataset) -> None:
    program = os.environ.get("RTPHYS_MLCROISSANT")
    if not program:
        pytest.skip("set RTPHYS_MLCROISSANT to the program mlcroissant")
    path = Path(dataset.path / "croissant.json")
    result = subprocess.run(
        [program, "validate", "--jsonld", str(path)], capture_output=True, text=True
    )
    output = result.stdout + result.stderr
    assert result.returncode == 0 and "Done" in output, output
    assert "WARNING" not in output and "Found the following" not in output
