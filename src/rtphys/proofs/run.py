"""Runs the proof of an attribute at each of its settings."""

import importlib
from collections.abc import Iterator, Sequence
from dataclasses import replace
from types import ModuleType

from rtphys.core import library
from rtphys.core.errors import BadFile, RtphysError, UnknownName
from rtphys.core.python_file import load_file
from rtphys.physics.registry import attributes
from rtphys.physics.values import Value
from rtphys.proofs.lab import Lab
from rtphys.proofs.proof import Proof, Trial, Values


class Unproved(RtphysError):
    """An attribute of a user's library that comes with no experiment."""


def proof(key: str) -> Proof:
    """The proof of one attribute: a bundled one, or `PROOF` of a library's `proofs/<key>.py`.

    Raises:
        UnknownName: there is no such attribute.
        Unproved: it has no proof.
        BadFile: the file raises when it is imported, or has no `PROOF` of this key.
    """
    if key not in attributes():
        raise UnknownName("attribute", key, attributes())
    files = [root / "proofs" / f"{key}.py" for root in library.roots()]
    own = next((file for file in files if file.is_file()), None)
    module = load_file(own, "proofs") if own else _bundled(key)
    law = getattr(module, "PROOF", None)
    if not isinstance(law, Proof) or law.key != key:
        raise BadFile(module.__file__ or key, f"must define PROOF, a Proof with key = {key!r}")
    return law


def laws_of(keys: Sequence[str] | None) -> tuple[list[Proof], list[str]]:
    """The proofs of these attributes, or of all; why some of all have none. Raises as `proof`."""
    laws, without = [], []
    for key in keys or attributes():
        try:
            laws.append(proof(key))
        except Unproved as error:
            if keys:
                raise
            without.append(str(error))
    return laws, without


def _bundled(key: str) -> ModuleType:
    try:
        return importlib.import_module(f"rtphys.proofs.{key}")
    except ModuleNotFoundError:
        file = f"proofs/{key}.py of its library"
        raise Unproved(f"attribute {key} has no experiment: {file} does not exist") from None


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
