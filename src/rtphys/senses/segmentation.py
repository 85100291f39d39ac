"""Segmentation: which body a pixel shows, and which mesh of it."""

import numpy as np

from rtphys.senses.sense import Arrays, Field, Pixels, Sense

KINDS = ("actor", "mesh")


def _ids(kind: str, name: str) -> Field:
    keys = f"observation/{{camera}}/{kind}_segmentation", f"vision/{{view}}/{kind}_segmentation"
    shape = ("H", "W")
    return Field(name, keys, np.uint8, shape, low=0, high=255, encoding="palette", ids=kind)


class Segmentation(Sense):
    """Ids in memory, the official palette's colours in files, which name each id."""

    name = "segmentation"
    scope = "pixel"
    size = 6
    fields = (_ids("actor", "actors"), _ids("mesh", "meshes"))

    def capture(self, source: Pixels) -> Arrays:
        return {"actors": source.actors(), "meshes": source.meshes()}
