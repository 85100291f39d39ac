"""Every model of the catalogue, made once in a process."""

from functools import cache

from rtphys.assets.asset_model import ArticulatedModel, AssetModel
from rtphys.assets.objects import catalogue

NAMES = [(name, i) for name, makers in catalogue().items() for i in makers]


@cache
def made(name: str, index: int) -> AssetModel | ArticulatedModel:
    return catalogue()[name][index]()


RIGID = [key for key in NAMES if isinstance(made(*key), AssetModel)]
ARTICULATED = [key for key in NAMES if key not in RIGID]
