"""The command line's frame: laziness, one-line errors, exit codes, global options."""

import errno
import json
import os
import re
import shlex
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import pytest
import typer
from typer.testing import CliRunner, Result

from pages import parse, ran
from rtphys.cli import lazy
from rtphys.cli.authoring import TEMPLATE
from rtphys.cli.derived import takes
from rtphys.cli.lazy import COMMANDS, GROUPS
from rtphys.cli.main import app
from rtphys.cli.terminal import command_line
from rtphys.core import library
from rtphys.core.errors import BadValue, NoRenderer, RtphysError, UnknownName
from rtphys.spec.option import Option

PACKAGE = Path(lazy.__file__).parent
RUN = CliRunner()


Failing = Callable[..., Result]


@pytest.fixture
def failing(monkeypatch: pytest.MonkeyPatch) -> Failing:
    """Invokes a command that fails in one way, within the real frame."""

    def invoke(problem: BaseException, *before: str, kind: type | None = None) -> Result:
        inner = typer.Typer(cls=lazy.LazyGroup)

        @inner.callback()
        def main(debug: bool = typer.Option(False, "--debug")) -> None: ...

        def fail(*_: object) -> None:
            raise problem

        inner.command("fail")(fail)
        module = type(sys)("rtphys.cli.fail")
        module.fail = takes(kind)(fail) if kind else lambda: fail()  # type: ignore[attr-defined]
        monkeypatch.setitem(sys.modules, "rtphys.cli.fail", module)
        monkeypatch.setitem(COMMANDS, "fail", ("fail", "Fails."))
        return RUN.invoke(inner, [*before, "fail"])

    return invoke


@pytest.mark.parametrize(
    ("problem", "code", "message"),
    [
        (BadValue("friction", 9.0, "allowed: 0 to 4"), 2, "rtphys: friction = 9.0 is not allowed"),
        (NoRenderer("no picture"), 3, "rtphys: no picture"),
        (KeyboardInterrupt(), 130, "rtphys: stopped"),
        (OSError(errno.ENOSPC, "No space left on device", "data/x"), 2, "free some space"),
        (PermissionError(errno.EACCES, "Permission denied", "out"), 2, "out: Permission denied"),
        (ImportError("libX11.so.6: cannot open", name="sapien"), 3, "`rtphys doctor`"),
        (ImportError("No module named 'pyarrow'", name="pyarrow"), 3, "rtphys[lerobot]"),
        (ModuleNotFoundError("No module named 'rerun'", name="rerun"), 3, "install 'rtphys[view]'"),
        (
            ModuleNotFoundError("No module named 'rerun.any'", name="rerun.any"),
            3,
            "No module named 'rerun.any'; `pip install --force-reinstall 'rtphys[view]'`",
        ),
    ],
    ids=lambda v: type(v).__name__ if isinstance(v, BaseException) else "",
)
def test_a_failure_is_one_line_and_an_exit_code(
    problem: BaseException, code: int, message: str, failing: Failing
) -> None:
    result = failing(problem)
    assert result.exit_code == code
    assert message in result.stderr
    assert len(result.stderr.strip().splitlines()) == 1
    assert "Traceback" not in result.output


def test_what_cannot_be_written_is_refused_with_its_cause(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    done = ran(["new-task", "stir_soup", "--in", str(tmp_path / "file")], 2)
    assert "a file stands where a folder is needed" in done.stderr


def test_a_locale_without_a_sign_ends_no_command() -> None:
    locale = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
    command = [sys.executable, "-m", "rtphys", "domains", "show", "global"]
    done = subprocess.run(command, capture_output=True, env={**os.environ, **locale})
    assert done.returncode == 0 and "\u00d7" in done.stdout.decode(), done.stderr


def test_debug_and_a_bug_show_the_traceback(failing: Failing) -> None:
    """Only errors that a user can cause are shortened."""
    problem = BadValue("friction", 9.0, "allowed: 0 to 4")
    assert failing(problem, "--debug").exception is problem
    assert isinstance(failing(ZeroDivisionError("oops")).exception, ZeroDivisionError)


def test_commands_and_modules_are_the_same() -> None:
    frame = {"__init__", "main", "lazy", "derived", "terminal", "screen"}
    modules = {path.stem for path in PACKAGE.glob("*.py")} - frame
    assert modules == {module for module, _ in COMMANDS.values()}


@pytest.mark.parametrize("name", sorted(COMMANDS))
def test_every_command_explains_itself_with_command_lines_that_fit(name: str) -> None:
    result = ran([name, "--help"])
    assert "Usage" in result.output, result.output
    assert "completion" not in result.output
    command = lazy.load(name)
    assert (command.help or "").startswith(COMMANDS[name][1]) and COMMANDS[name][1][-1] == "."
    for one in (command, *getattr(command, "commands", {}).values()):
        for line in (one.help or "").splitlines():
            if line.startswith("    rtphys "):
                assert len(line) < 80
                parse(shlex.split(line)[1:])


@pytest.mark.parametrize("name", sorted(COMMANDS))
def test_no_option_has_two_defaults(name: str) -> None:
    command = lazy.load(name)
    for one in (command, *getattr(command, "commands", {}).values()):
        for option in one.params:
            said = re.search("default[: ]", (getattr(option, "help", None) or "").lower())
            assert not (said and option.default), f"{option.opts}: {option.help} {option.default}"


@pytest.mark.parametrize("line", ["show", "view", "render", "subset", "export lerobot"])
def test_who_chooses_a_configuration_is_told_which_is_plain_clean(line: str) -> None:
    shown = RUN.invoke(app, [*line.split(), "--help"], env={"COLUMNS": "200"}).output
    assert "plain clean" in next(
        row for row in shown.splitlines() if re.match(r"│ +--config ", row)
    )


def test_unknown_command_names_the_nearest() -> None:
    result = ran(["verifi"], 2)
    assert "verify" in result.output


@pytest.mark.parametrize(
    ("line", "former", "now", "goes_on"),
    [
        ("verify-manifest no --replay 1", "--replay", "--reproduce", "there is no such folder"),
        ("verify no --replay=1", "--replay", "--reproduce", "there is no such folder"),
        ("physics prove frictoin", "prove", "law-test", "did you mean 'friction'"),
        (
            "certify click_bel --protocol clean --out /no --baselines none",
            *("--baselines", "--replays", "did you mean 'click_bell'"),
        ),
        ("check click_bel --robots=3", "--robots", "--baselines", "did you mean 'click_bell'"),
        ("collect click_bel --seed 3", "--seed", "--first-seed", "did you mean 'click_bell'"),
        (
            "evaluate click_bel --policy idle --protocol clean --seed 3",
            *("--seed", "--policy-seed", "did you mean 'click_bell'"),
        ),
        (
            "evaluate click_bel --policy idle --protocol clean --set a=b",
            *("--set", "--policy-option", "did you mean 'click_bell'"),
        ),
        (
            "physics sample click_bel --seed 3",
            *("--seed", "--first-seed", "did you mean 'click_bell'"),
        ),
        ("show /no --number 1", "--number", "--episode", "in any folder above it"),
    ],
)
def test_a_former_name_works_and_says_the_new_one(
    line: str, former: str, now: str, goes_on: str
) -> None:
    result = RUN.invoke(app, line.split())
    command = line.split()[0].removesuffix("-manifest")
    assert result.exit_code in (1, 2) and goes_on in result.output
    assert f"`{former}` of `rtphys {command}` is called `{now}` now" in result.output


@pytest.mark.parametrize(
    ("command", "now"), [(name, now) for name, of in lazy.FORMER.items() for now in of.values()]
)
def test_a_former_name_leads_to_one_that_is_there(command: str, now: str) -> None:
    group = lazy.load(command)
    below = getattr(group, "commands", {})
    known = {flag for one in (group, *below.values()) for p in one.params for flag in p.opts}
    assert now in {*known, *below}


def test_the_former_name_of_a_command_is_said_too() -> None:
    result = RUN.invoke(app, ["verify-manifest", "/no"])
    assert "note: `rtphys verify-manifest` is called `rtphys verify` now" in result.stderr
    assert "note" not in RUN.invoke(app, ["verify", "/no"]).stderr


def test_video_without_a_value_is_all_as_it_was() -> None:
    line = ["evaluate", "click_bel", "--policy", "idle", "--protocol", "clean", "--video"]
    assert "`--video` of `rtphys evaluate` takes all, failures" in RUN.invoke(app, line).stderr
    result = ran(["evaluate", "click_bell", *line[2:], "some"], 2)
    assert "failures, all, or a positive number" in result.stderr


@pytest.mark.parametrize(
    "command",
    ["collect", "check", "bench", "certify --protocol clean --out x", "sensitivity", "identify",
     "evaluate --policy idle --protocol clean"],
)  # fmt: skip
def test_tasks_are_words_or_an_option(command: str) -> None:
    for given in (["click_bel"], ["--task", "click_bel"]):
        result = ran([*command.split(), *given], 2)
        assert "did you mean 'click_bell'" in result.stderr
    if command != "bench":  # it takes all tasks then, which lasts
        assert "name at least one" in RUN.invoke(app, command.split()).stderr


def test_an_option_of_the_program_after_a_command_says_where_it_stands(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("RTPHYS_LIBRARY", "")  # set, so that it is put back: the command sets it too
    result = ran(["check", "mine", "--library", "lab"], 2)
    assert "--library stands before the command's name: `rtphys --library" in result.stderr
    monkeypatch.delenv("RTPHYS_ASSETS", raising=False)
    alone = ran(["--fallback", "builtin", "tasks"], 2)
    assert "it needs --assets" in alone.stderr
    assert "folder does not exist" in RUN.invoke(app, ["--library", "/no", "tasks"]).stderr


def test_a_second_value_with_set_leads_to_a_sweep() -> None:
    result = RUN.invoke(app, ["collect", "click_bell", "--set", "friction=0.2,0.5"])
    assert "`--sweep friction=0.2,0.5` collects the same with each value" in result.stderr
    result = RUN.invoke(app, ["collect", "click_bell", "--set", "center_of_mass=0,0"])
    assert "it is 3 numbers" in result.stderr and "--sweep" not in result.stderr


def test_help_is_in_groups_and_common_options_come_first() -> None:
    whole = RUN.invoke(app, ["--help"], env={"COLUMNS": "80"}).output
    places = [whole.index(f" {title} ") for title in GROUPS]
    assert places == sorted(places)
    found = RUN.invoke(app, ["collect", "--help"], env={"COLUMNS": "80"}).output
    assert max(map(len, found.splitlines())) <= 80
    order = ("TASKS", "│ --protocol", "│ --episodes", "What an episode is", "│ --embodiment")
    places = [found.index(word) for word in order]
    assert places == sorted(places)


def test_library_option_adds_to_the_variable(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("RTPHYS_LIBRARY", "")  # set, so that it is put back: the command sets it too
    (tmp_path / "domains").mkdir()
    (tmp_path / "domains" / "my_lab.yaml").write_text("extends: global\n")
    result = ran(["--library", str(tmp_path), "domains", "list"])
    assert "my_lab" in result.output.split()
    assert command_line("verify", "data") == f"rtphys --library {tmp_path} verify data"
    result = ran(["--library", str(tmp_path / "gone"), "domains", "list"], 2)
    assert "gone" in result.stderr


def test_a_library_that_is_named_twice_is_one(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """As in a shell that names it for all commands, or in a checkout of rtphys."""
    (tmp_path / "tasks").mkdir()
    (tmp_path / "tasks" / "stir_soup.py").write_text(TEMPLATE)
    (tmp_path / "link").symlink_to(tmp_path)
    monkeypatch.setenv("RTPHYS_LIBRARY", f"{tmp_path}{os.pathsep}{tmp_path}/")
    twice = ["--library", str(tmp_path / "link"), "--library", str(library.bundled())]
    result = ran([*twice, "tasks", "stir_soup"])
    assert "pick, place" in result.stdout, result.output
    assert os.environ["RTPHYS_LIBRARY"] == str(tmp_path.resolve())
    result = ran(["--library", "l\udcff", "tasks"], 2)
    assert "its path is not UTF-8" in result.stderr


def test_a_task_that_raises_is_named_and_hides_no_other(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    (tmp_path / "tasks").mkdir()
    for name, wrong in (("stir_soup", "draw.spot"), ("stir_tea", "arm.lift")):
        (tmp_path / "tasks" / f"{name}.py").write_text(TEMPLATE.replace(wrong, f"{wrong}t"))
    (tmp_path / "tasks" / "stir_mud.py").write_text("import nothing_such")
    (tmp_path / "tasks" / "stir_up.py").write_text(TEMPLATE)
    monkeypatch.setenv("RTPHYS_LIBRARY", str(tmp_path))
    listed = json.loads(RUN.invoke(app, ["tasks", "stir_*", "--json"]).stdout)
    broken = [row["task"] for row in listed if row["mechanism"].startswith("broken: ")]
    assert broken == ["stir_mud", "stir_soup"] and len(listed) == 4
    spot = 1 + TEMPLATE[: TEMPLATE.index("draw.spot")].count("\n")
    lift = 1 + TEMPLATE[: TEMPLATE.index("arm.lift")].count("\n")
    out = str(tmp_path / "out")
    for task, line, *command in (
        ("stir_soup", spot, "try"),
        ("stir_soup", spot, "collect", "--episodes", "1", "--out", out),
        ("stir_tea", lift, "try"),
        ("stir_soup", spot, "physics", "sample"),
        ("stir_soup", spot, "bench", "--protocol", "clean", "--no-pictures"),
        ("stir_tea", lift, "bench", "--protocol", "clean", "--no-pictures"),
        ("stir_soup", spot, "sensitivity", "--out", out),
        ("stir_soup", spot, "certify", "--protocol", "only_friction", "--out", out),
    ):
        words = 1 + (command[0] == "physics")
        result = ran([*command[:words], task, *command[words:]], 2)
        assert f"{task}.py: raises AttributeError: " in result.stderr
        assert result.stderr.rstrip().endswith(f"(line {line})")


def test_a_new_task_says_how_to_try_it(tmp_path: Path) -> None:
    done = RUN.invoke(app, ["new-task", "stir_soup", "--in", str(tmp_path / "my lab")])
    assert f"rtphys --library '{tmp_path}/my lab' check stir_soup --seeds 20" in done.stdout


def test_ctrl_c_in_a_real_process() -> None:
    code = (
        "import signal, sys, time, types\n"
        # Who runs the tests in the background has made Ctrl-C ignored, and a child inherits that.
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "from rtphys.cli import main\n"
        "slow = types.ModuleType('rtphys.cli.authoring')\n"
        "def tasks() -> None:\n"
        "    print('working', flush=True); time.sleep(60)\n"
        "slow.tasks = tasks\n"
        "sys.modules['rtphys.cli.authoring'] = slow\n"
        "sys.argv = ['rtphys', 'tasks']\n"
        "main.app()\n"
    )
    child = subprocess.Popen(
        [sys.executable, "-c", code],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONUNBUFFERED": "1"},
    )
    assert child.stdout is not None
    assert child.stdout.readline().strip() == "working"
    time.sleep(0.1)
    child.send_signal(signal.SIGINT)
    _, complaint = child.communicate(timeout=20)
    assert child.returncode == 130
    assert complaint.strip() == "rtphys: stopped"


@dataclass
class Options:
    """Options of many spellings."""

    max_attempts: Annotated[int, Option("how often", "max_attempts")] = 1
    held: Annotated[str, Option("what is held", "set")] = ""
    out_folder: Annotated[str, Option("where to")] = ""


@pytest.mark.parametrize(
    ("problem", "said"),
    [
        (BadValue("max_attempts", 0, "at least 1"), "--max-attempts = 0 is not allowed"),
        (BadValue("set", "x", "write key=value"), "--set = 'x' is not allowed"),
        (BadValue("debug", 1, "it needs `out_folder`"), "it needs --out-folder"),
        (BadValue("set", 1, "a mapping", "some.yaml"), "some.yaml: set = 1 is not allowed"),
        (BadValue("friction", 9.0, "0 to `most`"), "friction = 9.0 is not allowed; 0 to `most`"),
        (RtphysError("choose another `out_folder`"), "choose another --out-folder"),
        (RtphysError("try `rtphys merge out=DIR`"), "try `rtphys merge --out DIR`"),
    ],
    ids=str,
)
def test_a_field_is_spelled_as_the_flag_of_the_command(
    problem: RtphysError, said: str, failing: Failing
) -> None:
    result = failing(problem, kind=Options)
    assert result.exit_code == 2 and said in result.stderr


@pytest.mark.parametrize(
    ("kind", "hint"),
    [("attribute", "--library DIR"), ("attribute of domain odd", "--domain"), ("prop", "")],
)
def test_an_unknown_name_says_where_others_are(kind: str, hint: str, failing: Failing) -> None:
    found = failing(UnknownName(kind, "mass", ["weight"])).output
    assert "Known: weight" in found and (hint in found if hint else "--" not in found)
    if kind == "attribute":  # before the names, which may fill a screen
        assert found.index(hint) < found.index("Known: ")


def test_an_error_of_the_library_names_the_flag() -> None:
    """Also below a command of two words."""
    result = RUN.invoke(app, ["physics", "sample", "--task", "global", "--set", "friction"])
    assert "rtphys: --set = 'friction' is not allowed; write key=value" in result.stderr


IDLE = "evaluate --policy idle --task click_bell --protocol clean"
REPROVE = "certify click_bell --protocol clean --out nowhere --reprove 1"


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("collect click_bell --estimate", "--estimate is gone: `--dry-run` says what the table"),
        ("check click_bell --sheet a.png", "--sheet is gone: `rtphys try TASK --picture"),
        ("verify data --shader=rt", "--shader is gone: a dataset says itself"),
        ("verify-manifest data --signed-by me", "--signed-by is gone: `ssh-keygen -Y verify`"),
        ("evaluate click_bell --set friction=0.2", "evaluate has no --set: physics follows from"),
        ("evaluate click_bell --set=friction=0.2", "evaluate has no --set: physics follows from"),
        ("evaluate click_bell --no-resume", "--no-resume is gone: a folder of another run"),
        ("check click_bell --json found.json", "--json is a switch now"),
        ("compare a b --table", "--table is gone: `--json` has the rates"),
        ("check click_bel", "did you mean 'click_bell'?"),
        ("check click_bell --protocol cleen", "did you mean 'clean'?"),
        ("check click_bell --domain globl", "did you mean 'global'?"),
        ("check click_bell --domain global", "varies no physics"),
        ("check click_bell --seeds 0", "--seeds = 0 is not allowed"),
        ("try click_bell --picture a.gif", "a.gif' is not allowed; a name that ends in .png"),
        ("try click_bell --video a.gif", "a.gif' is not allowed; a name that ends in .mp4"),
        ("collect click_bell --embodiment frank --dry-run", "did you mean 'franka-panda'?"),
        (f"{IDLE} --policy-option friction=0.05", "friction=0.05' is not allowed; physics follows"),
        (f"{IDLE} --policy-option speed=2", "the policy idle has no options"),
        (f"{IDLE} --protocol clean", "--protocol = 'clean,clean' is not allowed; each protocol"),
        (f"{REPROVE} --first-seed=3", "with --reprove the lists say that"),
        (f"{REPROVE} --feasible=3", "with --reprove the lists say that"),
        (f"{REPROVE} --replays=none", "with --reprove the lists say that"),
    ],
)
def test_what_cannot_work_is_one_clear_line(
    line: str, said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    found = RUN.invoke(app, line.split())
    (error,) = [line for line in found.stderr.splitlines() if not line.startswith("note: ")]
    assert found.exit_code == 2 and said in error
