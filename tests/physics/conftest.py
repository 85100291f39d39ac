"""The laboratory of the law tests, and what "obeys" means."""

import pytest

from rtphys.assets.pack import builtin_pack
from rtphys.physics.values import Value
from rtphys.proofs.lab import Lab
from rtphys.proofs.proof import Company, Proof
from rtphys.proofs.run import spell, try_out


@pytest.fixture(scope="session")
def lab() -> Lab:
    return Lab(builtin_pack())


@pytest.fixture
def obeys(lab):
    """Every trial of a law passes."""

    def _obeys(law: Proof, value: Value, company: Company | None = None) -> None:
        trials = try_out(lab, law, value, company or {})
        assert trials
        for t in trials:
            told = (
                f"{t.setting}: {t.what}: law {t.expected:.5g}, measured {t.measured:.5g} {t.unit}"
            )
            assert t.passed, f"{told}, error {t.error:.2%}"

    return _obeys


@pytest.fixture
def caught(lab):
    """A law notices that `apply` is broken: a named trial fails."""

    def _caught(law: Proof, value: Value, by: str) -> None:
        wrong = [t.what for t in try_out(lab, law, value, {}) if not t.passed]
        assert any(by in what for what in wrong), f"{spell(value)}: only {wrong} noticed"

    return _caught
