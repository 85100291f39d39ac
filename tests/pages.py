"""The documents taken apart: their pages, examples and command lines; and how a command is run."""

import re
import shlex
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import typer
from typer.testing import CliRunner, Result

from rtphys.cli.main import app

ROOT = Path(__file__).resolve().parents[1]
PAGES = (
    *(ROOT / name for name in ("README.md", "CONTRIBUTING.md", "SECURITY.md")),
    *sorted((ROOT / "docs").rglob("*.md")),
    *sorted((ROOT / "examples").rglob("*.md")),
)
SHELL = ("sh", "bash")
# A fenced block, or a command line that is indented or in a table.
PART = re.compile(
    r"^```(?P<language>\w*)\n(?P<text>.*?)^```|^(?: {4}|\| `)(?P<line>rtphys [^`\n]+)",
    re.MULTILINE | re.DOTALL,
)


def ran(words: Sequence[str], code: int = 0, columns: int | None = None) -> Result:
    """What a command printed that ended with this code, and not by another exception."""
    done = CliRunner().invoke(app, words, env={"COLUMNS": str(columns)} if columns else None)
    assert done.exit_code == code, (done.output, done.exception)
    assert isinstance(done.exception, SystemExit | None), done.exception
    return done


@dataclass(frozen=True)
class Part:
    """A fenced block of a page, or a single command line of rtphys."""

    language: str  # "sh" of a single line, empty of a block that names none
    text: str

    @property
    def file(self) -> str:
        """The file that a block is, by its first line, such as `# my_policy.py`; or nothing."""
        found = re.match(r"# ([\w/]+\.(?:py|yaml))\b", self.text)
        return found[1] if found else ""

    @property
    def commands(self) -> Iterator[list[str]]:
        """Command lines of rtphys, as words; comments left out."""
        if self.language not in SHELL:
            return
        for line in self.text.replace("\\\n", " ").splitlines():
            line = re.sub(r"\$\w+", "1", line)
            for piece in re.split(r"&&|;|\|", line):
                words = shlex.split(piece, comments=True)
                if words and words[0] == "rtphys":
                    yield words[1:]


def parts(page: Path) -> Iterator[Part]:
    """In the order of the page."""
    for found in PART.finditer(page.read_text()):
        yield Part("sh", found["line"]) if found["line"] else Part(found["language"], found["text"])


def blocks(page: Path, language: str) -> Iterator[str]:
    return (part.text for part in parts(page) if part.language == language)


def parse(words: list[str]) -> None:
    """Raises `UsageError` where a command line has what the program does not know; runs nothing."""
    root = typer.main.get_command(app)
    with root.make_context("rtphys", list(words)) as context:
        # Where click keeps the command's name depends on its version.
        rest = [*getattr(context, "_protected_args", []), *context.args]
        _, command, rest = root.resolve_command(context, rest)
        while hasattr(command, "commands") and rest and not rest[0].startswith("-"):
            _, command, rest = command.resolve_command(context, rest)
        command.make_context("command", rest, parent=context)


def commands(page: Path) -> Iterator[list[str]]:
    for part in parts(page):
        yield from part.commands
