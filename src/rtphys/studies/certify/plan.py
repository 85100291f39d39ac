"""What to certify, and all that can be refused before any work is done."""

from pathlib import Path
from typing import Annotated

from rtphys.assets.embodiment import DEFAULT
from rtphys.results.instances import FIRST_SEED
from rtphys.setting.option import (
    Option,
    Positive,
    Protocols,
    RobotName,
    Seed,
    Tasks,
    Workers,
    checked_dataclass,
    one_of,
)

BASELINES = ("replay", "twin")
"""Measured on feasible seeds. replay: the recorded actions alone; twin: those of the clean demo."""


@checked_dataclass(frozen=True)
class CertifyPlan:
    """One run of `certify`: one list for each task and protocol."""

    tasks: Tasks
    protocols: Protocols
    out: Annotated[Path, Option("The benchmark's folder.")]
    feasible: Annotated[Positive, Option("Number of feasible seeds of each list.")] = 100
    first_seed: Annotated[Seed, Option("The first seed to try.")] = FIRST_SEED
    baselines: Annotated[
        tuple[str, ...],
        one_of("baseline", (*BASELINES, "none")),
        Option(
            "replay, twin, or none. Each costs about as much as the attempt itself. "
            "A list that lacks one gains it, and keeps what it has."
        ),
    ] = BASELINES
    most_attempts: Annotated[
        Positive, Option("Number of seeds to try for one list.", "max_attempts")
    ] = 1000
    embodiment: RobotName = DEFAULT
    workers: Workers = None
