"""Stale lists are proved again: those whose states agree get the present fingerprint."""

from dataclasses import replace
from pathlib import Path

import pytest
from typer.testing import CliRunner

from rtphys.assets.pack import Pack, default_pack
from rtphys.cli.main import app
from rtphys.core.errors import BadValue
from rtphys.episode.fingerprint import fingerprint_of
from rtphys.results.instance_file import instance_file, read_instances, write_instances
from rtphys.studies.certify.plan import CertifyPlan
from rtphys.studies.certify.reprove import reprove
from rtphys.studies.certify.run import certify
from rtphys.task.spec import load_task

pytestmark = pytest.mark.sim


@pytest.fixture(scope="module")
def pack() -> Pack:
    return default_pack()


@pytest.fixture(scope="module")
def benchmark(tmp_path_factory: pytest.TempPathFactory, pack: Pack) -> Path:
    out = tmp_path_factory.mktemp("benchmark")
    certify(plan(out), pack)
    return out


def plan(out: Path, reproofs: int = 0) -> CertifyPlan:
    known = CertifyPlan(("click_bell",), ("clean",), out, 2, baselines=("none",), workers=1)
    return replace(known, reprove=reproofs)


def age(path: Path, state: str = "") -> bytes:
    """Makes a list stale, and its first state another one; returns the bytes of before."""
    before, known = path.read_bytes(), read_instances(path)
    old = {**known.fingerprint, "versions": {"code": "of another day"}}
    first, *rest = known.slots
    slots = (replace(first, state=state or first.state), *rest)
    write_instances(path, replace(known, fingerprint=old, slots=slots))
    return before


def test_a_stale_list_that_holds_gets_the_present_fingerprint_and_nothing_else(
    benchmark: Path, pack: Pack
) -> None:
    path = instance_file(benchmark, "clean", "click_bell")
    before = age(path)
    (study,) = reprove(plan(benchmark, 1), pack)
    assert study.stale and study.renewed and study.solved == 1 and not study.differences
    assert path.read_bytes() == before
    now = fingerprint_of(load_task("click_bell"), "clean", pack).to_json()
    assert read_instances(path).fingerprint == now


def test_a_list_that_differs_stays_stale_and_is_named(benchmark: Path) -> None:
    path = instance_file(benchmark, "clean", "click_bell")
    before = age(path, state="0" * 16)
    damaged = path.read_bytes()
    words = ["certify", "--task", "click_bell", "--protocol", "clean", "--out", str(benchmark)]
    done = CliRunner().invoke(app, [*words, "--reprove", "2", "--workers", "1"])
    assert done.exit_code == 1, done.output
    assert "click_bell.yaml: seed 100000: now state" in done.stdout
    assert "0 of 1 lists hold (2 instances solved again); 0 have a new header, 1 stay stale" in (
        " ".join(done.stdout.split())
    )
    assert path.read_bytes() == damaged
    path.write_bytes(before)


def test_a_folder_without_lists_is_refused(tmp_path: Path, pack: Pack) -> None:
    with pytest.raises(BadValue, match="lists of these tasks"):
        reprove(plan(tmp_path, 1), pack)
