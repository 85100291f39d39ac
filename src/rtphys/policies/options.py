"""Options of a policy, and which of them it reads: one that it never reads changes nothing."""

from collections.abc import Collection, Iterator, Mapping, MutableMapping
from difflib import get_close_matches
from typing import Any

from rtphys.core.errors import UnknownName


class AskedOptions(dict[str, str]):
    """Options of a policy, and which of them it has read, by name or all together."""

    def __init__(self, options: Any = ()) -> None:
        super().__init__(options)
        self._given = frozenset(super().keys())
        self._asked = set[str]()  # by name
        self._whole = False

    @property
    def unread(self) -> frozenset[str]:
        """The options that were given and not read so far."""
        return frozenset() if self._whole else self._given - self._asked

    def __getitem__(self, key: str) -> str:
        self._asked.add(key)
        return super().__getitem__(key)

    def __contains__(self, key: object) -> bool:
        self._asked.add(str(key))
        return super().__contains__(key)

    def __iter__(self) -> Iterator[str]:  # `{**options}` and `dict(options)` call `keys`
        self._whole = True
        return super().__iter__()

    # Those of any mapping, which ask the three above; a dict's own ask nothing.
    get = Mapping.get  # pyright: ignore
    pop = MutableMapping.pop  # pyright: ignore
    setdefault = MutableMapping.setdefault  # pyright: ignore
    keys, values, items = Mapping.keys, Mapping.values, Mapping.items  # pyright: ignore

    def copy(self) -> dict[str, str]:
        return {**self}

    def __or__(self, other: Any) -> Any:
        return {**self} | other

    def __ror__(self, other: Any) -> Any:
        return other | {**self}

    def check(self) -> None:
        """Raises `UnknownName`: one that was not asked for is spelt nearly as one that was.

        What a policy asks for later, or reads all together, nobody knows: it may be so called.
        """
        missing = sorted(self._asked - self._given)
        for key in sorted(self._given - self._asked):
            if get_close_matches(key, missing, n=1):
                raise UnknownName("option of the policy", key, self._asked)


def unread_options(policy: str, known: Collection[frozenset[str]]) -> str:
    """A note of the options that a policy has read in no episode; empty where there is none.

    Args:
        known: `PolicySession.unread` after each episode, in whatever process.
    """
    names = sorted(frozenset.intersection(*known)) if known else []
    noun = "option" if len(names) == 1 else "options"
    return f"note: {policy} never read the {noun} {', '.join(names)}" if names else ""
