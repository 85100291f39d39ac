"""What comes out of files that others may have written: names, paths, bytes, JSON, YAML.

What lies in a dataset is an ordinary file that is reached from the dataset's folder through
ordinary folders, never through a link. docs/trust.md lists what is refused.
"""

import errno
import hashlib
import json
import math
import os
import re
import stat
from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any, TypeAlias

import yaml

from rtphys.core.bounds import (
    FILE_BYTES,
    JSON_BYTES,
    JSON_DEPTH,
    JSON_ITEMS,
    NAME_BYTES,
    WHOLE_NUMBER,
    YAML_ALIASES,
    YAML_DEPTH,
)
from rtphys.core.errors import BadFile, shortened

LINK = "is a link, which may lead anywhere; copy the folder with `cp -rL`"
LONGEST_NAME = 255  # [bytes] of a file, on every file system that matters


def plain_name(name: str) -> str:
    """The name itself. Raises `ValueError`: it is no plain component of a path."""
    if not name or name.startswith(".") or name != name.strip():
        raise ValueError("a name is not empty and begins with no dot and no space")
    if not name.isprintable() or any(sign in name for sign in "/\\"):
        raise ValueError("a name holds no slash and no control character")
    if len(os.fsencode(name)) > NAME_BYTES:
        raise ValueError(f"a name has at most {NAME_BYTES} bytes")
    return name


def hidden(path: Path, suffix: str) -> Path:
    """A file or folder beside `path` for work on it, such as `.data.part`; of any name's length."""
    name = f".{path.name}{suffix}"
    if len(os.fsencode(name)) > LONGEST_NAME:
        name = f".{hashlib.sha256(os.fsencode(path.name)).hexdigest()[:32]}{suffix}"
    return path.with_name(name)


def check_inside(root: Path, path: Path) -> None:
    """Refuses a path below `root` that leads through a link. What does not exist passes.

    Raises:
        BadFile: names the link.
    """
    place = os.fspath(root)
    for part in path.relative_to(root).parts:
        place = os.path.join(place, part)  # noqa: PTH118 - a path object takes ten times as long
        if os.path.islink(place):  # noqa: PTH114
            raise BadFile(place, LINK)


def open_ordinary(path: Path, *, links: bool = False) -> int:
    """A descriptor of an ordinary file, to be read. A FIFO or a device is never waited for.

    Args:
        links: whether the file itself may be a link, as the user's own files may.

    Raises:
        OSError: missing or unreadable.
        BadFile: it is a link, or no ordinary file.
    """
    flags = os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC | (0 if links else os.O_NOFOLLOW)
    try:
        handle = os.open(path, flags)
    except OSError as error:
        if error.errno == errno.ELOOP and not links:
            raise BadFile(path, LINK) from error
        raise
    if not stat.S_ISREG(os.fstat(handle).st_mode):
        os.close(handle)
        raise BadFile(path, "is no ordinary file")
    return handle


def read_file(path: Path, most: int = FILE_BYTES, *, links: bool = False) -> bytes:
    """The whole content. Raises `BadFile`: missing, unreadable, no ordinary file, or too large."""
    try:
        with os.fdopen(open_ordinary(path, links=links), "rb") as file:
            # One byte more shows a file that grows; room for `most` would take 40 microseconds.
            data = file.read(min(most, os.fstat(file.fileno()).st_size) + 1)
    except (OSError, ValueError) as error:  # ValueError: NUL in the path
        problem = getattr(error, "strerror", None) or "cannot be read"
        raise BadFile(path, problem.lower()) from error
    if len(data) > most:
        raise BadFile(path, f"has more than {most / 1e6:.0f} MB, the most that is read")
    return data


# ---- JSON ----------------------------------------------------------------------------------------


JSON: TypeAlias = Mapping[str, "JSON"] | Sequence["JSON"] | str | int | float | bool | None


def parse(data: bytes, path: str | Path) -> JSON:
    """The value of a document from anywhere.

    Raises:
        BadFile: it is not UTF-8 JSON (names line and column), has a number that is not finite or
            beyond 64 bits, half a character, a key twice, or is larger or deeper than is read.
    """
    marks = sum(data.count(sign) for sign in (b",", b"[", b"{"))
    if len(data) > JSON_BYTES or marks > JSON_ITEMS:
        raise BadFile(path, f"is larger than the {JSON_BYTES / 1e6:.0f} MB of JSON that are read")
    try:
        value = _DECODER.decode(data.decode("utf-8"))
        _check_values(value)
        if _HALF_ESCAPE.search(data):
            _ = json.dumps(value, ensure_ascii=False).encode()
    except json.JSONDecodeError as error:
        place = f"line {error.lineno}, column {error.colno}"
        raise BadFile(path, f"not JSON at {place}: {error.msg}") from error
    except UnicodeEncodeError as error:
        raise BadFile(path, "not JSON: half a character (a lone surrogate)") from error
    except (UnicodeDecodeError, ValueError, RecursionError) as error:
        raise BadFile(path, f"not JSON: {shortened(str(error))}") from error
    return value


def _no_constant(name: str) -> float:
    raise ValueError(f"{name} is no JSON number")


def _whole_number(text: str) -> int:
    number = int(text) if len(text) < 30 else math.inf
    if abs(number) > WHOLE_NUMBER:
        raise ValueError(f"{text[:30]} has more than 64 bits")
    return int(number)


def _object(pairs: list[tuple[str, JSON]]) -> dict[str, JSON]:
    found = dict(pairs)
    if len(found) < len(pairs):
        keys = [key for key, _ in pairs]
        raise ValueError(f"key {next(key for key in keys if keys.count(key) > 1)!r} occurs twice")
    return found


def _check_values(value: JSON) -> None:
    """Refuses numbers that are not finite, and values that are nested too deep."""
    level: list[JSON] = [[value]]
    for _ in range(JSON_DEPTH + 1):
        inner = [n.values() if isinstance(n, dict) else n for n in level if type(n) in _NESTS]
        # Here and not in the decoder, which would call a function for each number.
        if any(math.inf in items or -math.inf in items for items in inner):  # type: ignore[operator]
            raise ValueError("a number such as 1e999 is no finite number")
        level = [item for items in inner for item in items if type(item) in _NESTS]  # type: ignore[union-attr]
        if not level:
            return
    raise ValueError(f"nested more than {JSON_DEPTH} deep")


_NESTS = (dict, list)
_HALF_ESCAPE = re.compile(rb"\\u[dD][89a-fA-F]")
_DECODER = json.JSONDecoder(
    object_pairs_hook=_object, parse_int=_whole_number, parse_constant=_no_constant
)


def parse_mapping(data: bytes, path: str | Path) -> dict[str, JSON]:
    """As `parse`, and the top level must be an object."""
    value = parse(data, path)
    if not isinstance(value, dict):
        raise BadFile(path, f"holds a JSON {type(value).__name__}, not an object")
    return value


# ---- YAML ----------------------------------------------------------------------------------------


# libyaml's parser takes a tenth of the time; it is in every wheel of PyYAML.
_Parser: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


class _Loader(_Parser):
    def construct_mapping(self, node: Any, deep: bool = False) -> Any:
        seen: set[str] = set()
        for key, _ in node.value:
            if isinstance(key, yaml.ScalarNode):
                if key.value in seen:
                    raise _refused(f"key {key.value!r} occurs twice", key.start_mark)
                seen.add(key.value)
        return super().construct_mapping(node, deep)

    def construct_yaml_int(self, node: Any) -> int:
        if len(node.value) > 70 or abs(number := super().construct_yaml_int(node)) > WHOLE_NUMBER:
            raise _refused("a number of more than 64 bits", node.start_mark)
        return number


_Loader.add_constructor("tag:yaml.org,2002:int", _Loader.construct_yaml_int)


@lru_cache(maxsize=256)
def parse_yaml(text: str) -> object:
    """The value of a document, cached: every episode reads its domain, and parsing is slow.

    Raises:
        yaml.YAMLError: not YAML, or beyond a bound; has the place.
        ValueError: a value that its tag cannot hold, such as a date of month 13.
    """
    aliases, around = 0, list[str | None]()  # anchors of the collections around an event
    for event in yaml.parse(text, _Parser):  # before any value is made
        if isinstance(event, yaml.CollectionStartEvent):
            around.append(event.anchor)
        elif isinstance(event, yaml.CollectionEndEvent):
            around.pop()
        elif isinstance(event, yaml.AliasEvent):
            aliases += 1
            if event.anchor in around:
                raise _refused(f"{event.anchor} contains itself", event.start_mark)
        if aliases > YAML_ALIASES:
            raise _refused(f"more than {YAML_ALIASES} aliases", event.start_mark)
        if len(around) > YAML_DEPTH:
            raise _refused("nested too deeply", event.start_mark)
    try:
        return yaml.load(text, _Loader)
    except (AttributeError, KeyError, TypeError, OverflowError) as error:
        raise ValueError(f"a value does not fit its tag: {error}") from error


def dump_yaml(content: object) -> str:
    """Plain values as block YAML, a key a line, in their own order: what `grep` can read too."""
    return yaml.safe_dump(content, sort_keys=False, allow_unicode=True)


def _refused(problem: str, mark: Any) -> yaml.YAMLError:
    return yaml.constructor.ConstructorError(None, None, problem, mark)
