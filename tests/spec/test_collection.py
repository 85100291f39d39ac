"""What a run asks for: checks, names, seeds of a shard, twins; stored and compared."""

import json
from dataclasses import replace

import pytest

from rtphys.core.errors import BadFile, BadValue, RtphysError
from rtphys.physics.load import load_domain
from rtphys.spec.collection import CollectionSpec, Resolved, TaskHeader
from rtphys.spec.episode import EpisodeSpec
from rtphys.spec.protocol import OFFICIAL
from rtphys.spec.recording import RecordingSpec
from rtphys.spec.stored import differences, load, stored

RICH = CollectionSpec(
    EpisodeSpec("click_bell", "phys_random_all", overrides={"friction": 0.2}),
    RecordingSpec(("head", "left"), ("depth",), size="640x480", layout="legacy"),
    episodes=7,
    first_seed=3,
    twin="clean",
    keep_failures="all",
    config="mine",
)
HEADER = TaskHeader(
    RICH, Resolved(load_domain("global").to_json(), OFFICIAL.to_json(), {"numpy": "1"}, {})
)


def test_json_and_back_without_extents() -> None:
    """How many episodes is no part of what a dataset is."""
    kept = json.loads(json.dumps(stored(HEADER)))
    assert load(TaskHeader, kept, "ledger") == replace(HEADER, spec=replace(RICH, episodes=10))
    assert "episodes" not in kept["spec"] and "max_attempts" not in kept["spec"]
    more = replace(HEADER, spec=replace(RICH, episodes=99, max_attempts=1000))
    assert differences(kept, stored(more)) == []


def test_differences_name_the_field() -> None:
    other = replace(RICH, episode=replace(RICH.episode, overrides={"friction": 0.3}), first_seed=0)
    assert differences(stored(RICH), stored(other)) == [
        "episode.overrides.friction was 0.2, now 0.3",
        "first_seed was 3, now 0",
    ]
    assert differences({"a": {"b": 1}, "c": 1}, {"a": 2}) == [
        "a was {'b': 1}, now 2",
        "c was 1, now None",
    ]


@pytest.mark.parametrize(
    ("given", "text"),
    [
        ({"episodes": 0}, "episodes = 0 .*at least 1"),
        ({"first_seed": -1}, "first_seed = -1 .*at least 0"),
        ({"keep_failures": "some"}, "keep_failures = 'some' .*a positive number, or all"),
        ({"keep_failures": "0"}, "keep_failures"),
        ({"shard": 3, "shards": 2}, "shard = 3 .*one of 2"),
        ({"shards": 10**6}, "shards"),
        ({"config": "../outside"}, "config"),
        ({"twin_of": "a/b"}, "twin_of"),
    ],
)
def test_what_cannot_be_collected(given: dict[str, object], text: str) -> None:
    with pytest.raises(BadValue, match=text):
        CollectionSpec(**given)  # type: ignore[arg-type]


def test_a_number_of_failures_is_text_or_a_number() -> None:
    assert CollectionSpec(keep_failures=3).keep_failures == "3"  # type: ignore[arg-type]
    assert (RICH.failures_expected, CollectionSpec(keep_failures="3").max_failures) == (7, 3)
    assert CollectionSpec().max_failures == 0


def test_a_twin_differs_in_its_protocol_alone() -> None:
    first, twin = RICH.sides
    assert first is RICH and twin.name == RICH.twin_name == "mine.twin=clean"
    assert (twin.twin, twin.twin_of, twin.episode) == (None, "mine", RICH.episode.under("clean"))
    assert twin.recording == RICH.recording and CollectionSpec().sides == (CollectionSpec(),)


def test_shards_share_the_seeds_out() -> None:
    parts = [replace(RICH, shards=3, shard=number) for number in (1, 2, 3)]
    seeds = [[part.seed(attempt) for attempt in range(4)] for part in parts]
    assert sorted(seed for part in seeds for seed in part) == [
        RICH.seed(attempt) for attempt in range(12)
    ]
    assert seeds[1] == [4, 7, 10, 13]


def test_rules_are_those_that_are_stored() -> None:
    """Not those of the names, whose files may change."""
    assert HEADER.rules.domain == load_domain("global") and HEADER.rules.visual == OFFICIAL
    assert "friction" in HEADER.rules.held and HEADER.rules.draw(3)["friction"] == 0.2
    broken = replace(HEADER, resolved=replace(HEADER.resolved, domain={"width": 3}))
    with pytest.raises((RtphysError, ValueError)):
        _ = broken.rules


def test_a_header_of_something_else() -> None:
    with pytest.raises(BadFile, match=r"ledger: .*resolved"):
        load(TaskHeader, {"spec": stored(RICH)}, "ledger")
