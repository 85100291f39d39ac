"""Sentences of the physics suite: enough of them, and none says which object it is."""

import re

import pytest

from rtphys.core import library
from rtphys.physics.load import domain_for_task
from rtphys.physics.reach import split
from rtphys.task.spec import load_task

SUITE = library.suites()["physics"]
SEEN, UNSEEN = 22, 9
SIDES = {"left", "right", "leftmost", "rightmost", "leftward", "rightward"}
NAMES_A_SIDE = {"sort_by_weight"}  # as its goal: the lightest on the left
ORDER = {"first", "second", "third", "last"}
PLACES = {"near", "nearer", "nearest", "closer", "closest", "far", "farther", "farthest", "front"}
COLOURS = {"red", "green", "blue"}


def hidden(task: str) -> set[str]:
    """Props of a task that have physics of their own."""
    return {prop for _, prop in map(split, domain_for_task(task).keys) if prop}


def answers(task: str) -> set[str]:
    """Words that would say which object it is, or on which side its load is."""
    words = ORDER if task in NAMES_A_SIDE else ORDER | SIDES
    props = hidden(task)
    if len(props) == 1:
        return words  # nothing to choose: the prop is called by its name
    return words | props | PLACES | COLOURS


def given_away(task: str, sentence: str) -> set[str]:
    return answers(task) & set(re.findall(r"[a-z_]+", sentence.lower()))


def plain(sentence: str) -> str:
    """A sentence without what does not make it another one: case and punctuation."""
    return " ".join(re.findall(r"\w+", sentence.lower()))


@pytest.mark.parametrize("task", SUITE)
def test_there_are_enough_sentences_and_unseen_ones_are_new(task: str) -> None:
    phrases = load_task(task).sentences()
    assert len(phrases.seen) >= SEEN
    assert len(phrases.unseen) >= UNSEEN
    every = [plain(sentence) for sentence in (*phrases.seen, *phrases.unseen)]
    assert len(set(every)) == len(every)
    openings = {sentence.split()[0] for sentence in phrases.seen}
    assert not openings & {sentence.split()[0] for sentence in phrases.unseen}


@pytest.mark.parametrize("task", SUITE)
def test_a_sentence_has_no_placeholder_and_gives_no_answer_away(task: str) -> None:
    phrases = load_task(task).sentences()
    for sentence in (*phrases.seen, *phrases.unseen):
        assert not set("{}") & set(sentence), sentence
        assert not given_away(task, sentence), sentence


@pytest.mark.parametrize(
    ("task", "sentence", "word"),
    [
        ("heavy_below", "Stack the second block on the heavy one.", "second"),
        ("sort_by_weight", "Put the third block on the left.", "third"),
        ("bin_the_slippery", "Put the slippery plate on the left into the box.", "left"),
        ("keep_the_bouncy", "Put the bouncy cube, the nearest, into the box.", "nearest"),
        ("open_the_loose", "Open the blue laptop and leave the other.", "blue"),
        ("carry_the_loaded", "Lift the beam, which is heavy on its Right.", "right"),
    ],
)
def test_an_answer_in_a_sentence_is_found(task: str, sentence: str, word: str) -> None:
    assert given_away(task, sentence) == {word}


def test_a_goal_may_name_what_is_no_answer() -> None:
    assert not given_away("sort_by_weight", "Line the blocks up, the lightest on the left.")
    assert not given_away("slide_to_mark", "Slide the puck far over the red line to the mark.")
