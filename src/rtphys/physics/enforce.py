"""Writes an episode's physics into the simulator, and checks that the simulator has it."""

from collections.abc import Collection

from rtphys.physics.attribute import AnyAttribute, Part, Reading
from rtphys.physics.handles import Blueprint, World
from rtphys.physics.registry import attributes
from rtphys.physics.values import Physics


def enforce(target: Blueprint | World, physics: Physics) -> None:
    """Apply all values that belong to this stage: a Blueprint before the build, a World after it.

    Nominal values are applied too, so that nothing depends on the simulator's defaults. None keeps
    the asset's own value.
    """
    stage = "before_build" if isinstance(target, Blueprint) else "after_build"
    for attribute in _for_episode(physics):
        value = physics[attribute.key]
        if attribute.when == stage and value is not None:
            attribute.apply(target, value)


def acting(physics: Physics, parts: Collection[Part]) -> frozenset[str]:
    """Keys of the attributes that change anything in an episode whose world has these parts."""
    return frozenset(a.key for a in _for_episode(physics) if a.acts(parts, physics[a.key]))


def read_back(world: World, physics: Physics) -> dict[str, dict[str, Reading]]:
    """Attribute key -> name of body, surface or joint -> the simulator's value, in label units."""
    return {attribute.key: attribute.read(world) for attribute in _for_episode(physics)}


def disagreements(world: World, physics: Physics) -> list[str]:
    """One sentence for each value of `physics` that the simulator does not have."""
    wrong: list[str] = []
    for attribute in _for_episode(physics):
        value = physics[attribute.key]
        if value is not None:
            wrong += attribute.disagreements(world, value)
    return wrong


def _for_episode(physics: Physics) -> list[AnyAttribute]:
    return [a.for_episode(physics) for key, a in attributes().items() if key in physics]
