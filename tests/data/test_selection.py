"""Which episode is meant: by task, configuration, seed, number, or as a failure."""

from pathlib import Path

import pytest
from collected import keep

from rtphys.core.errors import BadFile, BadValue, UnknownName
from rtphys.data.selection import One, Selection, seed_set


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("kept")
    keep(out, attempts=3)  # of which the last is a failure
    return out


def seeds(data: Path, **wanted) -> list[int]:
    return [one.seed for one in One(**wanted).of_path(data)]


def test_selectors(data: Path) -> None:
    assert seeds(data) == [0, 1]
    assert seeds(data, episode=1) == [1]
    assert seeds(data, failure=0) == [2]
    assert seeds(data, seed="2") == [2], "a seed says by itself that a failure is meant"
    assert seeds(data, task="click_bell", config="phys_random", seed="1:9") == [1, 2]
    assert seeds(data / "manifest.json", episode=0) == [0]
    (failure,) = One(failure=0).of_path(data)
    assert failure.failed and One().of_path(failure.paths.video) == (failure,)


@pytest.mark.parametrize(
    ("wanted", "error", "said"),
    [
        ({"episode": 7}, BadValue, "episodes 0 to 1"),
        ({"failure": 4}, BadValue, "failures 0 to 0"),
        ({"seed": "9"}, BadFile, "no such episode"),
        ({"seed": "x"}, BadValue, "such as 3,7"),
        ({"config": "phys_randm"}, UnknownName, "did you mean 'phys_random'"),
    ],
)
def test_what_is_not_there_is_said(
    data: Path, wanted: dict[str, object], error: type[Exception], said: str
) -> None:
    with pytest.raises(error, match=said):
        seeds(data, **wanted)


def test_a_selection_of_everything_is_everything() -> None:
    assert Selection() == Selection(seed="") and seed_set("seed", "3,5:7") == {3, 5, 6}
