"""Which options a policy has asked for when it is opened, in whatever way."""

import json
from collections.abc import Callable, Mapping
from copy import deepcopy
from typing import Any

import pytest

from rtphys.core.errors import UnknownName
from rtphys.policies.options import AskedOptions

GIVEN = {"lwo": "0.9", "height": "0.03"}
WHOLE: list[Callable[[Any], Mapping[str, str]]] = [
    dict,
    deepcopy,
    lambda options: {**options},
    lambda options: dict(**options),
    lambda options: options.copy(),
    lambda options: options | {},
    lambda options: {} | options,
    lambda options: {key: options[key] for key in options},
    lambda options: dict(options.items()),
    lambda options: dict(zip(options.keys(), options.values(), strict=True)),
    lambda options: json.loads(json.dumps(options)),
]


@pytest.mark.parametrize("whole", WHOLE)
def test_options_that_are_read_all_together_may_be_called_as_they_are(
    whole: Callable[[Any], Mapping[str, str]],
) -> None:
    options = AskedOptions(GIVEN)
    assert options.get("low") is None
    assert whole(options) == GIVEN
    options.check()


@pytest.mark.parametrize(
    "one",
    [
        lambda options: options.get("low", "1"),
        lambda options: options.pop("low", "1"),
        lambda options: options.setdefault("low", "1"),
        lambda options: "low" in options,
    ],
)
def test_an_option_that_is_spelt_nearly_as_one_that_was_asked_for_is_refused(
    one: Callable[[Any], object],
) -> None:
    options = AskedOptions(GIVEN)
    options.check()
    one(options)
    with pytest.raises(UnknownName, match="option of the policy 'lwo'; did you mean 'low'"):
        options.check()
