"""What `sensitivity` is asked for. Nothing here loads the simulator, for its help."""

from dataclasses import field
from pathlib import Path
from typing import Annotated

from rtphys.core.errors import BadValue
from rtphys.physics.attribute import attributes
from rtphys.results.evaluation import PolicyOptions
from rtphys.spec import option
from rtphys.spec.option import Option, Positive, Tasks, Workers, at_least, one_of
from rtphys.studies.requests import FirstSeed
from rtphys.task.spec import load_task

DEMONSTRATION = "replay"


@option.checked_dataclass(frozen=True)
class SearchSpec:
    """What is asked about a task: of which attributes, who acts, and how closely to look."""

    only: Annotated[
        tuple[str, ...] | None,
        one_of("attribute", attributes),
        Option("These attributes alone (comma-separated); default: all that could act."),
    ] = None
    policy: Annotated[
        str,
        Option("replay: a clean demonstration's actions; expert; or any policy of `evaluate`."),
    ] = DEMONSTRATION
    seeds: Annotated[Positive, Option("Number of paired seeds: those that succeed nominally.")] = 10
    steps: Annotated[int, at_least(0, most=10), Option("Number of bisections of the range.")] = 4
    first_seed: FirstSeed = 0
    options: PolicyOptions = field(default_factory=dict[str, str])


@option.checked_dataclass(frozen=True)
class SensitivityPlan:
    """One run of `sensitivity`: the same search in several tasks."""

    tasks: Tasks
    search: SearchSpec = SearchSpec()
    out: Annotated[Path, Option("Folder of the results, one file a task.")] = Path("sensitivity")
    workers: Workers = None

    def __post_init__(self) -> None:
        for name in self.tasks:
            load_task(name)
        if self.search.policy != DEMONSTRATION or self.search.options:
            from rtphys.policies import check_options

            check_options(self.search.policy, self.search.options)
        if self.search.policy.startswith(f"{DEMONSTRATION}:"):
            problem = "replay alone: it makes its own demonstrations"
            raise BadValue("policy", self.search.policy, problem)
