"""Makes the synthetic episodes of tests/data importable."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "data"))
