"""What a RoboTwin plug-in is told: `usr_args` from its YAML file, the run, and overrides."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from rtphys.core import library
from rtphys.core.errors import BadValue
from rtphys.policies.options import literal

ARM_JOINTS = 6  # of each arm of the aloha-agilex


def pairs(words: Sequence[str]) -> dict[str, object]:
    """`--overrides --key value --key value` as a mapping.

    Values are Python literals, or text. (RoboTwin evaluates them as code; we do not.)

    Raises:
        BadValue: a key without a value.
    """
    if len(words) % 2:
        raise BadValue("overrides", words[-1], "it is a key without a value")
    keys = (word.lstrip("-") for word in words[::2])
    return dict(zip(keys, map(literal, words[1::2]), strict=True))


def user_args(
    config: Path | None, run: Mapping[str, object], overrides: Mapping[str, object]
) -> dict[str, object]:
    """What `get_model` receives.

    Args:
        config: the plug-in's YAML file.
        run: what the evaluation decides (`task_name`, `task_config`, `seed`, `instruction_type`,
            ...); it fills what the file leaves out or leaves null.
        overrides: win over both.

    Raises:
        BadFile: the YAML cannot be read.
    """
    told: dict[str, object] = dict(library.read_yaml(config)) if config else {}
    told |= {key: value for key, value in run.items() if told.get(key) is None}
    told |= overrides
    return {**told, "left_arm_dim": ARM_JOINTS, "right_arm_dim": ARM_JOINTS}
