"""Object generators, one module for each family; every module in this folder is found.

Each module defines `MODELS`: id_name -> model number -> function without arguments that returns an
`AssetModel` (rigid) or an `ArticulatedModel`. See docs/objects.md.
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
    """All generators, sorted by id_name and model number.

    Raises:
        ValueError: two modules define the same id_name.
    """
    makers: dict[str, dict[int, Maker]] = {}
    owners: dict[str, str] = {}
    for module in sorted(pkgutil.iter_modules(__path__), key=lambda m: m.name):
        models: Models = import_module(f"{__name__}.{module.name}").MODELS
        for id_name, numbered in models.items():
            if id_name in owners:
                raise ValueError(f"{id_name} is made by {owners[id_name]} and by {module.name}")
            owners[id_name] = module.name
            makers[id_name] = dict(sorted(numbered.items()))
    return dict(sorted(makers.items()))
