"""Sentences of episodes: what fits, what depends on what, and our own templates."""

import re
from dataclasses import replace
from pathlib import Path

import pytest

from rtphys.core.errors import BadFile, BadValue
from rtphys.task.instructions import (
    check_templates,
    fits,
    instructions,
    placeholders,
    scene_info,
)
from rtphys.task.props import Box, Mesh
from rtphys.task.spec import Phrases, Task, load_task, task_names

TASKS = [name for name in task_names() if load_task(name).source.with_suffix(".yaml").is_file()]
SEEN, UNSEEN = 20, 8


def task(info: dict[str, str], seen: tuple[str, ...]) -> Task:
    def layout(draw):
        spot = draw.spot("bell", (-1, 1), (0, 1))
        yield Mesh(name="bell", category="050_bell", model=1, pose=spot.pose())
        yield Box(
            name="block", half_size=(0.1, 0.1, 0.1), pose=draw.spot("k", (-1, -0.5), (0, 1)).pose(),
            phrase="red block",
        )  # fmt: skip

    return Task(
        layout=layout,
        script=lambda robot: None,
        success=lambda props: None,  # type: ignore[arg-type]
        step_limit=1,
        phrases=Phrases(seen, ("Do it.",)),
        info=info,
        name="made_up",
    )


def describe(prop) -> tuple[str, ...]:
    return ("silver bell", "service bell") if isinstance(prop, Mesh) else ()


INFO = {"A": "bell", "B": "block", "a": "arm:block"}


@pytest.mark.parametrize(
    ("template", "usable"),
    [
        ("Put {A} on {B} with {a}.", True),
        ("Put {A} on {B}.", True),
        ("Do the job.", True),
        ("Put {A} down.", False),
        ("Use {a} on {A}.", False),
        ("Put {A} on {B} with {a} and {b}.", False),
    ],
)
def test_a_template_fits_all_placeholders_or_all_but_the_arms(template: str, usable: bool) -> None:
    assert fits(template, INFO) is usable


def test_placeholders_are_filled_with_phrases_of_the_episode() -> None:
    said = instructions(task(INFO, ("put {A} on {B} with {a}.",)), 3, describe)
    assert said["seen"][0] in {
        "Put the silver bell on the red block with the left arm.",
        "Put the service bell on the red block with the left arm.",
    }
    assert said["unseen"] == ["Do it."]


def test_scene_info_is_what_the_official_file_says() -> None:
    assert scene_info(task(INFO, ("x",)), 3) == {
        "{A}": "050_bell/base1",
        "{B}": "red block",
        "{a}": "left",
    }


def test_an_arm_is_the_side_on_which_the_prop_starts_or_the_other_one() -> None:
    both = {"A": "bell", "a": "arm:bell", "b": "other:bell"}
    pair = task(both, ("Hand {A} from {a} to {b}.",))
    sides = set()
    for seed in range(20):
        said = scene_info(pair, seed)
        a, b = said["{a}"], said["{b}"]
        assert a == ("left" if pair.props(seed)[0].pose.p[0] < 0 else "right")
        assert {a, b} == {"left", "right"}
        sentence = instructions(pair, seed, describe)["seen"][0]
        assert sentence.endswith(f"from the {a} arm to the {b} arm.")
        sides.add(a)
    assert sides == {"left", "right"}


def test_sentences_depend_on_the_seed_alone_and_differ_between_seeds() -> None:
    many = tuple(f"Put {{A}} on {{B}}, way {i}." for i in range(30))
    first = instructions(task(INFO, many), 5, describe)
    assert first == instructions(task(INFO, many), 5, describe)
    assert first["seen"] != instructions(task(INFO, many), 6, describe)["seen"]
    assert len(set(first["seen"])) == len(first["seen"]) == 30


def test_a_template_that_cannot_be_filled_is_refused_by_name() -> None:
    for template in ("Use {b}.", "Use {A.name}.", "Use {A on {B}.", "Use A}."):
        with pytest.raises(BadValue, match=re.escape(template)):
            check_templates(Phrases((template,), ()), INFO, "here")


def test_info_that_names_nothing_is_refused() -> None:
    with pytest.raises(BadValue, match="bel'"):
        scene_info(task({"A": "bel"}, ("x",)), 0)


@pytest.mark.parametrize("text", ["seen: 3", "seen: [a]", "seen: [a]\nunseen: [b]\nother: [c]"])
def test_a_broken_phrase_file_is_refused(tmp_path: Path, text: str) -> None:
    (tmp_path / "made_up.yaml").write_text(text)
    broken = replace(task(INFO, ()), source=tmp_path / "made_up.py", phrases=Phrases((), ()))
    with pytest.raises(BadFile, match=r"made_up\.yaml"):
        broken.sentences()


def test_a_task_without_templates_says_its_first_line() -> None:
    plain = replace(task({}, ()), doc="Ring the bell.\n\nMore.", phrases=Phrases((), ()))
    assert instructions(plain, 0, describe)["seen"] == ["Ring the bell"]


def test_all_tasks_have_templates() -> None:
    assert len(TASKS) >= 50


@pytest.mark.parametrize("name", TASKS)
def test_templates_and_sentences_of_a_task(name: str) -> None:
    loaded = load_task(name)
    phrases = loaded.sentences()
    check_templates(phrases, loaded.info, name)
    both = [*phrases.seen, *phrases.unseen]
    assert len(phrases.seen) >= SEEN
    assert len(phrases.unseen) >= UNSEEN
    assert len(set(both)) == len(both)
    if loaded.info:
        named = {placeholders(template) for template in phrases.seen}
        assert frozenset(loaded.info) in named, "some sentence names every placeholder"
    said = instructions(loaded, 1, lambda prop: ("thing",))
    for sentence in [*said["seen"], *said["unseen"]]:
        assert sentence[0].isupper()
        assert not set("{}") & set(sentence)
        assert sentence.endswith(".")
