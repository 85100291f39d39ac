"""What files say is shown on a terminal, and never obeyed by it."""

import io
import json
import os
import shlex
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from collected import FOLDER, collect
from hypothesis import given
from hypothesis import strategies as st
from rich.live import Live
from rich.table import Table
from rich.text import Text
from typer.testing import CliRunner

from rtphys.cli.main import app
from rtphys.cli.screen import Screen, campaign_progress, print_table
from rtphys.cli.terminal import HARMFUL, printable, say, say_json
from rtphys.core.errors import BadFile

TEXTS = (
    *("[/]", "[bold", "[/bold]", "[red]x[/red]", "[link=file:///etc/passwd]x[/link]", "[@click=x]"),
    *("\x1b[2J", "\x1b]0;title\x07", "\x1b[31m", "\x9b31m", "\x1bP+q\x1b\\", "\x1b]8;;x\x1b\\y"),
    *("\x1b[6n", "\x1b]52;c;eA==\x07", "a\rb", "a\bb", "\x00", "\x7f", "\x85", "\u202egnp.exe"),
    *("\u2066x", "\ud800", ":skull:", "\\[/]", "\\", "x" * 9000, "$\\frac$", "$", "</script>"),
)


@given(text=st.text() | st.text(st.characters(max_codepoint=0x2070)))
def test_nothing_harmful_is_left_and_nothing_else_is_changed(text: str) -> None:
    shown = printable(text)
    assert not HARMFUL.search(shown)
    assert shown == printable(shown)
    assert HARMFUL.search(text) or shown == text
    assert "\n" not in printable(text, one_line=True)
    shown.encode()


def test_it_is_spelled_as_in_python() -> None:
    assert printable("a\x1b[31mb\x9b\u202e\ud800\tc\nd") == r"a\x1b[31mb\x9b\u202e\ud800" "\tc\nd"
    assert printable("läute die Glocke, kg m², 按铃") == "läute die Glocke, kg m², 按铃"


@pytest.mark.parametrize("text", TEXTS)
def test_whatever_is_drawn_is_shown_as_it_is(text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdout", io.StringIO())
    screen = Screen(width=20_000)
    table = Table(text, title=text)
    table.add_row(text)
    table.add_row(Text(text))
    for drawn in (text, Text(text), table):
        screen.print(drawn)
    with Live(Text(text), console=screen, auto_refresh=False, transient=True) as live:
        live.update(table, refresh=True)
    said = sys.stdout.getvalue()  # type: ignore[attr-defined]
    # A `Text` in a table may be cut: its width was taken before.
    assert said.count(printable(text)) >= 4
    assert not HARMFUL.search(said)


@pytest.mark.parametrize("text", TEXTS)
def test_what_is_said(text: str, capsys: pytest.CaptureFixture[str]) -> None:
    say(text)
    say(text, err=True)
    say_json({"said": text, "count": np.int64(3)})
    out, err = capsys.readouterr()
    first, _, rest = out.partition("\n{")
    assert first == err.removesuffix("\n") == printable(text)
    assert not HARMFUL.search(rest) and json.loads("{" + rest) == {"said": text, "count": 3}


def test_an_empty_dataset_is_not_called_sound(tmp_path: Path) -> None:
    collect(tmp_path / "empty", 0)
    done = CliRunner().invoke(app, ["verify", str(tmp_path / "empty")])
    assert done.exit_code == 1
    assert "it holds no episode" in done.stdout
    assert "sound" not in done.output


def test_commands_show_what_a_dataset_says(tmp_path: Path) -> None:
    collect(dataset := tmp_path / "dataset", 1)
    words = dataset / FOLDER / "instruction/episode_0000000.json"
    for text in TEXTS:
        words.write_text(json.dumps({**json.loads(words.read_text()), "seen": [text]}))
        for command in (["show", str(dataset)], ["verify", str(dataset), "--fresh"]):
            result = CliRunner().invoke(app, command)
            assert result.exit_code in (0, 1, 2), result.output  # 2: half a character is no JSON
            assert result.exception is None or isinstance(result.exception, SystemExit)
            assert not HARMFUL.search(result.output)


def test_an_error_is_shown_as_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    def raising(*_: object) -> None:
        raise BadFile("a\x1b[2Jb", "[/]\x07")

    monkeypatch.setattr("rtphys.cli.show.chosen", raising)
    result = CliRunner().invoke(app, ["show", "x"])
    assert (result.exit_code, result.stderr) == (2, "rtphys: a\\x1b[2Jb: [/]\\x07\n")


def test_closed_outputs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdout", None)
    monkeypatch.setattr(sys, "stderr", None)
    print_table(Table("x", title="y"))
    with campaign_progress("episodes") as listener:
        listener.noticed("something")
    say("nobody hears it")


@pytest.mark.parametrize("arguments", ["--help", "domains list"])
@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_an_output_that_takes_nothing(
    arguments: str, unbuffered: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A full disk and a reader that has left: no traceback."""
    monkeypatch.setenv("PYTHONUNBUFFERED", unbuffered)
    command = [sys.executable, "-m", "rtphys.cli.main", *arguments.split()]
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True)
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert "No space left on device" in done.stderr
    reading, writing = os.pipe()
    os.close(reading)
    done = subprocess.run(command, stdout=writing, stderr=subprocess.PIPE, text=True)
    os.close(writing)
    assert (done.returncode, done.stderr) == (1, "")
    done = subprocess.run(
        ["sh", "-c", f"exec {shlex.join(command)} >&-"], stderr=subprocess.PIPE, text=True
    )
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize(
    ("command", "function"),
    [
        ("merge a a", "merge_datasets"),
        ("subset a", "write_subset"),
        ("convert a", "convert_dataset"),
    ],
)
def test_what_continues_says_so_when_it_is_stopped(
    command: str, function: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def stopped(*_: object) -> None:
        os.kill(os.getpid(), signal.SIGTERM)

    # Without a handler of its own, a command would end this process.
    signal.signal(signal.SIGTERM, lambda *_: None)
    collect(tmp_path / "a", 1)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(f"rtphys.cli.datasets.{function}", stopped)
    done = CliRunner().invoke(app, [*command.split(), "--out", "new"])
    assert done.exit_code == 130 and "To go on, repeat: rtphys" in done.stderr
