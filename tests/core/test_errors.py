"""Words that errors and commands share."""

import pytest

from rtphys.core.errors import counted


@pytest.mark.parametrize(
    ("number", "noun", "text"),
    [
        (0, "episodes", "0 episodes"),
        (1, "episodes", "1 episode"),
        (1, "kept failures", "1 kept failure"),
        (2, "kept failures", "2 kept failures"),
    ],
)
def test_one_is_no_plural(number: int, noun: str, text: str) -> None:
    assert counted(number, noun) == text
