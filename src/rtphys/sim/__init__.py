"""The simulated world; the only package that imports sapien."""

from rtphys.core.deferred import deferred

with deferred("requests"):  # it would fetch the part of PhysX that runs on GPUs
    import sapien  # noqa: F401
