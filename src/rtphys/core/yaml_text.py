"""YAML from anywhere: plain values, few aliases, no key twice, bounded in number and depth."""

import re
from functools import lru_cache
from typing import Any

import yaml

from rtphys.core.bounds import WHOLE_NUMBER, YAML_ALIASES, YAML_DEPTH, YAML_NODES


@lru_cache(maxsize=256)
def parsed(text: str) -> object:
    """The value of a document, cached: every episode reads its domain, and parsing is slow.

    Raises:
        yaml.YAMLError: not YAML, or beyond a bound; has the place.
        ValueError: a value that its tag cannot hold, such as a date of month 13.
    """
    try:
        return yaml.load(text, _Loader)
    except (AttributeError, KeyError, TypeError, OverflowError) as error:
        raise ValueError(f"a value does not fit its tag: {error}") from error


_HALF = re.compile("[\ud800-\udfff]")


class _Loader(yaml.SafeLoader):
    def __init__(self, stream: str) -> None:
        super().__init__(stream)
        self._nodes = self._aliases = 0
        self._open: list[str | None] = []  # anchors of the nodes around this one

    def compose_node(self, parent: Any, index: Any) -> Any:
        event = self.peek_event()
        alias = isinstance(event, yaml.AliasEvent)
        if alias and event.anchor in self._open:
            raise _refused(f"{event.anchor} contains itself", event.start_mark)
        self._nodes += 1
        self._aliases += alias
        self._open.append(None if alias else event.anchor)
        for count, most, what in (
            (self._nodes, YAML_NODES, "values"),
            (len(self._open), YAML_DEPTH, "levels: nested too deeply"),
            (self._aliases, YAML_ALIASES, "aliases"),
        ):
            if count > most:
                raise _refused(f"more than {most} {what}", event.start_mark)
        node = super().compose_node(parent, index)
        self._open.pop()
        if isinstance(node, yaml.ScalarNode) and _HALF.search(node.value):
            raise _refused("half a character (a lone surrogate)", node.start_mark)
        return node

    def construct_mapping(self, node: Any, deep: bool = False) -> Any:
        seen: set[str] = set()
        for key, _ in node.value:
            if isinstance(key, yaml.ScalarNode):
                if key.value in seen:
                    raise _refused(f"key {key.value!r} occurs twice", key.start_mark)
                seen.add(key.value)
        return super().construct_mapping(node, deep)

    def construct_yaml_int(self, node: Any) -> int:
        if len(node.value) > 70 or abs(number := super().construct_yaml_int(node)) > WHOLE_NUMBER:
            raise _refused("a number of more than 64 bits", node.start_mark)
        return number


_Loader.add_constructor("tag:yaml.org,2002:int", _Loader.construct_yaml_int)


def _refused(problem: str, mark: Any) -> yaml.YAMLError:
    return yaml.constructor.ConstructorError(None, None, problem, mark)
