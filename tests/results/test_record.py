"""The record of one episode: its JSON, and what is no record."""

import pytest
from evaluations import record

from rtphys.core.errors import BadFile, BadValue
from rtphys.results.record import REASONS, EpisodeRecord


def test_json_is_inverted() -> None:
    written = record(3, success=False, physics={"center_of_mass": (0.0, 0.1, 0.0)})
    data = written.to_json()
    assert data["physics"] == {"center_of_mass": [0.0, 0.1, 0.0]}
    assert EpisodeRecord.from_json(data, "here").to_json() == data
    assert data["reason"] in REASONS


def test_unknown_keys_and_infinite_numbers_are_refused() -> None:
    data = record(3).to_json()
    with pytest.raises(BadFile, match=r"here.*mood"):
        EpisodeRecord.from_json({**data, "mood": "good"}, "here")
    with pytest.raises(BadFile, match=r"here.*seed"):
        EpisodeRecord.from_json({key: data[key] for key in data if key != "seed"}, "here")
    with pytest.raises(BadValue, match="time"):
        record(3, time=float("nan")).to_json()
