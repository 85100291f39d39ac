"""Tells Gymnasium of every task. Loads neither SAPIEN nor a task file: importing must be cheap."""

import gymnasium

from rtphys.core import library

NAMESPACE = "rtphys"
ENTRY_POINT = "rtphys.gym.env:TaskEnv"


def env_id(task: str) -> str:
    """`rtphys/<task>-v0`."""
    return f"{NAMESPACE}/{task}-v0"


def register_all() -> None:
    """Register every task of the libraries; what is registered already stays as it is."""
    for task in library.names("tasks"):
        if env_id(task) not in gymnasium.registry:
            # The environment ends episodes by itself: a step limit is known once a task is loaded.
            gymnasium.register(env_id(task), entry_point=ENTRY_POINT, kwargs={"task": task})
