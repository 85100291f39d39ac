"""YAML that somebody else wrote: a sentence within seconds, whatever it holds."""

import time
from pathlib import Path

import pytest

from rtphys.core.errors import BadFile
from rtphys.core.library import read_yaml


def bomb(levels: int, wide: int) -> str:
    lines = ["a0: &a0 [x, x]"]
    lines += [f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * wide)}]" for n in range(1, levels)]
    return "\n".join(lines)


HOSTILE = {
    bomb(9, 9): "more than 8 aliases",
    bomb(40, 2): "more than 8 aliases",
    "a: &a [*a]": "a contains itself",
    "a: 1\nb: 2\na: 3": "line 3, column 1: key 'a' occurs twice",
    "a: {b: {c: 1, c: 2}}": "key 'c' occurs twice",
    "a: " + "[" * 100: "nested too deeply",
    "a: " + "[" * 1000: "nested too deeply|maximum nesting depth",  # PyYAML before, from 6.0.4
    "a: " + "9" * 5000: "more than 64 bits",
    "a: 0x" + "f" * 20: "more than 64 bits",
    'a: "\\ud800"': "invalid Unicode character|half a character",
    "- 1\n" * 200_000: "more than 60000 values",
    "{" + "a, " * 300_000: "more than 60000 values",
    "a: !!timestamp x": "does not fit its tag",
    "a: !!int x": "invalid literal",
    "a: !!bool x": "does not fit its tag",
    "a: !!python/object/apply:os.system [ls]": "could not determine a constructor",
    "? [a]\n: 1": "unhashable key",
    "x" * 1_100_000: "the most that is read",
}


@pytest.mark.parametrize("text", HOSTILE, ids=range(len(HOSTILE)))
def test_it_is_refused_in_one_sentence(text: str, tmp_path: Path) -> None:
    path, began = tmp_path / "a.yaml", time.monotonic()
    path.write_text(text)
    with pytest.raises(BadFile, match=HOSTILE[text]) as caught:
        read_yaml(path)
    assert len(str(caught.value)) < 300 and time.monotonic() - began < 3


def test_a_few_aliases_and_a_merge_are_read(tmp_path: Path) -> None:
    path = tmp_path / "a.yaml"
    path.write_text("a: &a {x: 1}\nb: *a\nc: {<<: *a, y: 2}")
    assert read_yaml(path) == {"a": {"x": 1}, "b": {"x": 1}, "c": {"x": 1, "y": 2}}
