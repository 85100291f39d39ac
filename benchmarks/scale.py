"""How a collection grows with the workers on this machine; docs/scale.md says how to run it.

    python benchmarks/scale.py [--workers 1,2] [--episodes 4] [--ray]      about ten minutes

Start: CPU time of a whole `rtphys collect` of one episode, and of each further worker to its first
job. Then, by number of workers: episodes a minute and pictures a second of one task, from the first
episode to the last, and of the manifest `smoke` from the command to its end. Wall time on a machine
that others use says little; the CPU time of a picture holds anywhere.
"""

import argparse
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from rich.console import Console
from rich.table import Table

import rtphys
from rtphys.assets.pack import default_pack
from rtphys.campaign.local import LocalPool
from rtphys.campaign.machine import cores
from rtphys.campaign.series import Batch, Listener, Progress, run_all
from rtphys.sim import renderer
from rtphys.spec.collection import CollectionSpec
from rtphys.spec.episode import EpisodeSpec
from rtphys.studies.collect import collect
from rtphys.studies.requests import Run, find_collection, read_specs
from rtphys.studies.worker import StudyWorker

TASK = CollectionSpec(EpisodeSpec("click_bell", "phys_random"))


class Stopwatch(Listener):
    """Notes when the first episode is there, and when the last."""

    def started(self, progresses: Sequence[Progress]) -> None:
        self._progresses, self.first, self.last = progresses, 0.0, 0.0

    def ticked(self) -> None:
        if any(progress.new_accepted for progress in self._progresses):
            self.last = time.monotonic()
            self.first = self.first or self.last


@dataclass
class StartMeter(StudyWorker[int, float]):
    """Its job is the CPU time that its worker has spent until then."""

    def start(self) -> None:
        renderer.ready()

    def do(self, job: int) -> float:
        time.sleep(0.5)  # so that another worker takes the next
        return time.process_time()


def cpu_of_start() -> tuple[float, float]:
    """CPU time [s] of a whole collection of one episode, and of a worker to its first job."""
    with tempfile.TemporaryDirectory(prefix="rtphys-scale-") as folder:
        options = f"--task {TASK.episode.task} --episodes 1 --workers 1 --out {folder}"
        line = [sys.executable, "-m", "rtphys.cli.main", "collect", *options.split()]
        before = _cpu_of_children()
        subprocess.run(line, check=True, capture_output=True)
        whole = _cpu_of_children() - before
    import scale  # this file, as a worker can import it

    batch = Batch[int, float]("start", dict(enumerate(range(4))), lambda *_: 0.0)
    with LocalPool[int, float](scale.StartMeter(default_pack()), 4) as pool:
        run_all([batch], pool)
    return whole, max(batch.results.values())


def _cpu_of_children() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


@dataclass(frozen=True)
class Rates:
    """What so many workers make."""

    episodes: float  # [1/min]
    pictures: float  # [1/s]
    cpu: float  # [ms] a picture, everything included


def rates(specs: Sequence[CollectionSpec], run: Run, whole: bool = False) -> Rates:
    """`whole`: from the command on, else from the first episode."""
    watch, begun, cpu = Stopwatch(), time.monotonic(), _cpu_of_children()
    made = sum(progress.new_accepted for progress in collect(specs, run, watch))
    cpu = _cpu_of_children() - cpu
    data = rtphys.Dataset(run.out)
    pictures = sum(len(one.frames.time) * len(one.frames.cameras) for one in data)
    seconds, share = watch.last - (begun if whole else watch.first), 1 if whole else 1 - 1 / made
    return Rates(
        60 * made * share / seconds, pictures * share / seconds, 1000 * cpu / max(pictures, 1)
    )


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--workers", default=f"1,{cores()}", help="numbers of workers")
    parser.add_argument("--episodes", type=int, default=6, help="of each worker")
    parser.add_argument("--ray", action="store_true", help="also on a private Ray cluster")
    asked = parser.parse_args()
    whole, further = cpu_of_start()
    table = Table("workers", "kind", "episodes/min", "pictures/s", "CPU-ms a picture")
    for count in map(int, asked.workers.split(",")):
        smoke = read_specs(find_collection("smoke"))
        single = [replace(TASK, episodes=asked.episodes * count)]
        for kind, specs in (("one task", single), ("smoke, whole", smoke)):
            for runner in ("local", "ray") if asked.ray else ("local",):
                with tempfile.TemporaryDirectory(prefix="rtphys-scale-") as folder:
                    address = "local" if runner == "ray" else None
                    run = Run(Path(folder) / "data", workers=count, runner=runner, address=address)
                    made = rates(specs, run, kind != "one task")
                numbers = f"{made.episodes:.1f}", f"{made.pictures:.0f}", f"{made.cpu:.1f}"
                table.add_row(str(count), f"{kind}, {runner}", *numbers)
    console = Console()
    console.print(f"start: {whole:.1f} CPU-s for one episode, {further:.2f} a further worker")
    console.print(table)


if __name__ == "__main__":
    main()
