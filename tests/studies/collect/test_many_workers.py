"""Any number of workers on a slow disk gives what one worker gives."""

from dataclasses import replace
from itertools import product
from pathlib import Path

import pytest
from collecting import complete, content
from robotless import plans, variants

from rtphys.studies.collect import collect
from rtphys.studies.requests import Run

# In the middle one seed 11 is rejected, so that 12 and 13 begin, of which one is enough.
SURPLUS, FIRST, LAST = plans(3, 12)
PLANS = (
    replace(FIRST, episodes=4),
    replace(SURPLUS, episodes=1, first_seed=11),
    replace(LAST),
)

QUICK = [("plain", 3), ("plain", 16), ("failures", 16), ("twin", 16)]
REST = [each for each in product(variants(PLANS), (3, 16)) if each not in QUICK]
CASES = [*QUICK, *(pytest.param(*each, marks=pytest.mark.slow) for each in REST)]


@pytest.mark.usefixtures("without_robot")
@pytest.mark.parametrize(("variant", "workers"), CASES)
def test_many_workers_give_what_one_gives(
    variant: str, workers: int, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    """A seed that was begun to be on the safe side ends long after its task has enough."""
    assert complete(collect(variants(PLANS)[variant], Run(tmp_path / "one", workers=1)))
    request.getfixturevalue("slow_disk")
    assert complete(collect(variants(PLANS)[variant], Run(tmp_path / "many", workers=workers)))
    assert content(tmp_path / "many") == content(tmp_path / "one")
