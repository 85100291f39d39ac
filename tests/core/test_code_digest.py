"""A digest of code changes with what the code does, and with nothing else."""

from pathlib import Path

import pytest

from rtphys.core.code_digest import code_digest, imported_files

CODE = '''"""Doc."""
from math import pi

LIMIT = 3.0  # [m]


def area(radius: float, times: int = 1) -> float:
    """The area of some circles."""
    one = pi * radius**2  # of one
    return sum(one for _ in range(times))
'''
SAME = {
    "a comment": ("  # [m]", "  # metres, the largest"),
    "a docstring": ('"""The area of some circles."""', '"""What circles cover."""'),
    "no docstring": ('    """The area of some circles."""\n', ""),
    "a local's name": ("one", "single"),
    "a loop's name": ("for _ in", "for turn in"),
    "an annotation": ("radius: float", "radius: int"),
    "formatting": ("pi * radius**2", "(pi*radius ** 2)"),
}
OTHER = {
    "a number": ("3.0", "3.5"),
    "an operator": ("pi *", "pi +"),
    "a default": ("int = 1", "int = 2"),
    "a parameter's name": ("radius", "r"),
    "a global's name": ("LIMIT", "MOST"),
    "an import": ("from math import pi", "from cmath import pi"),
    "a statement more": ("    return", "    one += 1\n    return"),
}


def digest(tmp_path: Path, text: str) -> str:
    path = tmp_path / "code.py"
    path.write_text(text)
    return code_digest([path])


@pytest.mark.parametrize("change", SAME.values(), ids=SAME)
def test_what_does_nothing_changes_nothing(tmp_path: Path, change: tuple[str, str]) -> None:
    assert change[0] in CODE
    assert digest(tmp_path, CODE.replace(*change)) == digest(tmp_path, CODE)


@pytest.mark.parametrize("change", OTHER.values(), ids=OTHER)
def test_what_does_something_shows(tmp_path: Path, change: tuple[str, str]) -> None:
    assert change[0] in CODE
    assert digest(tmp_path, CODE.replace(*change)) != digest(tmp_path, CODE)


def test_two_locals_that_change_places_show(tmp_path: Path) -> None:
    text = "def f(x):\n    a = x\n    b = x + 1\n    return a - b\n"
    assert digest(tmp_path, text) != digest(tmp_path, text.replace("a - b", "b - a"))


def test_imports_are_followed_within_the_package(tmp_path: Path) -> None:
    package = tmp_path / "own"
    (package / "sub").mkdir(parents=True)
    texts = {
        "__init__.py": "",
        "a.py": "import os\nfrom own.sub import b\n",
        "sub/__init__.py": "",
        "sub/b.py": "from .c import value\n\n\ndef f():\n    import own.late\n",
        "sub/c.py": "value = 1\n",
        "late.py": "",
        "unused.py": "",
    }
    for name, text in texts.items():
        (package / name).write_text(text)
    found = imported_files(package / "a.py", package)
    names = {str(path.relative_to(package)) for path in found}
    assert names == {"a.py", "sub/__init__.py", "sub/b.py", "sub/c.py", "late.py"}
