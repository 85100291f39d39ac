"""Runs proofs: finds one per attribute, and tells each trial what it was a trial of."""

import importlib
from collections.abc import Iterator
from dataclasses import replace
from functools import cache

from rtphys.core.errors import UnknownName
from rtphys.physics.registry import attributes
from rtphys.physics.values import Value
from rtphys.proofs.lab import Lab
from rtphys.proofs.proof import Company, Proof, Trial


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


def try_out(lab: Lab, law: Proof, value: Value, company: Company) -> list[Trial]:
    """All trials of one law at one setting, each labelled."""
    held = "".join(f", {k} = {spell(v)}" for k, v in company.items())
    setting = f"{law.key} = {spell(value)}{held}"
    return [replace(trial, setting=setting) for trial in law.run(lab, value, company)]


def prove(lab: Lab, key: str) -> Iterator[Trial]:
    """Every trial of one attribute: each setting alone, then the last one in company."""
    law = proof(key)
    for value in law.settings:
        yield from try_out(lab, law, value, {})
    for company in law.company:
        yield from try_out(lab, law, law.settings[-1], company)


def spell(value: Value) -> str:
    """A value for people."""
    if isinstance(value, tuple):
        return "(" + ", ".join(f"{x:g}" for x in value) + ")"
    return f"{value:g}" if isinstance(value, int | float) else str(value)
