"""What goes to a terminal, and how a long command ends.

Names, sentences and errors come from files of anybody. An escape sequence among them could move the
cursor, change what was written before, or answer in the user's name. So control characters are
shown, and none is obeyed.
"""

import json
import re
import shlex
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from types import FrameType

import typer

from rtphys.core.errors import RtphysError

# Control characters, marks that turn the direction of text, and halves of characters.
HARMFUL = re.compile(
    "[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]"
)


def printable(text: str, *, one_line: bool = False) -> str:
    r"""A text with harmful characters, in one line also its ends, spelled as in Python: `\x1b`."""
    shown = HARMFUL.sub(lambda found: found[0].encode("unicode_escape").decode(), text)
    return shown.replace("\n", "\\n") if one_line else shown


def say(text: str, *, err: bool = False) -> None:
    """Prints a text and the end of the line. `err`: to standard error."""
    typer.echo(printable(text), err=err)


def say_json(value: object) -> None:
    """Prints a value, in which there may be numpy's numbers, for programs."""
    text = json.dumps(value, indent=2, ensure_ascii=False, default=lambda one: one.item())
    typer.echo(HARMFUL.sub(lambda found: f"\\u{ord(found[0]):04x}", text))


GIVEN: ContextVar[tuple[object, ...]] = ContextVar("given", default=())
"""The options before the running command's name."""


def command_line(*words: object) -> str:
    """A command to type, with the options before its name that the running one was given."""
    return shlex.join(str(word) for word in ("rtphys", *GIVEN.get(), *words))


class Incomplete(RtphysError):
    """Tasks were given up before they had what was asked for."""

    exit_code = 4


class Interrupted(RtphysError):
    """Ctrl-C, SIGTERM or SIGHUP."""

    exit_code = 130  # what a shell reports for a program stopped by Ctrl-C


@contextmanager
def resumable() -> Iterator[None]:
    """Lets Ctrl-C, SIGTERM and SIGHUP end the command with a sentence that says how to continue.

    Raises `Interrupted`: by one of them.
    """
    signal.signal(signal.SIGTERM, _as_interrupt)
    if signal.getsignal(signal.SIGHUP) is not signal.SIG_IGN:  # as under `nohup`
        signal.signal(signal.SIGHUP, _as_interrupt)
    try:
        yield
    except KeyboardInterrupt:
        same = shlex.join(["rtphys", *sys.argv[1:]])
        text = f"stopped; what is there is whole. To go on, repeat: {same}"
        raise Interrupted(text) from None


def _as_interrupt(_: int, __: FrameType | None) -> None:
    raise KeyboardInterrupt
