"""Sizes of the official models, measured from their published metadata (official_sizes.csv).

The metadata boxes of round models are up to sqrt 2 too wide, so a builtin model may be narrower.
"""

import csv
from pathlib import Path

SIZES: dict[tuple[str, int], tuple[float, float, float]] = {}  # (id_name, model) -> x, y, z [m]

with (Path(__file__).parent / "official_sizes.csv").open(newline="") as table:
    for row in csv.DictReader(table):
        size = tuple(float(row[key]) / 100 for key in ("x_cm", "y_cm", "z_cm"))
        SIZES[row["id_name"], int(row["model"])] = (size[0], size[1], size[2])
