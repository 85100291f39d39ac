"""Draw the first failures of trained policies: python failures.py run failures.png

One row a task: the policy that was trained on `clean`, on the first instance of `phys_random` that
it fails. Runs these episodes again, with pictures of every instant.
"""

import json
import sys
from pathlib import Path

import cv2
import numpy as np
from experiment import POLICY, RTPHYS, SHIPPED, SIZE, run, weights

import rtphys
from rtphys.report.pictures import captioned

TRAIN, TEST = "clean", "phys_random"
MOMENTS = 5
SHOWN = (240, 180)  # width, height [px] of each picture


def first_failure(out: Path, task: str) -> rtphys.Episode | None:
    """The first instance that fails, recorded; none without one."""
    cells = json.loads((out / "matrix" / f"{task}.json").read_text())["cells"]
    cell = next((c for c in cells if (c["train"], c["test"]) == (TRAIN, TEST)), None)
    if cell is None or not cell["failed"]:
        return None
    count = 1 + sum(seed < min(cell["failed"]) for seed in cell["solved"])
    folder = out / "failures" / task
    given = ("--policy-option", f"weights={weights(out, task, TRAIN)}", "--size", SIZE)
    what = ("--task", task, "--protocol", TEST, "--instances", SHIPPED, "--episodes", count)
    where = ("--out", folder / "results", "--record", folder / "record", "--sense", "states")
    run(*RTPHYS, "evaluate", "--policy", POLICY, *given, *what, *where)
    # Larger pictures from the states; the policy must see what it saw in the experiment.
    run(*RTPHYS, "render", folder / "record", "--size", "320x240", "--out", folder / "drawn")
    return rtphys.Dataset(folder / "drawn").failures()[0]


def main() -> None:
    out, picture = Path(sys.argv[1]), Path(sys.argv[2])
    rows, moments = {}, [f"{100 * n // (MOMENTS - 1)} % of the time" for n in range(MOMENTS)]
    for path in sorted((out / "matrix").glob("*.json")):
        if (episode := first_failure(out, path.stem)) is not None:
            picked = np.linspace(0, len(episode) - 1, MOMENTS).round().astype(int)
            rows[f"{path.stem} {episode.seed}"] = [
                cv2.resize(episode.image("head", int(t)), SHOWN) for t in picked
            ]
    cv2.imwrite(str(picture), captioned(rows, moments)[..., ::-1], [cv2.IMWRITE_WEBP_QUALITY, 65])


if __name__ == "__main__":
    main()
