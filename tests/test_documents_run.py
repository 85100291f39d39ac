"""What the documents tell a reader to run does run, page by page, in the order of the page.

With as few episodes as there can be, and on a dataset that is collected for all pages.
"""

import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from pages import PAGES, ROOT, parts

pytestmark = [pytest.mark.slow, pytest.mark.sim, pytest.mark.render]
NOT_HERE = {  # beginning of a command line, after its global options -> why it is not run
    "collect --manifest training_v1": "hours",
    "verify training_v1": "hours",
    "merge 'parts/*' --out training_v1": "hours",
    "identify --task 'stack_*'": "an hour",
    "identify --task lift_pot": "the estimator is the reader's",
    "compare identify/": "the same",
    "identify --task '*'": "hours",
    "sensitivity --task '*'": "hours",
    "view": "opens a window",
    "evaluate --policy 'lerobot:": "needs LeRobot",
    "evaluate --policy 'openpi:": "needs a server",
    "evaluate --policy 'xpolicylab:": "needs a server",
    "evaluate --policy robotwin:": "needs a RoboTwin checkout",
    "evaluate --policy python:examples/": "needs the weights of a training",
    "export lerobot data --out robot/me/data": "the twins under `clean` have no number to give",
    "verify data --quick --expect": "no digest of this dataset",
}
FEWER = (
    (r"--(episodes|feasible) \d+", r"--\1 1"),
    (r"--seeds \d+", "--seeds 2"),
    (r"--size 640x480", "--size 160x120"),  # with all senses an episode would take 3 GB
    (r"--task click_bell,place_empty_cup,.*", "--task click_bell"),
    (r"'stack_\*'", "stack_blocks_two"),
    (r"heft,rub,swing,tap", "heft"),
    (r"^(collect (?!.*--episodes).*)", r"\1 --episodes 1"),
    (r"^(collect (?!.*--size).*--out data\b.*)", r"\1 --size 128x96"),  # an export has one size
    (r"(identify .*--episodes) 1", r"\1 20"),
    (r"^(certify (?!.*--feasible).*)", r"\1 --feasible 1"),
    (r"^(sensitivity (?!.*--seeds).*)", r"\1 --seeds 2 --steps 1"),
)
# A block that uses what the page says in words.
GIVEN = """
import sys, types
try:
    import torch
except ImportError:
    torch = types.ModuleType("torch")
    torch.utils = types.SimpleNamespace(data=types.SimpleNamespace(Dataset=object))
t = 0
"""
PREPARED = (
    # The first seed of the mouse fails: a failure to look at.
    "collect --task click_bell --protocol phys_random --twin clean --episodes 4 --size 128x96 "
    "--sense depth,segmentation,pointcloud,touch,states --out data",
    "collect --task place_mouse_pad --protocol phys_random --twin clean --episodes 1 --seed 100027 "
    "--size 128x96 --sense depth,segmentation,pointcloud,touch,states --keep-failures all "
    "--out data",
    "collect --task click_bell --shard 1/2 --episodes 2 --size 128x96 --out parts/1",
    "collect --task click_bell --shard 2/2 --episodes 2 --size 128x96 --out parts/2",
    "evaluate --policy idle --task click_bell --protocol clean --episodes 1 --out eval/pi0",
    "evaluate --policy random --task click_bell --protocol clean --episodes 1 --out eval/random",
)


def rtphys(line: str, folder: Path) -> str:
    """What went wrong with a command line, or nothing."""
    command = [sys.executable, "-m", "rtphys.cli.main"]
    for word in shlex.split(line):  # as a shell would
        command += sorted(map(str, folder.glob(word))) if "/*" in word else [word]
    problem = fault(command, folder)
    return problem and f"rtphys {line}: {problem}"


def fault(command: list[str], folder: Path) -> str:
    """The end of what a program says that fails."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT / "src")}
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)
    return done.stderr[-1500:] if done.returncode else ""


@pytest.fixture(scope="module")
def prepared(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with what the pages take for granted."""
    folder = tmp_path_factory.mktemp("prepared")
    problems = [rtphys(line, folder) for line in PREPARED]
    assert not any(problems), problems
    return folder


def runnable(words: list[str]) -> str:
    """A command line with as little work as there can be; empty where it cannot run here."""
    line = shlex.join(words)
    own = re.match(r"(--library \S+ )?", line)
    head, line = (own[0], line[own.end() :]) if own else ("", line)
    if any(line.startswith(beginning) for beginning in NOT_HERE):
        return ""
    for pattern, fewer in FEWER:
        line = re.sub(pattern, fewer, line)
    if line.startswith("collect") and "--out" not in line:  # not into the dataset of all pages
        line += f" --out collected/{re.sub(r'[^a-z]+', '_', line)}"
    return head + line


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_a_page_does_what_it_says(page: Path, prepared: Path, tmp_path: Path) -> None:
    folder = tmp_path / "reader"
    shutil.copytree(prepared, folder)
    (folder / "examples").symlink_to(ROOT / "examples")
    problems, script = [], GIVEN
    for part in parts(page):
        if part.file and "…" not in part.text:
            (folder / part.file).parent.mkdir(parents=True, exist_ok=True)
            (folder / part.file).write_text(part.text)
        elif part.language == "python":
            script += part.text
        problems += [rtphys(line, folder) for words in part.commands if (line := runnable(words))]
    if script != GIVEN:
        problems.append(fault([sys.executable, "-c", script], folder))
    assert not [problem for problem in problems if problem]


def test_every_reason_not_to_run_is_needed() -> None:
    lines = [re.sub(r"^--library \S+ ", "", shlex.join(c)) for p in PAGES for q in parts(p)
             for c in q.commands]  # fmt: skip
    assert [b for b in NOT_HERE if not any(line.startswith(b) for line in lines)] == []
