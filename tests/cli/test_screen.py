"""Tables in terminals and pipes, where nothing is cut; and how far a campaign is, in one line."""

import io
import json
import sys
from collections import Counter
from io import StringIO
from pathlib import Path

import pytest
from rich.console import Console, Group
from typer.testing import CliRunner

from rtphys.campaign.series import Progress
from rtphys.cli import screen as module
from rtphys.cli.main import app
from rtphys.cli.screen import (
    Lines,
    Screen,
    fitting_table,
    print_parts,
    print_table,
    print_within,
    progress_bar,
    reasons,
    summary_table,
)
from rtphys.task.spec import task_names

ROW = ("stack_blocks_three", "a sentence of several words", "x" * 40)


@pytest.mark.parametrize("width", [30, 80, 120])
def test_every_letter_is_there_at_any_width(width: int, monkeypatch: pytest.MonkeyPatch) -> None:
    stream = io.StringIO()
    monkeypatch.setattr(sys, "stdout", stream)
    table = fitting_table(["name"], ["what", "code"])
    table.add_row(*ROW)
    print_within(Screen(width=width), table)
    lines = stream.getvalue().splitlines()
    assert max(map(len, lines)) <= width
    assert "".join(lines).count("x") == 40 and "…" not in "".join(lines)
    assert "".join(line[:8].strip() for line in lines[1:])[:8] == "stack_bl"
    if width >= 80:
        assert lines[1].startswith("stack_blocks_three")


def test_a_bar_writes_nothing_into_a_log(capsys: pytest.CaptureFixture[str]) -> None:
    """Not even an empty line: cron mails what a command writes there."""
    with progress_bar("drawing") as tell:
        tell(1, 2, "one")
        tell(2, 2, "two")
    assert capsys.readouterr() == ("", "")


def test_a_bar_of_work_that_is_done_already_is_not_shown(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A pack that is there must not be called one that is being built."""
    monkeypatch.setenv("FORCE_COLOR", "1")  # as on a terminal
    with progress_bar("building"):
        pass
    assert "building" not in capsys.readouterr().err
    with progress_bar("building") as tell:
        tell(1, 2, "one")
    assert "building" in capsys.readouterr().err


@pytest.mark.parametrize("width", [80, 100, 120])
def test_names_give_way_before_words_break(width: int, capsys: pytest.CaptureFixture[str]) -> None:
    table = fitting_table(["protocol", "task"], ["rate", "others", "more", "reasons"])
    cells = ("100 % [91.2-100] 40/40", "77.5 % 445/574", "66.6 % 333/500", "policy_error 11")
    table.add_row("phys_random_all", "shake_bottle_horizontally", *cells)
    print_within(Screen(width=width), table)
    said = capsys.readouterr().out
    assert max(map(len, said.splitlines())) <= width
    assert {"[91.2-100]", "40/40", "445/574", "policy_error", "phys_random_all"} <= {*said.split()}


class Terminal(StringIO):
    def isatty(self) -> bool:
        return True


@pytest.mark.parametrize("terminal", [True, False])
def test_columns_without_room_follow_below(terminal: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    table = fitting_table(["task"], [f"[{n}]" for n in range(9)], "title", justify="right")
    table.add_row("shake_bottle_horizontally", *(f"{n}0 ({n}0-100)" for n in range(9)))
    monkeypatch.setenv("TERM", "dumb")  # of 80 columns, without escape sequences
    monkeypatch.setattr(sys, "stdout", shown := Terminal() if terminal else StringIO())
    print_parts(table)
    lines = [line.split() for line in shown.getvalue().splitlines()]
    heads = [line for line in lines if line[0] == "task"]
    rows = [line for line in lines if line[0] == "shake_bottle_horizontally"]
    assert [len(line) for line in heads] == ([5, 5, 2] if terminal else [10])
    assert lines == [["title"], *(line for both in zip(heads, rows, strict=True) for line in both)]
    assert [word for line in heads for word in line[1:]] == [f"[{n}]" for n in range(9)]
    cells = [word for line in rows for word in line[1:]]
    assert cells == [word for n in range(9) for word in (f"{n}0", f"({n}0-100)")]


def test_a_pipe_gets_one_line_a_row(capsys: pytest.CaptureFixture[str]) -> None:
    table = fitting_table(["name"], ["what", "code"], "title")
    table.add_row(*ROW)
    print_table(table)
    said = capsys.readouterr().out.splitlines()
    assert len(said) == 3
    assert all(part in said[2] for part in ROW)


def test_names_of_tasks_can_be_searched_for() -> None:
    done = CliRunner().invoke(app, ["tasks"], env={"COLUMNS": "80"})
    names = [line.split()[0] for line in done.stdout.splitlines()[1:]]
    assert names == task_names()


@pytest.mark.parametrize(
    "arguments",
    [
        *("tasks click_* --json", "protocols --json", "domains show click_bell --json"),
        *("physics sample --task global --json", "compare --paper --json"),
        "collect --task click_bell --dry-run --json",
    ],
)
def test_json_is_all_that_stands_on_standard_output(arguments: str, tmp_path: Path) -> None:
    words = arguments.split()
    if words[0] == "collect":
        words += ["--out", str(tmp_path)]
    done = CliRunner().invoke(app, words)
    assert done.exit_code == 0, done.stderr
    assert json.loads(done.stdout)


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """[s], to be put forward."""
    now = [0.0]
    monkeypatch.setattr(module.time, "monotonic", lambda: now[0])
    return now


def test_a_line_comes_now_and_then(clock: list[float], capsys: pytest.CaptureFixture[str]) -> None:
    progress = Progress("lift_pot", 20)
    with Lines("episodes") as lines:
        lines.started([progress])
        for _ in range(5):
            lines.ticked()  # a line is due every ten seconds
            clock[0] += 4.0
            progress.add("")
    first, second, last = capsys.readouterr().err.splitlines()
    assert first == "lift_pot: 20 episodes wanted"
    assert second == "3 of 20 episodes, 3 attempts, 15.0 episodes/min, 0:01:08 left"
    assert last == "5 of 20 episodes, 5 attempts, 15.0 episodes/min, 0:01:00 left"


def test_rates_are_of_this_run(clock: list[float], capsys: pytest.CaptureFixture[str]) -> None:
    progress = Progress("lift_pot", 20, accepted=12, attempts=17)
    with Lines("episodes") as lines:
        lines.started([progress])
        clock[0] = 60.0
        for reason in ("", "", "slipped", "slipped", "unreachable"):
            progress.add(reason)
    first, last = capsys.readouterr().err.splitlines()
    assert first == "lift_pot: 20 episodes wanted, 12 there already"
    assert last == (
        "14 of 20 episodes, 5 attempts, 3 rejected (slipped 2, unreachable 1), "
        "2.0 episodes/min, 0:03:00 left"
    )


def test_many_series_are_not_listed(clock: list[float], capsys: pytest.CaptureFixture[str]) -> None:
    with Lines("episodes") as lines:
        lines.started([Progress("task", 1) for _ in range(module.MAX_ROWS + 1)])
        assert capsys.readouterr().err == ""


def test_what_is_told_at_once(clock: list[float], capsys: pytest.CaptureFixture[str]) -> None:
    with Lines("episodes") as lines:
        lines.noticed("a worker died")
        lines.building(1, 9, "bells")  # too early for a line
        lines.building(9, 9, "pots")
    said = ["a worker died", "building assets: 9 of 9, pots"]
    assert capsys.readouterr().err.splitlines() == said


def test_nobody_waits_for_what_was_given_up(clock: list[float]) -> None:
    lines, given_up = Lines("episodes"), Progress("hard", 100, stopped="hopeless")
    lines.started([given_up, Progress("easy", 2)])
    clock[0] = 60.0
    lines.progresses[1].add("")
    assert "0:01:00 left" in lines.sentence()


def test_more_than_was_asked_for_counts_as_what_was_asked_for() -> None:
    lines = Lines("episodes")
    lines.started([Progress("a", 3, accepted=9), Progress("b", 3, accepted=1)])
    assert lines.sentence().startswith("4 of 6 episodes, 0 attempts")


def test_the_most_frequent_reasons_come_first() -> None:
    counted = Counter(a=1, b=5, c=2, d=3, e=1, f=1)
    assert reasons(counted) == "b 5, d 3, c 2, a 1, other 2"


def test_a_summary_has_a_row_for_each_series() -> None:
    progress = Progress("lift_pot", 4)
    for reason in ("", "slipped", ""):
        progress.add(reason)
    table = summary_table([progress, Progress("click_bell", 4, accepted=4, attempts=7)])
    cells = [list(column.cells) for column in table.columns]
    assert [column[0] for column in cells] == ["lift_pot", "2 / 4", "3", "67 %", "slipped 1"]
    assert [column[1] for column in cells] == ["click_bell", "4 / 4", "0", "-", ""]


def test_where_a_failure_counts_as_well_the_solved_are_shown(capsys: pytest.CaptureFixture) -> None:
    progress = Progress("lift_pot", 3)
    for success in (True, False, False):
        progress.add("", success)
    table = summary_table([progress])
    assert [str(column.header) for column in table.columns][3] == "solved"
    assert list(table.columns[3].cells) == ["33 %"]
    assert len(table.columns) == 4, "a failure of a policy is no rejection"
    lines = Lines("episodes")
    lines.progresses = [progress]
    assert lines.sentence().startswith("3 of 3 episodes, 1 solved, ")


def test_what_was_there_before_counts_as_solved() -> None:
    finished = Progress("click_bell", 80, accepted=80, attempts=80, solved=54)
    assert [*summary_table([finished]).columns[3].cells] == ["68 %"]
    lines = Lines("episodes")
    lines.progresses = [finished]
    assert lines.sentence() == "80 of 80 episodes, 54 solved, all there already"
    assert lines.sentence(at_work=True).endswith("all there already, now measured further")
    lines.progresses = [Progress("click_bell", 80, accepted=80, attempts=90)]
    assert lines.sentence() == "80 of 80 episodes, all there already"
    lines.progresses = [begun := Progress("click_bell", 81, accepted=80, attempts=80, solved=54)]
    begun.add("", success=True)
    assert lines.sentence().startswith("81 of 81 episodes, 55 solved, ")


def test_the_count_says_whose_it_is_where_several_take_turns() -> None:
    lines = Lines("episodes")
    lines.progresses = [Progress("idle", 4, accepted=4, solved=0, by="baselines")]
    assert lines.sentence() == "baselines: 4 of 4 episodes, 0 solved, all there already"


def test_the_sentence_below_the_bar_is_whole(monkeypatch: pytest.MonkeyPatch) -> None:
    drawn = list[Group]()
    monkeypatch.setattr(module.RichLive, "update", lambda _, what, **__: drawn.append(what))
    with module.Live("episodes") as live:
        live.started([Progress("lift_pot", 1000)])
        console = Console(width=80, file=StringIO())
        console.print(drawn[-1])
        assert isinstance(console.file, StringIO)
        assert console.file.getvalue().splitlines()[-1].strip() == live.sentence()
        live.ticked()
        live.noticed("a worker died")
        live.building(1, 2, "bells")


def test_markup_is_not_read_even_on_request() -> None:
    text = "[red]clean[/red] :smile: [3]"
    assert Screen().render_str(text, markup=True, emoji=True, highlight=True).plain == text
