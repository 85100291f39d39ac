"""The simulated world; the only package that imports sapien."""

import rtphys.core.pinned  # noqa: F401  # isort: skip  (before numpy)

from rtphys.core.deferred import deferred

with deferred("requests"):  # it would fetch the part of PhysX that runs on GPUs
    import sapien  # noqa: F401
