"""Solve the first instances of all certified lists again, and renew the headers of those that hold.

    python scripts/reprove_lists.py [--instances 2] [--write]

A list whose task file was edited has another certification fingerprint. Where its first instances
still go through the same states, to the last bit, `--write` gives it the present fingerprint and
changes nothing else. Exit code 1: a list does not hold; it is named and stays as it is.
"""

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from rtphys.assets.pack import default_pack
from rtphys.campaign.engine import Listener, run_all
from rtphys.campaign.series import Series, Study, Tally
from rtphys.campaign.workers.local import LocalPool, cores
from rtphys.campaign.workers.pool import Limits, Lost
from rtphys.cli.progress import Lines
from rtphys.core import library
from rtphys.episode.fingerprint import fingerprint_of
from rtphys.results.instance_file import read_instances, write_instances
from rtphys.results.instances import BENCHMARK, InstanceList, Slot
from rtphys.setting.setting import Setting
from rtphys.studies.certify.certified_list import Job
from rtphys.studies.certify.run import CertifyWorker
from rtphys.task.spec import load_task


@dataclass
class Reproof(Study[Job, Slot]):
    """The first instances of one list."""

    path: Path
    listed: InstanceList
    differences: list[str] = field(default_factory=list[str])

    def job(self, seed: int) -> Job:
        return Job(Setting(self.listed.task, self.listed.protocol).at(seed), ())

    def reason(self, result: Slot) -> str:
        return ""

    def commit(self, seed: int, result: Slot) -> str:
        (state,) = (slot.state for slot in self.listed.slots if slot.seed == seed)
        if result.state != state:
            now = result.reason or result.state
            self.differences.append(f"{self.path}: seed {seed}: {now}, not {state}")
        return ""

    def lost(self, seed: int, loss: Lost) -> Slot:
        return Slot(seed, loss.reason)

    def series(self, instances: int) -> Series[Job, Slot]:
        seeds = [slot.seed for slot in self.listed.feasible[:instances]]
        return Series(self, Tally(f"{self.listed.task}, {self.listed.protocol}", len(seeds)), seeds)


def reprove(instances: int, listener: Listener) -> list[Reproof]:
    """Solves the first instances of all lists again."""
    folder, pack = library.bundled() / "manifests" / BENCHMARK, default_pack()
    studies = [Reproof(path, read_instances(path)) for path in sorted(folder.glob("*/*.yaml"))]
    series = [study.series(instances) for study in studies]
    with LocalPool[Job, Slot](CertifyWorker(pack), cores(), Limits(), listener.noticed) as pool:
        run_all(series, pool, listener)
    return studies


def renew(study: Reproof) -> bool:
    """Writes the list with the present fingerprint; False if that is the one it has."""
    known = study.listed
    now = fingerprint_of(load_task(known.task), known.protocol, default_pack()).to_json()
    if now == known.fingerprint:
        return False
    write_instances(study.path, replace(known, fingerprint=now))
    return True


def main(arguments: Sequence[str]) -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--instances", type=int, default=2, help="of each list")
    parser.add_argument("--write", action="store_true", help="renew the headers of lists that hold")
    chosen = parser.parse_args(arguments)
    with Lines("instances") as listener:
        studies = reprove(chosen.instances, listener)
    wrong = [line for study in studies for line in study.differences]
    held = [study for study in studies if not study.differences]
    renewed = sum(map(renew, held)) if chosen.write else 0
    print("\n".join(wrong) or "every state is that of the list")
    print(f"{len(held)} of {len(studies)} lists hold, {renewed} have a new header")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
