"""Update what an episode costs in manifests/costs.yaml: `scripts/costs.py BENCH.json`.

The file is what `rtphys bench --protocol phys_random_all --json` prints. `collect --dry-run` and
the table in docs/scale.md are made from it.
"""

import json
import sys
from pathlib import Path

from rtphys.task.rates import PROTOCOL, Cost, costs

OUT = Path(__file__).resolve().parents[1] / "manifests" / "costs.yaml"


def main(bench: str) -> None:
    """Updates the file."""
    known = costs()
    for row in json.loads(Path(bench).read_text())["rows"]:
        if row["protocol"] == PROTOCOL and row["accepted"]:
            attempt, pictures = row["attempt_cpu_s"]["sum"], row["pictures_cpu_s"]["sum"]
            known[row["task"]] = Cost(attempt, pictures, row["episode_bytes"] / 1e6)
    lines = [f"# under {PROTOCOL}: CPU-s of an attempt, CPU-s and MB of an episode's files"]
    for task, one in sorted(known.items()):
        lines.append(f"{task}: [{one.attempt:.2f}, {one.pictures:.1f}, {one.megabytes:.1f}]")
    OUT.write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main(sys.argv[1])
