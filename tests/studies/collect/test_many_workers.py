"""Any number of workers on a slow disk gives what one worker gives."""

from dataclasses import replace
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


@pytest.mark.usefixtures("without_robot")
@pytest.mark.parametrize("variant", variants(PLANS))
def test_many_workers_give_what_one_gives(
    variant: str, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    """A seed that was begun to be on the safe side ends long after its task has enough."""
    assert complete(collect(variants(PLANS)[variant], Run(tmp_path / "1", workers=1)))
    request.getfixturevalue("slow_disk")
    for size in (3, 16):
        assert complete(collect(variants(PLANS)[variant], Run(tmp_path / str(size), workers=size)))
        assert content(tmp_path / str(size)) == content(tmp_path / "1")
