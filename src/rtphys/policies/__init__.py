"""Policies: what decides the actions of an episode."""

from rtphys.policies.policy import (
    Policy,
    PolicyBroken,
    PolicyGone,
    PolicySetup,
    ServerFailed,
    Stepwise,
)
from rtphys.policies.registry import (
    BUILTIN,
    PolicySession,
    check_options,
    check_task,
    files_digest,
    open_policy,
    parse_spec,
)

__all__ = [
    "BUILTIN",
    "Policy",
    "PolicyBroken",
    "PolicyGone",
    "PolicySession",
    "PolicySetup",
    "ServerFailed",
    "Stepwise",
    "check_options",
    "check_task",
    "files_digest",
    "open_policy",
    "parse_spec",
]
