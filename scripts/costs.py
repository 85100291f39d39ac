"""Write what an episode costs into manifests/costs.yaml: `scripts/costs.py`.

The numbers are those with which Training Set v1 was made (manifests/training_v1.digests.json).
`collect --dry-run` and the table in docs/scale.md are made from the file.
"""

from pathlib import Path

from rtphys.data import schema
from rtphys.data.state_digests import Digests
from rtphys.studies.rates import PROTOCOL

MANIFESTS = Path(__file__).resolve().parents[1] / "manifests"


def main() -> None:
    """One line a task."""
    lines = [f"# of an accepted episode under {PROTOCOL}: CPU-s with failed attempts, and MB"]
    made = schema.read(Digests, MANIFESTS / "training_v1.digests.json").tasks
    for task, one in sorted(made.items()):
        count = len(one.episodes)
        lines.append(f"{task}: [{one.cpu_seconds / count:.1f}, {one.bytes / count / 1e6:.1f}]")
    (MANIFESTS / "costs.yaml").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
