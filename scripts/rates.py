"""Keep measured rates in manifests/rates.yaml: `scripts/rates.py SOURCE...`.

A source is a folder of `rtphys certify`, or a file of `rtphys check --json`. What several of them
say of one task and protocol is added up: they must be of different seeds. Newer measurements
replace older ones of the same task and protocol, if they are of as many seeds.
"""

import json
import sys
from collections.abc import Iterator
from dataclasses import astuple
from pathlib import Path

from rtphys.results.instance_file import read_instances
from rtphys.results.instances import InstanceList
from rtphys.task.rates import Rate, rates

OUT = Path(__file__).resolve().parents[1] / "manifests" / "rates.yaml"


def measured(source: Path) -> Iterator[tuple[str, str, Rate]]:
    """(task, protocol, rate) of every list in a folder, or of every row of a file."""
    if source.is_dir():
        for path in sorted(source.glob("*/*.yaml")):
            instances = read_instances(path)
            yield instances.task, instances.protocol, certified(instances)
        return
    for row in json.loads(source.read_text()):
        if "domain" in row:  # not what the task is measured by
            continue
        accepted, share = row["accepted"], row["replay_success"]
        replays = (0, 0) if share is None else (accepted, round(share * accepted))
        yield row["task"], row["protocol"], Rate(row["seeds"], accepted, *replays)


def certified(instances: InstanceList) -> Rate:
    """The share of feasible seeds among those tried."""
    alone = [slot.replay for slot in instances.feasible if slot.replay is not None]
    return Rate(instances.attempts, len(instances.feasible), len(alone), sum(alone))


def text(known: dict[str, dict[str, Rate]]) -> str:
    """The file: one line a task and protocol."""
    lines = [
        "# seeds, accepted; accepted episodes that were replayed, whose actions alone succeeded"
    ]
    for task, protocols in sorted(known.items()):
        lines.append(f"{task}:")
        for protocol, rate in sorted(protocols.items()):
            lines.append(f"  {protocol}: [{', '.join(map(str, astuple(rate)))}]")
    return "\n".join(lines) + "\n"


def main(sources: list[str]) -> int:
    """Updates the file."""
    known, found = rates(), dict[tuple[str, str], Rate]()
    for source in sources:
        for task, protocol, rate in measured(Path(source)):
            found[task, protocol] = found.get((task, protocol), Rate(0, 0)) + rate
    for (task, protocol), new in found.items():
        old = known.setdefault(task, {}).get(protocol)
        if old is None or new.seeds >= old.seeds:
            known[task][protocol] = new
    OUT.write_text(text(known))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
