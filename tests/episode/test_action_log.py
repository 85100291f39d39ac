"""A policy whose actions have other units or order: its record and one line name the cause."""

import re
from collections.abc import Callable

import numpy as np
import pytest

from rtphys.assets.pack import default_pack
from rtphys.core.poses import Array
from rtphys.episode import PolicyEpisode, begin
from rtphys.results import EpisodeRecord
from rtphys.results.instances import InstanceList
from rtphys.results.summary import summarise
from rtphys.spec.episode import EpisodeSpec
from rtphys.task.spec import load_task

pytestmark = pytest.mark.sim
HANDS, ARMS = [6, 13], [*range(6), *range(7, 13)]


@pytest.fixture
def episode() -> PolicyEpisode:
    return begin(EpisodeSpec("click_bell", "clean").at(0), load_task("click_bell"), default_pack())


def changed(row: Array, places: list[int], into: Array) -> Array:
    """The same numbers, but others at some places."""
    return np.where(np.isin(np.arange(14), places), into, row)


# What a policy says instead of a row of joints and openings -> the cause that is named.
LANGUAGES: dict[str, tuple[Callable[[Array, PolicyEpisode], Array], str]] = {
    "degrees": (
        lambda row, _: changed(row, ARMS, np.degrees(row)),
        r"joints are beyond their limits in 83% of the actions, up to .* rad: degrees\?",
    ),
    "inverted": (
        lambda row, _: changed(row, HANDS, 1 - row),
        "turns both openings over: inverted, or differences",
    ),
    "minus one to one": (
        lambda row, of: 2 * (row - of.log.low) / (of.log.high - of.log.low) - 1,
        "in 100% of the actions, up to 1 rad: normalised, differences, or",
    ),
    "centred openings": (
        lambda row, _: changed(row, HANDS, np.full(14, -1.0)),
        r"openings are -1 to 1; they are 0 \(closed\) to 1 \(open\), not -1 to",
    ),
    "arms first": (
        lambda row, _: row[[*ARMS, *HANDS]],
        "has the numbers of the present posture in another order",
    ),
    "differences": (
        lambda row, of: row - of.observe().vector,
        "turns both openings over: inverted, or differences",
    ),
    "twice": (
        lambda row, _: changed(row, ARMS, np.maximum(2 * row, 0.7)),
        r"is .* rad from the present posture: normalised, differences, or in another",
    ),
}


@pytest.mark.parametrize("language", LANGUAGES)
def test_the_usual_cause_is_named(
    language: str, episode: PolicyEpisode, expert_actions: np.ndarray
) -> None:
    said, cause = LANGUAGES[language]
    for row in expert_actions[:12]:
        episode.act(said(row, episode))
    assert not episode.success
    assert re.search(cause, episode.log.usual_cause()), episode.log.usual_cause()


def test_what_fits_is_not_suspected(episode: PolicyEpisode, expert_actions: np.ndarray) -> None:
    for row in expert_actions[:12]:
        episode.act(row)
    assert episode.log.usual_cause() == "" and episode.log.clipped == {}


def test_what_was_clipped_is_counted_by_its_name(episode: PolicyEpisode) -> None:
    now = episode.observe().vector
    for joint, hand in ((9.0, 0.5), (now[2], 1.2), (9.0, 1.0005)):
        episode.act(np.array([*now[:2], joint, *now[3:13], hand]))
    assert episode.log.clipped == {"left_joint_3": 2, "right_gripper": 1}
    ends = episode.observe().endposes
    episode.act(np.array([*ends["left"], -1.0, *ends["right"], 1.0]), "ee")
    assert episode.log.clipped["left_gripper"] == 1


def test_it_is_in_record_and_summary() -> None:
    def record(seed: int, language: str) -> EpisodeRecord:
        clipped = {"left_joint_1": 3} if language else {}
        return EpisodeRecord("t", "clean", seed, not language, clipped=clipped, language=language)

    causes = ("", "up to 95 rad: degrees?", "up to 102.5 rad: degrees?")
    records = [record(seed, cause) for seed, cause in enumerate(causes)]
    key = ("clean", "t")
    summary = summarise({key: records}, {key: InstanceList("t", "clean", {}, ())})
    (row,) = summary.to_json()["tasks"]  # type: ignore[misc]
    assert row["language"] == "up to 95 rad: degrees? (2 of 3 episodes)"  # type: ignore[index]
    assert row["clipped"] == {"left_joint_1": 6}  # type: ignore[index]
