"""rtphys: physics-diverse bimanual manipulation, every physical label proved.

`rtphys.Dataset` is loaded when first used, so that `import rtphys` stays instant.
"""

from typing import TYPE_CHECKING

from rtphys.core import arithmetic

if TYPE_CHECKING:
    from rtphys.data.dataset import Dataset, Episode

__all__ = ["Dataset", "Episode"]

arithmetic.pin()  # before anything of rtphys loads numpy


def __getattr__(name: str) -> object:
    if name in __all__:
        from rtphys.data import dataset

        return getattr(dataset, name)
    raise AttributeError(f"module 'rtphys' has no attribute {name!r}")
