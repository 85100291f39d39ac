"""Puts an episode's physics in force, and asks the simulator whether it is."""

from rtphys.physics.attribute import Attribute, Reading
from rtphys.physics.handles import Blueprint, World
from rtphys.physics.registry import attributes
from rtphys.physics.values import Physics


def enforce(target: Blueprint | World, physics: Physics) -> None:
    """Apply every value that belongs to this stage: a Blueprint before the build, a World after.

    Nominal numbers are applied too, so that nothing depends on a simulator's defaults; a value of
    None leaves the asset's own.
    """
    stage = "before_build" if isinstance(target, Blueprint) else "after_build"
    for attribute in _told(physics):
        value = physics[attribute.key]
        if attribute.when == stage and value is not None:
            attribute.apply(target, value)


def read_back(world: World, physics: Physics) -> dict[str, dict[str, Reading]]:
    """Key -> place -> what the simulator says, for every attribute: the label of record."""
    return {attribute.key: attribute.read(world) for attribute in _told(physics)}


def disagreements(world: World, physics: Physics) -> list[str]:
    """One sentence for each place where the simulator does not say what `physics` says."""
    wrong: list[str] = []
    for attribute in _told(physics):
        value = physics[attribute.key]
        if value is not None:
            wrong += attribute.disagreements(world, value)
    return wrong


def _told(physics: Physics) -> list[Attribute]:
    return [a.given(physics) for key, a in attributes().items() if key in physics]
