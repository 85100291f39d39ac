"""Record what the commands write, so that a refactor can be held to the same bytes.

    python scripts/record_outputs.py record FOLDER
    python scripts/record_outputs.py compare BEFORE AFTER

`record` runs the commands of the rtphys that this interpreter imports. `compare` wants every file
equal, but for what names a version of the code itself: package versions, digests of task files,
and the checksums that cover them. Exit code 1: something else differs.
"""

import argparse
import json
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path

TASKS = (
    "click_bell,handover_mic,open_laptop,place_bread_skillet,put_bottles_dustbin,stack_bowls_two"
)
EPISODES = "2"
# Keys of JSON whose values name the code or sum up files that name it; a journal's chain too.
OF_THE_CODE = {"versions", "check", "sha256", "size", "bytes", "journal", "task_sha", "command"}
SUMS = {"contentSize", "sha256"}


def rtphys(*arguments: str, check: bool = True) -> subprocess.CompletedProcess[str]:
    """Runs one command to its end."""
    command = [sys.executable, "-m", "rtphys.cli.main", *arguments]
    done = subprocess.run(command, capture_output=True, text=True)
    if check and done.returncode:
        sys.exit(f"{' '.join(arguments)}\n{done.stdout}{done.stderr}")
    return done


def collect(out: Path, *more: str, tasks: str = TASKS, episodes: str = EPISODES) -> list[str]:
    """Arguments of a collection."""
    return ["collect", "--task", tasks, "--episodes", episodes, "--out", str(out), *more]


def killed(out: Path, *more: str) -> None:
    """Collects, killed twice in the middle, then resumed."""
    command = [sys.executable, "-m", "rtphys.cli.main", *collect(out, *more)]
    for seconds in (12, 20):
        process = subprocess.Popen(
            command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True
        )
        time.sleep(seconds)
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()
    rtphys(*collect(out, *more))


def record(root: Path) -> None:
    """Everything that is compared, each in a folder of its own."""
    root.mkdir(parents=True)
    for protocol in ("clean", "phys_random_all"):
        chosen = ("--protocol", protocol)
        rtphys(*collect(root / f"{protocol}_1_worker", *chosen, "--workers", "1"))
        rtphys(*collect(root / f"{protocol}_2_workers", *chosen, "--workers", "2"))
        killed(root / f"{protocol}_killed", *chosen)
        parts = []
        for index in ("1", "2"):
            parts.append(root / f"{protocol}_shard_{index}")
            rtphys(*collect(parts[-1], *chosen, "--shard", f"{index}/2"))
        rtphys("merge", *map(str, parts), "--out", str(root / f"{protocol}_merged"))
        rtphys(*collect(root / f"{protocol}_legacy", *chosen, "--layout", "legacy"))
    some = "click_bell,open_laptop,place_bread_skillet"
    varied = ("--protocol", "phys_random")
    rtphys(*collect(root / "twin", *varied, "--twin", "clean", tasks=some))
    rtphys(*collect(root / "sweep", *varied, "--sweep", "friction=0.2,0.9", tasks=some))
    parts = [root / f"deep_shard_{index}" for index in (1, 2)]
    for part in parts:  # one task, whose seeds the shards share
        share = part.name[-1] + "/2"
        rtphys(*collect(part, *varied, "--shard", share, tasks="open_laptop", episodes="4"))
    rtphys("merge", *map(str, parts), "--out", str(root / "deep_merged"))
    for way in ("--only=friction,object_mass", "--set=friction=0.3", "--no-recovery"):
        rtphys(*collect(root / f"chosen{way.replace('=', '_')}", *varied, way, tasks=some))
    rtphys(
        "convert", str(root / "clean_1_worker"), "--out", str(root / "converted"), "--to", "legacy"
    )
    rtphys("export", "lerobot", str(root / "clean_1_worker"), "--out", str(root / "lerobot"))
    both = ("--protocol", "clean,phys_random")
    bench = ("--task", "click_bell,open_laptop,stack_blocks_two", "--protocol", "phys_random")
    lists = ("--feasible", "8", "--replays", "replay,twin", "--out", str(root / "certified"))
    rtphys("certify", *bench, *lists)
    few = ("--task", "click_bell,open_laptop", "--episodes", "2")
    demos = str(root / "clean_1_worker")
    for policy, more in (
        ("expert", ()),
        ("random", ()),
        (f"replay:{demos}", ("--instances", demos)),
    ):
        out = root / ("records_" + policy.partition(":")[0])
        rtphys("evaluate", "--policy", policy, *few, *both, *more, "--out", str(out))
    video = ("--video", "--protocol", "phys_random_all", "--out", str(root / "records_video"))
    rtphys("evaluate", "--policy", "expert", "--task", "click_bell", "--episodes", "1", *video)


def files_of(root: Path) -> dict[str, Path]:
    return {
        path.relative_to(root).as_posix(): path
        for path in sorted(root.rglob("*"))
        if path.is_file() and path.name not in ("error.log",) and "lock" not in path.name
    }


def without_code(value: object) -> object:
    """JSON less what names the code."""
    if isinstance(value, dict):
        return {k: without_code(v) for k, v in value.items() if k not in OF_THE_CODE | SUMS}
    if isinstance(value, list):
        return [without_code(one) for one in value]
    return value


def content(path: Path, before: Path) -> object:
    """What must be equal: parsed where the file may name the code, else the bytes."""
    data = path.read_bytes()
    if path.suffix in (".json", ".jsonl", ".journal") or path.name.endswith("journal"):
        lines = data.decode().splitlines() if path.suffix != ".json" else [data.decode()]
        text = [json.dumps(without_code(json.loads(line))) for line in lines]
        return [line.replace(str(before), "") for line in text]
    if path.name.startswith("_result"):  # RoboTwin's result files tell the time of day
        return re.sub(rb"^Timestamp: .*\n", b"", data)
    if path.suffix == ".yaml":
        return re.sub(rb"\nversions: .*\n", b"\n", data)
    return data


def compare(before: Path, after: Path) -> list[str]:
    """One line a difference."""
    old, new = files_of(before), files_of(after)
    wrong = [f"{name}: only {'before' if name in old else 'after'}" for name in old.keys() ^ new]
    same = parsed = 0
    for name in sorted(old.keys() & new.keys()):
        if old[name].read_bytes() == new[name].read_bytes():
            same += 1
        elif content(old[name], before) == content(new[name], after):
            parsed += 1
        else:
            wrong.append(f"{name}: differs")
    print(f"{same} files with the same bytes, {parsed} that differ in what names the code alone")
    return sorted(wrong)


def main(arguments: Sequence[str]) -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    commands = parser.add_subparsers(dest="command", required=True)
    commands.add_parser("record").add_argument("folder", type=Path)
    both = commands.add_parser("compare")
    both.add_argument("before", type=Path)
    both.add_argument("after", type=Path)
    chosen = parser.parse_args(arguments)
    if chosen.command == "record":
        record(chosen.folder.absolute())
        return 0
    wrong = compare(chosen.before.absolute(), chosen.after.absolute())
    print("\n".join(wrong) or "no other difference")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
