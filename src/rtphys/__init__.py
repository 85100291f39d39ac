"""rtphys: physics-diverse bimanual manipulation, every physical label proved.

`rtphys.Dataset` is loaded when first used, so that `import rtphys` stays instant.
"""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rtphys.data.dataset import Dataset, Episode

    __version__: str

__all__ = ["Dataset", "Episode", "__version__"]


def __getattr__(name: str) -> object:
    if name == "__version__":
        from importlib.metadata import version

        return version("rtphys")
    if name in __all__:
        from rtphys.data import dataset

        return getattr(dataset, name)
    raise AttributeError(f"module 'rtphys' has no attribute {name!r}")


def __dir__() -> list[str]:
    """For completion by Tab: what is loaded, and what would be."""
    return sorted({*globals(), *__all__})
