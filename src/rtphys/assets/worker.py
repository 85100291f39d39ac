"""A builder process: reads jobs (`kind name index`) line by line, writes each, and reports it."""

import rtphys.core.pinned  # noqa: F401  # isort: skip  (before numpy)

import sys
from pathlib import Path

from rtphys.assets.build import Job, write


def main() -> None:
    """Write every job named on standard input under the folder given as the argument."""
    root = Path(sys.argv[1])
    for line in sys.stdin:
        kind, name, index = line.split()
        print(write(root, Job(kind, name, int(index))), flush=True)


if __name__ == "__main__":
    main()
