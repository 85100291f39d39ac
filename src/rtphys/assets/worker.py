"""A builder process: reads one job a line (kind, name, number), writes it, says so."""

import sys
from pathlib import Path

from rtphys.assets.build import Job, write


def main() -> None:
    """Write every job named on standard input under the folder given as argument."""
    root = Path(sys.argv[1])
    for line in sys.stdin:
        kind, name, index = line.split()
        print(write(root, Job(kind, name, int(index))), flush=True)


if __name__ == "__main__":
    main()
