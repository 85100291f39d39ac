"""`_result*.txt` files in RoboTwin's format, for scripts written around its evaluation."""

from datetime import UTC, datetime
from pathlib import Path

from rtphys.data import files
from rtphys.data.json_text import pretty

COUNTS = "rtphys_counts.json"  # beside the result: how many seeds were tried for its episodes


def result_folder(out: Path, task: str, policy: str, protocol: str) -> Path:
    """Where the result files lie: scripts search a configuration's folder at any depth."""
    return out / "eval_result" / task / policy / protocol / "rtphys"


def write_result(
    folder: Path, protocol: str, split: str, counts: tuple[int, int | None, int]
) -> Path:
    """Writes a result as RoboTwin does, and its counts (rollouts, seeds tried, successes).

    Its last line is successes over episodes, which scripts multiply by the number of episodes.
    Infeasible seeds are in `COUNTS`; where nobody tried the seeds under the protocol, it has null.
    The file has both names that RoboTwin's versions have given it, and that sweeps look for;
    returns the one that says whether the protocol is clean. Raises `CannotWrite`.
    """
    files.make_folder(folder)
    rollouts, tried, successes = counts
    own = {"rollouts": rollouts, "tried": tried, "successes": successes}
    files.replace_file(folder / COUNTS, pretty(own))
    rate = successes / rollouts if rollouts else 0.0
    now = f"{datetime.now(UTC):%Y-%m-%d %H:%M:%S}"
    text = f"Timestamp: {now}\n\nInstruction Type: {split}\n\n{rate}"
    path = folder / f"_result_{'clean' if protocol == 'clean' else 'random'}.txt"
    for one in (folder / "_result.txt", path):
        files.replace_file(one, text.encode())
    return path
