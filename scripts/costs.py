"""Update what an episode costs in manifests/costs.yaml: `scripts/costs.py`.

The numbers are those with which Training Set v1 was made (manifests/training_v1.digests.json).
`collect --dry-run` and the table in docs/scale.md are made from the file.
"""

from pathlib import Path

from rtphys.data import schema
from rtphys.data.state_digests import Digests
from rtphys.studies.rates import PROTOCOL, Cost, costs

MANIFESTS = Path(__file__).resolve().parents[1] / "manifests"


def main() -> None:
    """Updates the tasks that the training set has."""
    known = costs()
    for task, made in schema.read(Digests, MANIFESTS / "training_v1.digests.json").tasks.items():
        count = len(made.episodes)
        known[task] = Cost(made.cpu_seconds / count, made.bytes / count / 1e6)
    lines = [f"# of an accepted episode under {PROTOCOL}: CPU-s with failed attempts, and MB"]
    lines += [
        f"{task}: [{one.cpu:.1f}, {one.megabytes:.1f}]" for task, one in sorted(known.items())
    ]
    (MANIFESTS / "costs.yaml").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
