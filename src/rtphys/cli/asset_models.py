"""The table of `rtphys assets list`: the models of a pack, their sizes and points."""

import fnmatch
from collections.abc import Sequence

from rich.table import Table

from rtphys.assets.model import Articulation, Model
from rtphys.assets.pack import Pack
from rtphys.cli.fitting import fitting_table
from rtphys.core.errors import UnknownName
from rtphys.data.episode import JSON


def facts_of_models(pack: Pack, patterns: Sequence[str]) -> list[dict[str, JSON]]:
    """One row for each model whose object's name matches one of the patterns; all if there is none.

    Raises:
        UnknownName: a pattern that matches nothing; names the nearest match.
    """
    chosen: dict[str, None] = {}
    for pattern in patterns or ["*"]:
        found = fnmatch.filter(pack.names, pattern)
        if not found:
            raise UnknownName("object", pattern, pack.names)
        chosen |= dict.fromkeys(found)
    return [_facts(pack, name, index) for name in chosen for index in pack.indices(name)]


def _facts(pack: Pack, name: str, index: int) -> dict[str, JSON]:
    articulated = pack.is_articulated(name)
    model: Model | Articulation = (pack.articulation if articulated else pack.model)(name, index)
    size = None if isinstance(model, Articulation) else [round(float(x), 4) for x in model.extents]
    return {
        "object": name,
        "model": index,
        "articulated": articulated,
        "size_m": size,
        "mass_kg": None if model.mass_kg is None else round(model.mass_kg, 4),
        "contact_points": len(model.contact_points),
        "functional_points": len(model.functional_points),
        "phrases": list(model.description),
    }


def table_of_models(rows: Sequence[dict[str, JSON]]) -> Table:
    """Sizes are in the model's own frame, mostly y up."""
    title = "models; what has no contact point cannot be grasped"
    columns = ("size x y z [cm]", "mass [g]", "contact", "functional")
    table = fitting_table(["model"], columns, title)
    for row in rows:
        size, mass = row["size_m"], row["mass_kg"]
        table.add_row(
            f"{row['object']}/{row['model']}",
            " ".join(f"{100 * float(str(x)):.1f}" for x in size)
            if isinstance(size, list)
            else "articulated",
            "" if mass is None else f"{1000 * float(str(mass)):.0f}",
            str(row["contact_points"]),
            str(row["functional_points"]),
        )
    return table
