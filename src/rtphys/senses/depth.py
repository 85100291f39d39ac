"""Depth: how far away what a pixel shows is, along the camera's axis."""

import numpy as np

from rtphys.senses.sense import Array, Arrays, Field, Pixels, Sense

MM = 1000.0  # official depths are in millimetres
DEPTH_STEPS = 64  # of a mm: rounded to 16 um, a file has a quarter of the bytes, in half the time
DEPTH_SCALE = DEPTH_STEPS * MM  # steps of a metre


class Depth(Sense):
    """Distance along the optical axis [m] in memory, [mm] in files."""

    name = "depth"
    scope = "pixel"
    size = 8
    fields = (
        Field(
            "depth",
            ("observation/{camera}/depth", "vision/{view}/depths"),
            np.float32,
            ("H", "W"),
            low=0,
            encoding="mm",
            notes=(("unit", "mm along the optical axis; 0: nothing"),),
        ),
    )

    def capture(self, source: Pixels) -> Arrays:
        return {"depth": source.depth()}


def to_mm(depth: Array) -> Array:
    """Official depth of metres, float32."""
    steps = depth.astype(np.float64)
    steps *= DEPTH_SCALE
    np.rint(steps, out=steps)
    steps /= DEPTH_STEPS
    return steps


def to_metres(depth: Array) -> Array:
    """Inverse of `to_mm`, to the last bit, for depths that `renderer.sensed` gave."""
    return (depth * DEPTH_STEPS).astype(np.float32) / np.float32(DEPTH_SCALE)
