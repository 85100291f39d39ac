"""LeRobot datasets, v3.0 and v2.1, written directly: no torch, no lerobot.

A frame is what a policy sees and must do: state and picture of instant t, the command of t + 1. The
true rate 16.67 Hz stands in `fps` and in the time stamps; LeRobot itself only divides by it.
"""

import shutil
from collections.abc import Callable
from pathlib import Path

from rtphys.core.errors import BadFile
from rtphys.data.dataset import Dataset
from rtphys.data.faults import DatasetExists
from rtphys.data.files import make_folder
from rtphys.export.lerobot_plan import plan_for
from rtphys.export.lerobot_v2 import WriterV2
from rtphys.export.lerobot_v3 import WriterV3

Progress = Callable[[int, int], None]  # episodes done, episodes in all
PART = ".part"


def export_lerobot(
    dataset: Dataset,
    out: Path,
    *,
    version: str = "v3.0",
    camera_names: str = "aloha",
    progress: Progress | None = None,
) -> Path:
    """Writes a LeRobot dataset into a new folder; it appears whole or not at all.

    Args:
        dataset: episodes to export, in this order.
        out: folder to make.
        version: "v3.0" or "v2.1" (openpi, GR00T).
        camera_names: "aloha", "robotwin" or pairs, see `lerobot_plan.plan_for`.
        progress: called after each episode.

    Raises:
        DatasetExists: `out` is not empty.
        UnknownName, BadValue: see `plan_for`.
        BadFile: the dataset has no episodes, or one is damaged.
    """
    if not len(dataset):
        raise BadFile(dataset.path, "holds no episode to export")
    if out.exists() and any(out.iterdir()):
        raise DatasetExists(out, len(list(out.iterdir())))
    plan = plan_for(dataset[0], version, camera_names)
    part = out.with_name(f".{out.name}{PART}")
    shutil.rmtree(part, ignore_errors=True)
    make_folder(part)
    try:
        writer = (WriterV3 if version == "v3.0" else WriterV2)(part, plan)
        for done, episode in enumerate(dataset, start=1):
            writer.add(episode)
            if progress:
                progress(done, len(dataset))
        writer.finish()
        if out.exists():
            out.rmdir()
        part.rename(out)
    except BaseException:
        shutil.rmtree(part, ignore_errors=True)
        raise
    return out
