"""Policies by name: `NAME` or `NAME:ARGUMENT`, imported only when they are opened."""

from collections.abc import Callable
from importlib import import_module
from typing import NamedTuple

from rtphys.core.errors import UnknownName
from rtphys.policies.policy import Policy, PolicyGone, PolicySetup

Opener = Callable[[str, PolicySetup], Policy]


class Row(NamedTuple):
    """How a policy is opened."""

    place: str  # "module:function", an `Opener`
    usage: str
    what: str


BUILTIN: dict[str, Row] = {
    "idle": Row("rtphys.policies.idle:open_idle", "idle", "does nothing"),
    "random": Row("rtphys.policies.random:open_random", "random", "a random walk of the joints"),
    "expert": Row("rtphys.policies.expert:open_expert", "expert", "the task's own script"),
    "replay": Row(
        "rtphys.policies.replay:open_replay",
        "replay:DATASET",
        "the recorded actions of the same task and seed",
    ),
    "robotwin": Row(
        "rtphys.policies.robotwin.policy:open_robotwin",
        "robotwin:PATH/deploy_policy.py[?key=value]",
        "a RoboTwin plug-in, unmodified",
    ),
    "openpi": Row(
        "rtphys.policies.served.openpi:open_openpi",
        "openpi:HOST:PORT[?execute=N]",
        "a policy behind openpi's websocket server",
    ),
    "xpolicylab": Row(
        "rtphys.policies.served.xpolicylab:open_xpolicylab",
        "xpolicylab:HOST:PORT[?action_type=ee]",
        "a policy behind XPolicyLab's websocket server",
    ),
    "python": Row(
        "rtphys.policies.python:open_python",
        "python:MODULE:ATTRIBUTE",
        "what your own function makes of a PolicySetup",
    ),
}


def parse_spec(spec: str) -> tuple[str, str]:
    """Name and argument; nothing is imported.

    Raises:
        UnknownName: no such policy.
    """
    name, _, argument = spec.partition(":")
    if name not in BUILTIN:
        raise UnknownName("policy", name, BUILTIN)
    return name, argument


def open_policy(spec: str, setup: PolicySetup | None = None) -> Policy:
    """A policy from its specification, `NAME` or `NAME:ARGUMENT`.

    Raises:
        UnknownName: no such policy.
        PolicyGone: an optional part of rtphys is not installed.
        RtphysError: what the policy itself refuses.
    """
    name, argument = parse_spec(spec)
    module, _, function = BUILTIN[name].place.partition(":")
    try:
        opener: Opener = getattr(import_module(module), function)
    except ModuleNotFoundError as error:
        cure = "pip install 'rtphys[serve]'"  # the only part that a policy of ours may lack
        raise PolicyGone(name, f"Python finds no module {error.name!r}; {cure}") from error
    return opener(argument, setup or PolicySetup())
