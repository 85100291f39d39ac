"""Object generators, one module a family. A module is found by being here; see docs/objects.md.

Each module holds `MODELS`: id_name -> model number -> function without arguments that returns a
AssetModel (rigid) or a ArticulatedModel (articulated).
"""

import pkgutil
from collections.abc import Callable, Mapping
from functools import cache
from importlib import import_module

from rtphys.assets.asset_model import ArticulatedModel, AssetModel

Maker = Callable[[], AssetModel | ArticulatedModel]
Models = Mapping[str, Mapping[int, Maker]]


@cache
def catalogue() -> dict[str, dict[int, Maker]]:
    """All makers, sorted by id_name and number.

    Raises:
        ValueError: two modules claim the same id_name.
    """
    found: dict[str, dict[int, Maker]] = {}
    owners: dict[str, str] = {}
    for module in sorted(pkgutil.iter_modules(__path__), key=lambda m: m.name):
        models: Models = import_module(f"{__name__}.{module.name}").MODELS
        for id_name, makers in models.items():
            if id_name in owners:
                raise ValueError(f"{id_name} is made by {owners[id_name]} and by {module.name}")
            owners[id_name] = module.name
            found[id_name] = dict(sorted(makers.items()))
    return dict(sorted(found.items()))
