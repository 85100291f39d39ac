"""What several commands do with their options."""

import pytest

from rtphys.cli.options import expand
from rtphys.core.errors import UnknownName


def test_tasks_are_parted_by_commas_or_by_repeating_the_option() -> None:
    wanted = ("lift_pot", "stack_blocks_three", "stack_blocks_two")
    assert expand(["lift_pot, stack_blocks_*"]) == wanted
    assert expand(["lift_pot", "stack_blocks_*"]) == wanted
    assert expand(["lift_pot,lift_pot"]) == ("lift_pot",)


@pytest.mark.parametrize("text", ["", ",", "lift_pot,lift_pat"])
def test_what_names_no_task_is_refused(text: str) -> None:
    with pytest.raises(UnknownName):
        expand([text])
