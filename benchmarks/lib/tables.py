"""How a benchmark tells its numbers: a table here, JSON in build/benchmarks/."""

import json
from collections.abc import Mapping
from pathlib import Path

OUT = Path(__file__).resolve().parents[2] / "build" / "benchmarks"


def write(name: str, title: str, rows: Mapping[str, Mapping[str, float]]) -> None:
    """Prints rows by name, columns by key; writes `build/benchmarks/<name>.json`."""
    columns = list(next(iter(rows.values())))
    width = max(map(len, rows))
    print(title)
    print(" " * width + "".join(f"  {column:>12}" for column in columns))
    for row, cells in rows.items():
        numbers = (f"  {cells[column]:{max(12, len(column))}.3f}" for column in columns)
        print(f"{row:{width}}" + "".join(numbers))
    OUT.mkdir(parents=True, exist_ok=True)
    (OUT / f"{name}.json").write_text(json.dumps({"title": title, "rows": rows}, indent=2) + "\n")
