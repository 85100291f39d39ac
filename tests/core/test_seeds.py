"""Streams of random numbers: reproducible, independent, and keyed by seed and name."""

import pytest

from rtphys.core.seeds import stream


def numbers(seed: int, *name: str) -> list[int]:
    return stream(seed, *name).integers(0, 2**32, 3).tolist()


def test_a_stream_gives_the_numbers_that_datasets_were_drawn_with() -> None:
    assert numbers(7, "friction") == [3631938527, 2016962310, 506245464]


def test_every_part_of_the_key_matters() -> None:
    keys = [(7, "a", "b"), (7, "ab"), (7, "b", "a"), (7, "a", "b", ""), (8, "a", "b"), (7,)]
    draws = {tuple(numbers(*key)) for key in keys}
    assert len(draws) == len(keys)


def test_a_stream_does_not_know_of_others() -> None:
    first = stream(3, "layout")
    stream(3, "physics").random(100)
    assert first.integers(0, 2**32, 3).tolist() == numbers(3, "layout")


def test_a_negative_seed_is_refused() -> None:
    with pytest.raises(ValueError, match="never negative, got -1"):
        stream(-1, "layout")
