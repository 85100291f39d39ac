"""Options of a policy, and which of them it asked for: one that it does not know is misspelt."""

from collections.abc import Iterator, Mapping, MutableMapping
from difflib import get_close_matches
from typing import Any

from rtphys.core.errors import UnknownName


class AskedOptions(dict[str, str]):
    """Options of a policy, and the names of those that it asked for."""

    def __init__(self, options: Any = ()) -> None:
        super().__init__(options)
        self._given = frozenset(super().keys())
        self._asked = set[str]()

    def __getitem__(self, key: str) -> str:
        self._asked.add(key)
        return super().__getitem__(key)

    def __contains__(self, key: object) -> bool:
        self._asked.add(str(key))
        return super().__contains__(key)

    def __iter__(self) -> Iterator[str]:  # `{**options}` and `dict(options)` call `keys`
        self._asked |= self._given
        return super().__iter__()

    def pop(self, key: str, *default: Any) -> Any:
        self._asked.add(key)
        return super().pop(key, *default)

    # Those of any mapping, which ask the three at the top; a dict's own ask nothing.
    get = Mapping.get  # pyright: ignore
    setdefault = MutableMapping.setdefault  # pyright: ignore
    keys, values, items = Mapping.keys, Mapping.values, Mapping.items  # pyright: ignore

    def check(self) -> None:
        """Raises `UnknownName`: one that was not asked for is spelt nearly as one that was.

        What a policy asks for later, or reads all together, nobody knows: it may be so called.
        """
        missing = sorted(self._asked - self._given)
        for key in sorted(self._given - self._asked):
            if get_close_matches(key, missing, n=1):
                raise UnknownName("option of the policy", key, self._asked)
