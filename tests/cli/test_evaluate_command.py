"""`rtphys evaluate`: what it says where an evaluation cannot begin."""

from pathlib import Path

from typer.testing import CliRunner

from rtphys.cli.main import app

TASK = "click_bell"


def test_the_command_spells_what_certifies(tmp_path: Path) -> None:
    options = ["--task", TASK, "--protocol", "clean", "--instances", str(tmp_path)]
    done = CliRunner().invoke(app, ["evaluate", "--policy", "idle", *options])
    assert done.exit_code == 2
    cure = f"`rtphys certify --task {TASK} --protocol clean --feasible 100 --out FOLDER`"
    assert f"does not exist; to certify: {cure}, then set --instances" in done.stderr
