"""Update measured success rates in manifests/rates.yaml: `scripts/rates.py SOURCE...`.

A source is a folder of `rtphys certify`, or a file of what `rtphys check --json` prints. Several
sources of one task and protocol are added up, so they must be of different seeds. What a list says
replaces what the file has; a check does so if it is of at least as many seeds.
"""

import json
import sys
from collections.abc import Iterator
from dataclasses import astuple
from pathlib import Path

from rtphys.results.instances import read_lists
from rtphys.studies.rates import Rate, rates

SHOWN = ("clean", "official_random", "phys_random", "phys_random_all")  # by `rtphys tasks`
OUT = Path(__file__).resolve().parents[1] / "manifests" / "rates.yaml"


def measured(source: Path) -> Iterator[tuple[str, str, Rate]]:
    """(task, protocol, rate) of every list in a folder, or every row of a file."""
    if source.is_dir():
        for path in sorted(source.glob("*.jsonl")):
            for task, listed in read_lists(path).items() if path.stem in SHOWN else ():
                yield task, path.stem, Rate(listed.attempts, len(listed.feasible))
        return
    for row in json.loads(source.read_text()):
        if "domain" in row:  # another domain than the task's own
            continue
        yield row["task"], row["protocol"], Rate(row["seeds"], row["accepted"])


def text(known: dict[str, dict[str, Rate]]) -> str:
    """Text of the file: one line per task and protocol."""
    lines = ["# seeds, accepted"]
    for task, protocols in sorted(known.items()):
        lines.append(f"{task}:")
        for protocol, rate in sorted(protocols.items()):
            lines.append(f"  {protocol}: [{', '.join(map(str, astuple(rate)))}]")
    return "\n".join(lines) + "\n"


def main(sources: list[str]) -> int:
    """Update the file."""
    known, new = rates(), dict[tuple[str, str], Rate]()
    listed = set[tuple[str, str]]()
    for source in map(Path, sources):
        for task, protocol, rate in measured(source):
            new[task, protocol] = new.get((task, protocol), Rate(0, 0)) + rate
            if source.is_dir():
                listed.add((task, protocol))
    for (task, protocol), rate in new.items():
        old = known.setdefault(task, {}).get(protocol)
        if old is None or (task, protocol) in listed or rate.seeds >= old.seeds:
            known[task][protocol] = rate
    OUT.write_text(text(known))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
