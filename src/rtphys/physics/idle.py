"""Whether an attribute that somebody asks for could act in a task, and if not, why."""

from collections.abc import Collection, Iterable, Mapping

from rtphys.physics.attribute import Part, attribute
from rtphys.physics.reach import keys_of, reach, split
from rtphys.physics.values import Value

NEEDED = {
    "bodies": "object that can move",
    "joints": "object with joints",
    "surfaces": "object that can be touched",
}


def why_idle(
    key: str, keys: Iterable[str], parts: Mapping[str, Collection[Part]], value: Value = None
) -> str:
    """Why an attribute could not act in a world, as a clause; empty where it could.

    Args:
        key: the attribute, or that of one prop, such as `object_mass@first`.
        keys: all that the episode's physics has: a prop with a key of its own is left to that key.
        parts: prop -> what its world has of it.
        value: at which it is held; None: it is drawn.
    """
    asked, (name, prop), keys = attribute(key), split(key), list(keys)
    if asked.could_act(reach(key, keys).parts(parts), value):
        return ""
    needed = NEEDED.get(str(asked.acts_on), "effect")
    if prop or not asked.could_act(reach(key).parts(parts), value):
        return f"there is no {needed}"
    own = [other for other in keys_of(name, keys) if other != name]
    return f"every {needed} has its own value ({', '.join(own)})"
