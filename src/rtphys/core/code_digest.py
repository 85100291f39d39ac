"""Digests of Python code by what it does.

Comments, docstrings, formatting, annotations of functions and the names of local variables are left
out, so that tidying up changes no digest. It is the same for every version of Python.
"""

import ast
import hashlib
from collections.abc import Iterable, Iterator
from functools import lru_cache
from pathlib import Path

Function = ast.FunctionDef | ast.AsyncFunctionDef
# Of the tree's nodes, what is spelling, or known to some versions of Python only.
_LEFT_OUT = {"ctx", "kind", "type_comment", "type_params", "type_ignores", "returns", "annotation"}


def code_digest(paths: Iterable[Path]) -> str:
    """One digest of several files, in any order; 16 hex digits."""
    whole = hashlib.sha256()
    for digest in sorted(f"{path.stem} {_file_digest(path, _stamp(path))}" for path in paths):
        whole.update(digest.encode())
    return whole.hexdigest()[:16]


def imported_files(path: Path, package: Path) -> frozenset[Path]:
    """A file of a package, and all files of the package that it imports, directly or not.

    Args:
        package: folder of the package; `import package.a.b` means `<package>/a/b.py`.
    """
    known: set[Path] = set()
    waiting = [path]
    while waiting:
        if (one := waiting.pop()) not in known:
            known.add(one)
            waiting += _imports(one, package)
    return frozenset(known)


def _imports(path: Path, package: Path) -> list[Path]:
    names: set[str] = set()
    for node in ast.walk(_parsed(path, _stamp(path))):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            start = path.parents[node.level - 1] if node.level else None
            own = start.relative_to(package.parent).parts if start else ()
            base = ".".join((*own, *filter(None, [node.module])))
            names |= {base, *(f"{base}.{alias.name}" for alias in node.names)}
    found = [_file_of(name, package) for name in sorted(names)]
    return [file for file in found if file is not None]


def _file_of(module: str, package: Path) -> Path | None:
    """The file of a module of the package; None for a name in a module, or another package's."""
    top, *parts = module.split(".")
    if top != package.name:
        return None
    place = package.joinpath(*parts)
    candidates = (place.with_suffix(".py"), place / "__init__.py")
    return next((file for file in candidates if file.is_file()), None)


def _stamp(path: Path) -> tuple[int, int]:
    facts = path.stat()
    return facts.st_mtime_ns, facts.st_size


@lru_cache(maxsize=256)
def _parsed(path: Path, stamp: tuple[int, int]) -> ast.Module:
    del stamp  # of the file that is parsed
    return ast.parse(path.read_bytes())


@lru_cache(maxsize=1024)
def _file_digest(path: Path, stamp: tuple[int, int]) -> str:
    tree = _parsed(path, stamp)
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
        return tuple(_plain(item) for item in node if not _is_docstring(item))
    return node


def _is_docstring(node: object) -> bool:
    """A string that stands alone does nothing, wherever it stands."""
    return (
        isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
    )


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
