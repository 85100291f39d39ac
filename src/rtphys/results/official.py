"""`_result*.txt` files in RoboTwin's format, for scripts written around its evaluation."""

from datetime import UTC, datetime
from pathlib import Path

from rtphys.data import files

FOLDER = "eval_result"


def result_file(out: Path, task: str, policy: str, protocol: str) -> Path:
    """`<out>/eval_result/<task>/<policy>/<protocol>/rtphys/_result_{clean,random}.txt`.

    Scripts search the folder of a configuration for `_result*.txt` at any depth.
    """
    kind = "clean" if protocol == "clean" else "random"
    return out / FOLDER / task / policy / protocol / "rtphys" / f"_result_{kind}.txt"


def result_text(split: str, rollouts: int, slots: int, successes: int, when: datetime) -> str:
    """Text of a result file; its last line is the success rate among all slots.

    Slots are rollouts plus infeasible seeds: scripts multiply the rate by the number of attempts to
    recover the successes.
    """
    return (
        f"Timestamp: {when:%Y-%m-%d %H:%M:%S}\n\n"
        f"Instruction Type: {split}\n\n"
        f"Rollouts: {rollouts}\n"
        f"Successes: {successes}\n"
        f"Attempts (rollouts + expert-infeasible): {slots}\n\n"
        f"{successes / slots if slots else 0.0}\n"
    )


def write_result(path: Path, split: str, counts: tuple[int, int, int]) -> None:
    """Write a result file; `counts` are (rollouts, slots, successes). Raises `CannotWrite`."""
    files.make_folder(path.parent)
    text = result_text(split, *counts, datetime.now(UTC))
    files.replace_file(path, text.encode())
