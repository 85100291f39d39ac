"""Makes the training set task by task, and keeps digests and labels of it: for days, resumable.

    python scripts/training_set.py [--workers 2] [--keep]

Collects `manifests/training_v1.yaml` into build/training_v1, a folder a task. Of each task that is
complete it writes state digests, attempts and costs to manifests/training_v1.digests.json, and a
row an attempt to docs/results/training_v1.parquet: what it is, its outcome, its physics. Then it
removes the episodes, unless `--keep` is given. Tasks that the file has are not made again.
"""

import ctypes
import os
import resource
import shutil
import signal
import sys
from collections import Counter
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Annotated, cast

import pyarrow as pa
import pyarrow.parquet as pq
import typer
from pydantic import JsonValue

from rtphys import Dataset
from rtphys.data import schema
from rtphys.data.attempts import Accepted, Rejected
from rtphys.data.files import replace_file
from rtphys.data.json_text import pretty
from rtphys.data.state_digests import DIGITS, Digests, TaskDigests, state_digest
from rtphys.doctor import check_renderer
from rtphys.spec.collection import DATASET_VERSION, CollectionSpec
from rtphys.studies.collect import collect
from rtphys.studies.requests import Run, find_collection, read_specs

NAME = "training_v1"
ROOT = Path(__file__).resolve().parents[1]
DIGESTS = ROOT / "manifests" / f"{NAME}.digests.json"
LABELS = ROOT / "docs" / "results" / f"{NAME}.parquet"
WORK = ROOT / "build" / NAME


def count_all() -> None:
    """Lets no CPU time be lost: that of workers without a parent, and that before a SIGTERM.

    The system counts a process when its parent waits for it. A worker whose server ends first gets
    this process as its parent.
    """
    PR_SET_CHILD_SUBREAPER = 36
    ctypes.CDLL(None, use_errno=True).prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))


def cpu_of_children() -> float:
    """CPU time [s] of all workers and their server, which have ended or are about to."""
    with suppress(ChildProcessError):
        while True:
            os.wait()
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def make(spec: CollectionSpec, out: Path, workers: int | None) -> float:
    """Collects a task; CPU time [s], that of earlier runs included."""
    spent = out.with_suffix(".cpu")
    before = cpu_of_children()
    try:
        collect([spec], Run(out, workers=workers))
    finally:
        earlier = float(spent.read_text()) if spent.exists() else 0.0
        total = earlier + cpu_of_children() - before
        out.parent.mkdir(parents=True, exist_ok=True)
        spent.write_text(str(total))
    return total


def digests_of(dataset: Dataset, cpu: float) -> TaskDigests:
    [entry] = dataset.task_datasets
    rows = list(entry.rows(dataset.path))
    reasons = Counter(row.reason for row in rows if isinstance(row, Rejected))
    return TaskDigests(
        config=entry.spec.name,
        embodiment=entry.spec.episode.embodiment,
        attempts=len(rows),
        rejections=dict(sorted(reasons.items())),
        frames=sum(row.frames for row in rows if isinstance(row, Accepted)),
        sentences=len({text for one in dataset for text in one.instructions.seen}),
        bytes=sum(facts.size for _, facts in dataset.files()),
        cpu_seconds=round(cpu, 1),
        episodes={str(one.seed): state_digest(one)[:DIGITS] for one in dataset},
    )


def labels_of(dataset: Dataset) -> list[dict[str, object]]:
    """A row an attempt: what it is, and each number of its physics; None where it could not act."""
    [entry] = dataset.task_datasets
    found: list[dict[str, object]] = []
    for row in entry.rows(dataset.path):
        accepted = isinstance(row, Accepted)
        known: dict[str, object] = {
            "task": entry.spec.episode.task,
            "seed": row.seed,
            "outcome": "accepted" if accepted else row.reason,
            "frames": row.frames if accepted else None,
            "recovered": row.recovered if accepted else None,
            "objects": objects(row.scene_info) if accepted else None,
        }
        for key, value in row.physics.items():
            parts = cast(list[float], value if isinstance(value, list) else [value])
            names = [key] if len(parts) == 1 else [f"{key}.{axis}" for axis in "xyz"[: len(parts)]]
            known |= zip(names, parts, strict=True)
        found.append(known)
    return found


def objects(scene: Mapping[str, JsonValue]) -> str:
    """Names of the models that the task uses, such as "050_bell/base0"."""
    info = cast(Mapping[str, str], scene.get("info", {}))
    return " ".join(sorted({text for text in info.values() if "/" in text}))


def table(rows: Sequence[Mapping[str, object]]) -> pa.Table:
    """Single precision, since a label's tolerance is far above it."""
    names = dict.fromkeys(name for row in rows for name in row)
    columns = {name: pa.array([row.get(name) for row in rows]) for name in names}
    for name, column in columns.items():
        if pa.types.is_floating(column.type):
            columns[name] = column.cast(pa.float32())
    return pa.table(columns)


def main(workers: Annotated[int | None, typer.Option()] = None, keep: bool = False) -> None:
    """Makes every task that the file has not."""
    count_all()
    specs = read_specs(find_collection(NAME))
    made = schema.read(Digests, DIGESTS) if DIGESTS.exists() else None
    tasks = dict(made.tasks) if made else {}
    rows = pq.read_table(LABELS).to_pylist() if LABELS.exists() else []
    for spec in specs:
        name, out = spec.episode.task, WORK / spec.episode.task
        if name in tasks:
            continue
        cpu = make(spec, out, workers)
        dataset = Dataset(out)
        if len(dataset) < spec.episodes:
            raise SystemExit(f"{name}: {len(dataset)} of {spec.episodes} episodes; see {out}")
        tasks[name] = digests_of(dataset, cpu)
        rows = [row for row in rows if row["task"] != name] + labels_of(dataset)
        rows.sort(key=lambda row: (row["task"], row["seed"]))
        LABELS.parent.mkdir(parents=True, exist_ok=True)
        pq.write_table(table(rows), LABELS, compression="zstd")
        driver = check_renderer().detail.split(";")[0]
        what = "Training Set v1: 50 tasks, 100 verified episodes each, under phys_random_all."
        command = f"rtphys collect --manifest {NAME}"
        digests = Digests(
            what=what,
            command=command,
            dataset_version=DATASET_VERSION,
            driver=driver,
            tasks={
                spec.episode.task: tasks[spec.episode.task]
                for spec in specs
                if spec.episode.task in tasks
            },
        )
        replace_file(DIGESTS, pretty(digests.model_dump(mode="json"), indent=1, sort=False))
        print(f"{name}: {tasks[name].attempts} attempts, {cpu:.0f} CPU-s", flush=True)
        if not keep:
            shutil.rmtree(out)


if __name__ == "__main__":
    typer.run(main)
