"""The layers of docs/architecture.md, checked on the import statements themselves."""

import ast
import re
import subprocess
import sys
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "src" / "rtphys"
TASKS = sorted([*(ROOT / "tasks").glob("*.py"), *(ROOT / "probes" / "tasks").glob("*.py")])

FREE = {"numpy", "scipy"}
# Import name -> the layers that may use it. What is not here may not be imported at all.
OWNERS = {
    "yaml": {"core"},
    "trimesh": {"assets"},
    "manifold3d": {"assets"},
    "PIL": {"assets"},
    "h5py": {"data"},
    "cv2": {"data", "report"},
    "simplejpeg": {"data"},
    "isal": {"data"},
    "av": {"data"},
    "pandas": {"data"},
    "pydantic": {"analysis", "data", "results", "spec"},
    "pydantic_core": {"data"},
    "pinocchio": {"plan"},
    "coal": {"plan"},
    "toppra": {"plan"},
    "ruckig": {"plan"},
    "sapien": {"sim"},
    "matplotlib": {"report"},
    "pyarrow": {"export"},
    "rerun": {"view"},
    "gymnasium": {"gym"},
    "websockets": {"policies"},
    "msgpack": {"policies"},
    "ray": {"campaign"},
    "sklearn": {"analysis"},
    "threadpoolctl": {"analysis"},
    "typer": {"cli"},
    "rich": {"cli"},
}


def rows() -> dict[str, int]:
    """Layer name -> row, read from the table in docs/architecture.md."""
    found: dict[str, int] = {}
    for line in (ROOT / "docs" / "architecture.md").read_text().splitlines():
        match = re.match(r"\|\s*(\d+)\s*\|([^|]*)\|", line)
        if match:
            found |= {
                name.rstrip("/"): int(match[1]) for name in re.findall(r"`(\w+/?)`", match[2])
            }
    return found


ROWS = rows()


def row(layer: str) -> int:
    """0 for a layer that the table lacks; the first test names it."""
    return ROWS.get(layer, 0)


def layer_of(path: Path) -> str:
    top = path.relative_to(PACKAGE).parts[0].removesuffix(".py")
    return "cli" if top == "__main__" else top  # the command, started with `python -m rtphys`


def imports(path: Path) -> list[tuple[int, str]]:
    """(line, dotted name) of every import in a file, wherever it stands."""
    found = []
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            found += [(node.lineno, alias.name) for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}:{node.lineno} relative import"
            if node.module == "rtphys":
                found += [(node.lineno, f"rtphys.{alias.name}") for alias in node.names]
            elif node.module:
                found.append((node.lineno, node.module))
    return found


def third_party(name: str) -> bool:
    top = name.partition(".")[0]
    return top not in sys.stdlib_module_names and top != "rtphys"


FILES = sorted(p for p in PACKAGE.rglob("*.py") if p != PACKAGE / "__init__.py")


def test_every_layer_has_a_row() -> None:
    assert len(ROWS) > 15, "the table in docs/architecture.md was not understood"
    assert max(ROWS.values()) <= 11
    unknown = {layer_of(p) for p in FILES} - ROWS.keys()
    assert not unknown, f"not in the table of docs/architecture.md: {sorted(unknown)}"


def test_a_layer_imports_only_the_rows_above_it() -> None:
    wrong = []
    for path in FILES:
        own = layer_of(path)
        for line, name in imports(path):
            parts = name.split(".")
            if parts[0] != "rtphys" or len(parts) < 2:
                continue
            other = parts[1]
            if other != own and row(other) >= row(own):
                wrong.append(f"{path.relative_to(ROOT)}:{line} {own} imports {other}")
    assert not wrong, "\n".join(wrong)


def module_of(path: Path) -> str:
    parts = path.relative_to(PACKAGE.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def test_no_module_imports_itself_by_way_of_others() -> None:
    """Circles within a package too; imports inside functions and for types alone count."""
    modules = {module_of(path): path for path in FILES}
    graph = {
        name: {other for _, found in imported(path) for other in found if other in modules}
        for name, path in modules.items()
    }
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        raise AssertionError(" -> ".join(reversed(error.args[1]))) from None


def imported(path: Path) -> list[tuple[int, tuple[str, ...]]]:
    """(line, modules that an import may mean): `from a import b` is `a.b` where that is one."""
    found: list[tuple[int, tuple[str, ...]]] = []
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            found += [(node.lineno, (alias.name,)) for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module:
            names = [f"{node.module}.{alias.name}" for alias in node.names]
            whole = all(
                (PACKAGE.parent / name.replace(".", "/")).with_suffix(".py").is_file()
                or (PACKAGE.parent / name.replace(".", "/")).is_dir()
                for name in names
            )
            found.append((node.lineno, (*names, *([] if whole else [node.module]))))
    return found


def test_every_third_party_package_has_one_owner() -> None:
    wrong = []
    for path in FILES:
        own = layer_of(path)
        for line, name in imports(path):
            top = name.partition(".")[0]
            if third_party(name) and top not in FREE and own not in OWNERS.get(top, set()):
                wrong.append(f"{path.relative_to(ROOT)}:{line} {own} imports {top}")
    assert not wrong, "\n".join(wrong)


# Flags of other programs: pip and Ray in sentences, and RoboTwin's own launch script.
FOREIGN_FLAGS = {
    "core/dependencies.py": {"--force-reinstall"},
    "doctor.py": {"--upgrade", "--force-reinstall", "--no-deps"},
    "campaign/ray.py": {"--head"},
    "robotwin_root/drive.py": {"--config", "--overrides", "--key"},
}


def test_only_the_command_line_spells_flags() -> None:
    """Elsewhere an error names a field; `cli/lazy.py` turns it into the flag."""
    wrong = []
    for path in FILES:
        name = str(path.relative_to(PACKAGE))
        if layer_of(path) == "cli":
            continue
        for number, line in enumerate(path.read_text().splitlines(), start=1):
            flags = set(re.findall(r"(?<![\w-])--[a-z][\w-]*", line))
            if ours := flags - FOREIGN_FLAGS.get(name, set()):
                wrong.append(f"{name}:{number} {' '.join(sorted(ours))}")
    assert not wrong, "\n".join(wrong)


# What namedtuples, `os` and SAPIEN offer to everybody in spite of the underscore.
PUBLIC_ALL_THE_SAME = {"_replace", "_asdict", "_fields", "_make", "_exit", "_cuda_buffer"}


def private(name: str) -> bool:
    return name.startswith("_") and not name.startswith("__") and name != "_"


def defined(tree: ast.AST) -> set[str]:
    """Names that a file gives itself: functions, classes, variables, fields, attributes."""
    names: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            names.add(node.name)
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            names.add(node.id)
        elif isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store):
            names |= {node.attr} if ast.unparse(node.value) == "self" else set()
    return names


def foreign_privates(path: Path) -> list[str]:
    """`line name` of each private name that a file reads or imports and does not define."""
    tree = ast.parse(path.read_text())
    own = defined(tree) | PUBLIC_ALL_THE_SAME
    found = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute) and private(node.attr) and node.attr not in own:
            found.append(f"{node.lineno} {ast.unparse(node)}")
        elif isinstance(node, ast.ImportFrom):
            found += [f"{node.lineno} {a.name}" for a in node.names if private(a.name)]
    return found


@pytest.mark.parametrize("path", FILES, ids=lambda p: str(p.relative_to(PACKAGE)))
def test_nothing_private_is_read_from_another_module(path: Path) -> None:
    assert not foreign_privates(path)


@pytest.mark.parametrize("path", TASKS, ids=lambda p: p.stem)
def test_a_task_imports_only_the_task_vocabulary(path: Path) -> None:
    """And families: the files beside it whose names begin with an underscore."""
    families = {p.stem for p in TASKS if p.stem.startswith("_")} - {path.stem}
    names: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom) and node.level:
            assert node.level == 1, f"{path.name}:{node.lineno} leaves the folder"
            assert node.module in families, f"{path.name}:{node.lineno} imports no family"
        elif isinstance(node, ast.ImportFrom):
            names.add(str(node.module))
        elif isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
    allowed = {"math", "numpy", "dataclasses", "itertools", "functools", "collections.abc"}
    wrong = names - allowed - {"rtphys.task"}
    assert not wrong, f"{path.name} imports {sorted(wrong)}"


HEAVY = "sapien pinocchio trimesh"
LIGHT = {  # code -> what it loads, and what it does not
    "import rtphys.cli.main": ("rtphys.cli.main", f"{HEAVY} numpy h5py cv2"),
    "from rtphys.cli import lazy; [lazy.load(name) for name in lazy.COMMANDS]": (
        "rtphys.cli.collect",
        "sapien pinocchio coal toppra matplotlib sklearn scipy.stats scipy.spatial",
    ),
    "import rtphys.gym": ("rtphys.gym", f"{HEAVY} h5py cv2"),
    "import rtphys.studies.collect": ("toppra sapien", "matplotlib trimesh scipy.stats"),
}


@pytest.mark.parametrize("code", LIGHT)
def test_what_is_not_needed_is_not_loaded(code: str) -> None:
    """Help answers at once; and plots and statistics took a worker as long as an episode."""
    words = [sys.executable, "-c", f"import sys; {code}; print(*sys.modules)"]
    done = subprocess.run(words, capture_output=True, text=True, check=True)
    needed, heavy = (set(names.split()) for names in LIGHT[code])
    assert needed <= (loaded := {*done.stdout.split()}) and not heavy & loaded
