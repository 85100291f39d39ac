"""Digests of Python code by what it does.

Comments, docstrings, formatting, annotations of functions, the names of local variables and the
options of a command line (`Option`) are left out, so that tidying up changes no digest. It is the
same for every version of Python.

What was found in a file is remembered in the user's cache, by the file's inode, size and times, as
reading 130 files anew takes longer than an episode.
"""

import ast
import hashlib
import json
import tempfile
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from functools import cache
from pathlib import Path

from rtphys.core.cache import NoCache, user_cache

Function = ast.FunctionDef | ast.AsyncFunctionDef
# Of the tree's nodes, what is spelling, or known to some versions of Python only.
_LEFT_OUT = {"ctx", "kind", "type_comment", "type_params", "type_ignores", "returns", "annotation"}


def code_digest(paths: Iterable[Path]) -> str:
    """One digest of several files, in any order; 16 hex digits."""
    whole, known = hashlib.sha256(), _known()
    for digest in sorted(f"{path.stem} {known.digest(path)}" for path in paths):
        whole.update(digest.encode())
    known.keep()
    return whole.hexdigest()[:16]


def imported_files(path: Path, package: Path) -> frozenset[Path]:
    """A file of a package, and all files of the package that it imports, directly or not.

    Args:
        package: folder of the package; `import package.a.b` means `<package>/a/b.py`.
    """
    found, names = set[Path](), set[str]()
    waiting, known = [path], _known()
    while waiting:
        if (one := waiting.pop()) in found:
            continue
        found.add(one)
        new = {*known.imports(one, package)} - names
        names |= new
        for name in sorted(new):  # of a module, or of a name in one
            place = package.joinpath(*name.split(".")[1:])
            candidates = (place.with_suffix(".py"), place / "__init__.py")
            waiting += [file for file in candidates if file.is_file()][:1]
    known.keep()
    return frozenset(found)


class _Known:
    """What is known of files: digests, and the names that they import.

    Args:
        path: where it is kept from one run to the next; None: nowhere.
    """

    def __init__(self, path: Path | None) -> None:
        self._path, self._fresh = path, False
        # (path, package or nothing) -> the file's stamp, and the answer
        self._found: dict[tuple[str, str], tuple[str, list[str]]] = {}
        if path is not None:
            with suppress(OSError, ValueError, TypeError):
                rows = json.loads(path.read_bytes())
                self._found = {(str(f), str(p)): (s, [*map(str, a)]) for f, p, s, a in rows}

    def digest(self, path: Path) -> str:
        return self._answer(path, "", lambda: [_file_digest(path)])[0]

    def imports(self, path: Path, package: Path) -> list[str]:
        return self._answer(path, str(package), lambda: _imports(path, package))

    def _answer(self, path: Path, package: str, find: Callable[[], list[str]]) -> list[str]:
        facts, key = path.stat(), (str(path), package)
        # Changes when the file is written or replaced: nobody can set back the last of the times.
        stamp = f"{facts.st_ino} {facts.st_size} {facts.st_mtime_ns} {facts.st_ctime_ns}"
        if self._found.get(key, ("",))[0] != stamp:
            self._found[key], self._fresh = (stamp, find()), True
        return self._found[key][1]

    def keep(self) -> None:
        """Saves what is new; a cache that cannot be written only costs time."""
        if self._path is None or not self._fresh:
            return
        rows = [(*key, *found) for key, found in self._found.items() if Path(key[0]).is_file()]
        with suppress(OSError):
            self._path.parent.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryDirectory(dir=self._path.parent) as scratch:
                new = Path(scratch) / self._path.name
                new.write_text(json.dumps(rows))
                new.replace(self._path)
            self._fresh = False


@cache
def _known() -> _Known:
    own = hashlib.sha256(Path(__file__).read_bytes()).hexdigest()[:8]
    try:
        return _Known(user_cache() / f"code-{own}.json")
    except NoCache:
        return _Known(None)


def _imports(path: Path, package: Path) -> list[str]:
    """Names of modules that a file imports; some may be of names in modules."""
    names: set[str] = set()
    for node in ast.walk(ast.parse(path.read_bytes())):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            start = path.parents[node.level - 1] if node.level else None
            own = start.relative_to(package.parent).parts if start else ()
            base = ".".join((*own, *filter(None, [node.module])))
            names |= {base, *(f"{base}.{alias.name}" for alias in node.names)}
    return sorted(name for name in names if name.partition(".")[0] == package.name)


def _file_digest(path: Path) -> str:
    tree = ast.parse(path.read_bytes())
    for function in _outermost(tree):
        _rename_locals(function)
    return hashlib.sha256(repr(_plain(tree)).encode()).hexdigest()


def _plain(node: object) -> object:
    """A tree as nested tuples, without spelling."""
    if isinstance(node, ast.AST):
        fields = [(name, value) for name, value in ast.iter_fields(node) if name not in _LEFT_OUT]
        if isinstance(node, ast.AnnAssign):
            fields.append(("annotation", node.annotation))  # a field of a dataclass is what it is
        values = [(name, _plain(value)) for name, value in fields]
        return type(node).__name__, *(pair for pair in values if pair[1] not in (None, ()))
    if isinstance(node, list):
        return tuple(_plain(item) for item in node if not _for_readers(item))
    return node


def _for_readers(node: object) -> bool:
    """A docstring, or another string that stands alone; or how a field is an option, and its help.

    The spec of an episode is code that shapes it, a word of its help is not.
    """
    if isinstance(node, ast.Call):
        return isinstance(node.func, ast.Name) and node.func.id == "Option"
    value = node.value if isinstance(node, ast.Expr) else None
    return isinstance(value, ast.Constant) and isinstance(value.value, str)


def _outermost(node: ast.AST) -> Iterator[Function]:
    """Functions that are in no other function."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, Function):
            yield child
        else:
            yield from _outermost(child)


def _rename_locals(function: Function) -> None:
    """Number the local variables of a function, and of all functions in it, as they appear.

    Parameters keep their names, which callers may write.
    """
    kept: set[str] = set()
    for node in ast.walk(function):
        if isinstance(node, ast.arg):
            kept.add(node.arg)
        elif isinstance(node, ast.Global | ast.Nonlocal):
            kept |= set(node.names)
    numbers: dict[str, str] = {}
    for node in ast.walk(function):
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store) and node.id not in kept:
            numbers.setdefault(node.id, f"local {len(numbers)}")
    for node in ast.walk(function):
        if isinstance(node, ast.Name):
            node.id = numbers.get(node.id, node.id)
