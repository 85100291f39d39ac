"""The physics in force as numbers, for those who may see it."""

import numpy as np
from numpy.typing import NDArray

from rtphys.episode.instance import Instance
from rtphys.physics import attributes


def numbers(instance: Instance) -> dict[str, NDArray[np.float32]]:
    """Attribute -> (components,) in its own unit.

    Where an attribute is the asset's own, the mean of what the simulator says; 0 where nothing in
    the scene has it.
    """
    found: dict[str, NDArray[np.float32]] = {}
    for key, attribute in attributes().items():
        value = instance.physics[key]
        if value is None:
            read = [np.mean(place) for place in attribute.read(instance.world).values()]
            value = float(np.mean(read)) if read else 0.0
        found[key] = np.atleast_1d(np.asarray(value, np.float32))
    return found
