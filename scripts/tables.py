"""Write the generated tables into README.md: `make tables`; `--check` only compares.

A table stands between `<!-- table: NAME -->` and `<!-- end -->` and is made by the function NAME.
"""

import re
import sys
from collections.abc import Iterable
from pathlib import Path

from rtphys import library
from rtphys.physics import attributes, load_domain
from rtphys.task.rates import rates
from rtphys.task.spec import load_task

PROTOCOLS = ("clean", "phys_random")  # whose measured success rates are shown
README = Path(__file__).resolve().parents[1] / "README.md"


def tasks() -> str:
    """Every bundled task, with the file's own first sentence."""
    domains, measured = library.names("domains"), rates()
    rows = []
    for name in sorted(library.names("tasks")):
        task = load_task(name)
        what = task.doc.strip().partition("\n\n")[0].replace("\n", " ")
        domain = f"`{name}`" if name in domains else "`global`"
        found = measured.get(name, {})
        shown = [str(found.get(protocol, "")) for protocol in PROTOCOLS]
        rows.append((f"`{name}`", what, task.mechanism, task.arms, domain, *shown))
    return _table(("task", "what", "mechanism", "arms", "domain", *PROTOCOLS), rows)


def physics() -> str:
    """Every attribute, with its range in the global domain."""
    rules = load_domain("global").rules
    rows = []
    for key, attribute in attributes().items():
        nominal = "the asset's" if attribute.nominal is None else str(attribute.nominal)
        rows.append((f"`{key}`", attribute.what, attribute.unit, nominal, str(rules.get(key, ""))))
    return _table(("attribute", "what", "unit", "nominal", "global range"), rows)


TABLES = {"tasks": tasks, "physics": physics}


def filled(text: str) -> str:
    """`text` with every table in it made anew."""

    def table(match: re.Match[str]) -> str:
        return f"{match[1]}\n{TABLES[match[2]]()}\n{match[3]}"

    return re.sub(r"(<!-- table: (\w+) -->).*?(<!-- end -->)", table, text, flags=re.DOTALL)


def _table(head: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> str:
    lines = [head, tuple("---" for _ in head), *rows]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)


def main() -> int:
    """0 if the README is up to date, or now is."""
    old = README.read_text()
    new = filled(old)
    if "--check" in sys.argv:
        if old != new:
            print(f"{README.name}: the tables are old; run `make tables`", file=sys.stderr)
        return int(old != new)
    README.write_text(new)
    return 0


if __name__ == "__main__":
    sys.exit(main())
