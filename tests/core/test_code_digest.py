"""A digest of code changes with what the code does, and with nothing else."""

import os
from collections.abc import Callable
from pathlib import Path

import pytest

from rtphys.core import code_digest as module
from rtphys.core.code_digest import code_digest, imported_files

CODE = '''"""Doc."""
from math import pi

LIMIT = 3.0  # [m]


class Spec:
    size: Annotated[float, at_least(0), Option("Its radius [m].", "radius")] = 1.0


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
    "an option's help": ("Its radius [m].", "How large it is."),
    "no option": (', Option("Its radius [m].", "radius")', ""),
    "formatting": ("pi * radius**2", "(pi*radius ** 2)"),
}
OTHER = {
    "a number": ("3.0", "3.5"),
    "an operator": ("pi *", "pi +"),
    "a default": ("int = 1", "int = 2"),
    "a parameter's name": ("radius", "r"),
    "a global's name": ("LIMIT", "MOST"),
    "an import": ("from math import pi", "from cmath import pi"),
    "a check of a field": ("at_least(0)", "at_least(1)"),
    "a statement more": ("    return", "    one += 1\n    return"),
}


def digest(tmp_path: Path, text: str) -> str:
    path = tmp_path / "code.py"
    path.write_text(text)
    return code_digest([path])


@pytest.mark.parametrize("what", [*SAME, *OTHER])
def test_only_what_does_something_shows(tmp_path: Path, what: str) -> None:
    change = (SAME | OTHER)[what]
    assert change[0] in CODE
    same = digest(tmp_path, CODE.replace(*change)) == digest(tmp_path, CODE)
    assert same == (what in SAME)


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


@pytest.fixture
def afresh(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[], None]:
    """Makes the next question be asked as in another run."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    module._known.cache_clear()
    yield module._known.cache_clear
    module._known.cache_clear()


def test_another_run_reads_no_file_again_that_is_as_it_was(
    tmp_path: Path, afresh: Callable[[], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    before = digest(tmp_path, CODE), imported_files(tmp_path / "code.py", tmp_path)
    afresh()
    monkeypatch.setattr(module, "ast", None)
    path = tmp_path / "code.py"
    assert (code_digest([path]), imported_files(path, tmp_path)) == before


def test_a_file_that_changed_shows_in_the_same_run_and_in_another(
    tmp_path: Path, afresh: Callable[[], None]
) -> None:
    """Also if its size and its time of change are set back."""
    first = digest(tmp_path, CODE)
    path = tmp_path / "code.py"
    facts = path.stat()
    path.write_text(CODE.replace("3.0", "3.5"))
    os.utime(path, ns=(facts.st_atime_ns, facts.st_mtime_ns))
    other = code_digest([path])
    assert other != first
    afresh()
    assert code_digest([path]) == other


@pytest.mark.parametrize("content", ["", "{}", "[[1]]", '{"a": 1}', "[[1, 2, 3, 4]]", "\0"])
def test_a_damaged_memory_only_costs_time(
    tmp_path: Path, afresh: Callable[[], None], content: str
) -> None:
    known = digest(tmp_path, CODE)
    for file in (tmp_path / "cache" / "rtphys").iterdir():
        file.write_text(content)
    afresh()
    assert digest(tmp_path, CODE) == known
