"""What to certify, and all that can be refused before any work is done."""

from dataclasses import field
from pathlib import Path
from typing import Annotated

from pydantic.dataclasses import dataclass

from rtphys.campaign.workers.pool import Limits
from rtphys.results.instances import FIRST_SEED
from rtphys.setting.option import Option, at_least, entries_of, one_of
from rtphys.setting.protocol import load_protocol
from rtphys.task.spec import Task, load_task

BASELINES = ("replay", "twin")
"""Measured on feasible seeds. replay: the recorded actions alone; twin: those of the clean demo."""


@dataclass(frozen=True)
class CertifyPlan:
    """One run of `certify`: one list for each task and protocol."""

    tasks: Annotated[
        tuple[str, ...],
        entries_of("tasks"),
        Option("Tasks or patterns; several with commas.", "task"),
    ]
    protocols: Annotated[
        tuple[str, ...], Option("clean, phys_random; several with commas.", "protocol")
    ]
    out: Annotated[Path, Option("The benchmark's folder.")]
    feasible: Annotated[
        int, at_least(1), Option("Number of feasible seeds of each task and protocol.")
    ] = 100
    first_seed: Annotated[int, at_least(0), Option("The first seed to try.")] = FIRST_SEED
    baselines: Annotated[
        tuple[str, ...],
        one_of("baseline", (*BASELINES, "none")),
        Option(
            "replay, twin, or none. Each costs about as much as the attempt itself. "
            "A list that lacks one gains it, and keeps what it has."
        ),
    ] = BASELINES
    most_attempts: Annotated[
        int, at_least(1), Option("Number of seeds to try for one list.", "max_attempts")
    ] = 1000
    workers: Annotated[int | None, at_least(1), Option("Worker processes; default one a core.")] = (
        None
    )
    limits: Limits = field(default_factory=Limits)

    @property
    def wanted_baselines(self) -> tuple[str, ...]:
        """What is asked for; `none` stands for nothing on a command line."""
        return tuple(name for name in self.baselines if name != "none")

    def check(self) -> list[Task]:
        """The tasks. Raises UnknownName, BadValue, BadFile before any work is done."""
        for name in self.protocols:
            load_protocol(name)
        return [load_task(name) for name in self.tasks]
