"""What to evaluate, and all that can be refused before any work is done."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from rtphys.campaign.workers.pool import Limits
from rtphys.core.errors import BadValue, NoRenderer
from rtphys.doctor import check_renderer
from rtphys.policies import PolicySetup, parse_spec
from rtphys.setting.protocol import load_protocol
from rtphys.setting.recipe import SPLITS
from rtphys.task.spec import Task, load_task

BENCHMARK = "benchmark_v1"  # the folder below `manifests/` that holds the certified lists
# Slow servers are fine, a stuck one must not hold up the rest. A model in the worker takes memory.
WATCHDOG = Limits(seconds=1800.0, memory=256e9, most_memory=256e9)


@dataclass(frozen=True)
class EvaluatePlan:
    """One run of `evaluate`.

    Args:
        policy: specification, `NAME` or `NAME:ARGUMENT`.
        episodes: of each task and protocol: the first so many certified instances; None: all.
        instances: a folder that `certify` has written, or a dataset, whose own seeds are then
            evaluated; None: the certified lists that come with rtphys.
        split: of the sentences, and of the pictures on table and wall.
        seed: of the policy's own chance.
        options: what the policy alone understands.
        video: also write each episode as an MP4.
        resume: continue what is in the folder.
        accept_changes: evaluate on lists that were certified on other ground.
    """

    policy: str
    tasks: tuple[str, ...]
    protocols: tuple[str, ...]
    out: Path
    episodes: int | None = None
    instances: Path | None = None
    split: str = "unseen"
    seed: int = 0
    options: Mapping[str, str] = field(default_factory=dict)
    video: bool = False
    resume: bool = True
    accept_changes: bool = False
    workers: int = 1
    limits: Limits = WATCHDOG

    def setup(self, task: str, protocol: str) -> PolicySetup:
        return PolicySetup(task, protocol, self.split, self.seed, self.options)

    def check(self) -> dict[str, Task]:
        """The tasks by name.

        Raises:
            UnknownName, BadValue, BadFile, NoRenderer: before any work is done.
        """
        parse_spec(self.policy)
        for name in self.protocols:
            load_protocol(name)
        if self.split not in SPLITS:
            raise BadValue("--split", self.split, f"it is one of {', '.join(SPLITS)}")
        for key, bound in {"episodes": 1, "workers": 1, "seed": 0}.items():
            value = getattr(self, key)
            if value is not None and value < bound:
                raise BadValue(f"--{key}", value, f"at least {bound}")
        tasks = {name: load_task(name) for name in self.tasks}
        if self.video and (finding := check_renderer()).status == "fail":
            cure = f"; cure: {finding.cure}" if finding.cure else ""
            raise NoRenderer(f"no video can be drawn: {finding.detail}{cure}")
        return tasks
