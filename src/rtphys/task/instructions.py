"""Sentences for an episode: templates filled with what its props and arms are called.

A template names props by upper-case placeholders (`{A}`) and arms by lower-case ones (`{a}`), as in
RoboTwin. It fits an episode if its placeholders are those of the task's `info`, or those without
any arm, or if it has none at all.
"""

from collections.abc import Callable, Mapping, Sequence
from string import Formatter

from rtphys.assets.action_layout import SIDES
from rtphys.core.errors import BadValue
from rtphys.core.seeds import Chance
from rtphys.task.props import Articulated, Mesh, Prop
from rtphys.task.spec import Phrases, Task

SENTENCES = 100  # at most, per split (RoboTwin's `language_num`)
ARM = "arm:"  # an info value: the side of the table on which a prop starts
OTHER = "other:"  # and the opposite one: the arm that takes over, or helps

Describe = Callable[[Prop], Sequence[str]]  # noun phrases for a model, without article


def instructions(task: Task, seed: int, describe: Describe) -> dict[str, list[str]]:
    """`{"seen": [...], "unseen": [...]}` of an episode; depends on its task and seed alone.

    Args:
        describe: what the asset pack calls a prop that has no phrase of its own.

    Raises:
        BadValue: a template that cannot be filled, or a task without templates.
    """
    props = {prop.name: prop for prop in task.props(seed)}
    spoken = {letter: _spoken(value, props, describe) for letter, value in task.info.items()}
    phrases, chance = task.sentences(), Chance(seed, task.name)
    check_templates(phrases, task.info, task.name)
    found: dict[str, list[str]] = {}
    for split, templates in (("seen", phrases.seen), ("unseen", phrases.unseen)):
        # Each template once, in an order of its own, each with phrases of its own.
        rng = chance.stream("language", split)
        found[split] = []
        for i in rng.permutation(len(templates))[:SENTENCES]:
            words = {key: terms[int(rng.integers(len(terms)))] for key, terms in spoken.items()}
            text = templates[int(i)].format(**words)
            found[split].append(text[:1].upper() + text[1:])
    return found


def scene_info(task: Task, seed: int) -> dict[str, str]:
    """`{"{A}": "050_bell/base0", "{a}": "left"}`, as the official `scene_info.json` has it."""
    props = {prop.name: prop for prop in task.props(seed)}
    return {f"{{{letter}}}": _official(value, props) for letter, value in task.info.items()}


def placeholders(template: str) -> frozenset[str]:
    """What stands in braces. Raises `ValueError`: braces that do not match."""
    return frozenset(field for _, field, _, _ in Formatter().parse(template) if field is not None)


def fits(template: str, info: Mapping[str, str]) -> bool:
    """Whether a template says neither more nor less than the episode has."""
    named, letters = placeholders(template), frozenset(info)
    return named in (letters, frozenset(x for x in letters if not x.islower()), frozenset())


def check_templates(phrases: Phrases, info: Mapping[str, str], where: str) -> None:
    """Raises `BadValue`, which names the template, where one cannot be filled."""
    allowed = ", ".join(f"{{{letter}}}" for letter in info) or "none"
    for split in ("seen", "unseen"):
        for template in getattr(phrases, split):
            problem = f"its placeholders must be {allowed}, or these without the arms, or none"
            try:
                if not fits(template, info):
                    raise BadValue(split, template, problem, where)
            except ValueError as error:
                raise BadValue(split, template, f"{error}; {problem}", where) from error


def check_sentences(task: Task) -> None:
    """Raises `BadFile`, `BadValue`: the sentences of a task cannot be read or filled."""
    check_templates(task.sentences(), task.info, str(task.source))


def _spoken(value: str, props: Mapping[str, Prop], describe: Describe) -> Sequence[str]:
    """Every noun phrase, with article, for the value of one placeholder."""
    official = _official(value, props)
    if value in SIDES or value.startswith((ARM, OTHER)):
        return [f"the {official} arm"]
    prop = props[value]
    phrases = [prop.phrase] if prop.phrase else list(describe(prop)) or [value.replace("_", " ")]
    return [f"the {phrase.removeprefix('the ')}" for phrase in phrases]


def _official(value: str, props: Mapping[str, Prop]) -> str:
    if value in SIDES:
        return value
    name = value.removeprefix(ARM).removeprefix(OTHER)
    if name not in props:
        known = ", ".join([*props, *(f"{kind}{p}" for kind in (ARM, OTHER) for p in props), *SIDES])
        raise BadValue("info", value, f"it is one of {known}")
    prop = props[name]
    if value.startswith((ARM, OTHER)):
        starts_left = bool(prop.pose.p[0] < 0)
        return "left" if starts_left is value.startswith(ARM) else "right"
    if prop.label:
        return prop.label
    if isinstance(prop, Mesh | Articulated):
        return f"{prop.category}/base{prop.model}"
    return prop.phrase or prop.name.replace("_", " ")
