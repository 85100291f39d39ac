"""Keep measured rates: `rtphys check '*' --json F`, then `scripts/rates.py F`.

Newer measurements replace older ones of the same task and protocol, if they are of as many seeds.
"""

import json
import sys
from pathlib import Path

from rtphys.task.rates import Rate, rates

OUT = Path(__file__).resolve().parents[1] / "manifests" / "rates.yaml"


def main(files: list[str]) -> int:
    known = rates()
    for name in files:
        for row in json.loads(Path(name).read_text()):
            new = Rate(row["seeds"], row["accepted"], row["replay_success"])
            old = known.setdefault(row["task"], {}).get(row["protocol"])
            if old is None or new.seeds >= old.seeds:
                known[row["task"]][row["protocol"]] = new
    lines = ["# seeds, accepted, share of accepted episodes whose actions alone succeed"]
    for task, protocols in sorted(known.items()):
        lines.append(f"{task}:")
        for protocol, rate in sorted(protocols.items()):
            replay = "null" if rate.replay is None else f"{rate.replay:.3f}"
            lines.append(f"  {protocol}: [{rate.seeds}, {rate.accepted}, {replay}]")
    OUT.write_text("\n".join(lines) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
