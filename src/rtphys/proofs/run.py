"""Runs the proof of an attribute at each of its settings."""

import importlib
from collections.abc import Iterator
from dataclasses import replace
from functools import cache

from rtphys.core.errors import UnknownName
from rtphys.physics.registry import attributes
from rtphys.physics.values import Value
from rtphys.proofs.lab import Lab
from rtphys.proofs.proof import Proof, Trial, Values


@cache
def proof(key: str) -> Proof:
    """The proof of one bundled attribute.

    Raises:
        UnknownName: no attribute of that key has a proof.
    """
    try:
        module = importlib.import_module(f"rtphys.proofs.{key}")
    except ModuleNotFoundError:
        raise UnknownName("proof", key, attributes()) from None
    return module.PROOF


def run_trials(lab: Lab, law: Proof, value: Value, others: Values) -> list[Trial]:
    """All trials of one law at one setting, each with the setting filled in."""
    if others == law.company:
        setting = f"{law.key} = {value_text(value)}, in company with all"
    else:
        together = {law.key: value, **others}
        setting = ", ".join(f"{k} = {value_text(v)}" for k, v in together.items())
    return [replace(trial, setting=setting) for trial in law.run(lab, value, others)]


def prove(lab: Lab, key: str) -> Iterator[Trial]:
    """All trials of one attribute: each setting alone and with all others varied, then the last
    one beside extreme values of a few."""
    law = proof(key)
    for others in ({}, law.company):
        for value in law.settings:
            yield from run_trials(lab, law, value, others)
    for others in law.others:
        yield from run_trials(lab, law, law.settings[-1], others)


def value_text(value: Value) -> str:
    """A value as short text, such as "0.3" or "(0, 0, 0.015)"."""
    if isinstance(value, tuple):
        return "(" + ", ".join(f"{x:g}" for x in value) + ")"
    return f"{value:g}" if isinstance(value, int | float) else str(value)
