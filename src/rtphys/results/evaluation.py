"""The results of a policy's evaluation: a record an episode, a ledger a task and protocol.

```python
for record in rtphys.results.read_results("eval/pi0").records[("phys_random", "click_bell")]:
    print(record.seed, record.success, record.physics["friction"])
```
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path, PurePath
from typing import Annotated, Any

from pydantic import FiniteFloat

from rtphys.core.errors import BadFile
from rtphys.data.ledger import has_begun, read_header, read_rows
from rtphys.results.instances import ENFORCED, Fingerprint, InstanceList, read_lists
from rtphys.spec.episode import SPLITS, EpisodeSpec
from rtphys.spec.option import Offers, Option, Seed, checked_dataclass, one_of
from rtphys.spec.recording import RecordingSpec
from rtphys.spec.stored import CLOSED

SUMMARY = "summary.json"
LEDGERS = "*/*.ledger"
INSTANCES = "instances"  # folder of the certified lists that were run
DIGITS = 8  # of a digest that is shown
UNFIT = r"[^A-Za-z0-9._=-]+"  # in the name of a file
LONGEST_NAME = 150  # characters that a file system takes in any case, with room for more


@checked_dataclass(frozen=True, config=CLOSED)
class EpisodeRecord:
    """Outcome of a policy on one benchmark instance; a row of a ledger.

    It holds no wall-clock time, because repeated runs must give equal records.
    """

    task: str
    protocol: str
    seed: int
    success: bool  # the success condition was true at some instant, as RoboTwin counts
    held: bool = False  # and was still true 0.5 s after the policy had stopped
    # Of a failure: step_limit, gave_up, policy_error, worker_crash, worker_hang (both: twice), or
    # infeasible: the world could not be set up, as the certification fingerprint differs.
    reason: str = ""
    first_touch: FiniteFloat | None = None  # [s] simulated, when the condition first was true
    steps: int = 0  # number of actions
    time: FiniteFloat = 0.0  # [s] simulated, until the policy stopped
    unreachable: int = 0  # number of end-effector targets that no joint posture reaches
    force: FiniteFloat = 0.0  # [N] largest on one link that is no finger
    torque: FiniteFloat = 0.0  # largest in an arm joint, as a share of its motor's largest
    rough: bool = False  # the expert would have been rejected for it: "collision", "overloaded"
    # In how many actions a joint or opening was beyond its limits, and put to them, by its name.
    clipped: Mapping[str, int] = field(default_factory=dict[str, int])
    language: str = ""  # of a failure: what the actions' numbers usually mean, such as degrees
    # Value by attribute or other draw.
    physics: Mapping[str, Any] = field(default_factory=dict[str, Any])
    inert: tuple[str, ...] = ()  # attributes that could not act in this episode
    state: str = ""  # SHA-256 over the states of the episode
    detail: str = ""  # a traceback, or what is missing for success

    @property
    def raised(self) -> str:
        """First line of the error that ends the traceback: its message may have more."""
        lines = self.detail.strip().splitlines()
        frames = [n for n, line in enumerate(lines) if line.startswith('  File "')]
        rest = lines[frames[-1] + 1 :] if frames else lines[-1:]
        return next((line for line in rest if not line.startswith(" ")), self.detail.strip())


PolicyOptions = Annotated[
    Mapping[str, str], Option("key=value for the policy; repeatable.", "policy_option")
]


@checked_dataclass(frozen=True, config=CLOSED)
class EvaluationSpec:
    """A policy in one task under one protocol."""

    policy: Annotated[
        str, Option("expert, random, replay:DATASET, lerobot:PATH, python:FILE:NAME ...")
    ]
    episode: Annotated[EpisodeSpec, Offers("split", "embodiment")] = EpisodeSpec(split="unseen")
    recording: Annotated[RecordingSpec, Offers("senses", "size")] = RecordingSpec()
    seed: Annotated[Seed, Option("The policy's own random seed.", "policy_seed")] = 0
    options: PolicyOptions = field(default_factory=dict[str, str])
    sentences: Annotated[
        str | None,
        one_of("split of sentences", SPLITS),
        Option("seen or unseen sentences. Default: as for the textures."),
    ] = None

    @property
    def hears(self) -> str:
        """The split of the sentences that the policy gets."""
        return self.sentences or self.episode.split

    @property
    def actor(self) -> str:
        """The policy as it is named, and its options: `python:mine:make low=0.9`."""
        return " ".join([self.policy, *(f"{key}={value}" for key, value in self._options)])

    @property
    def short_actor(self) -> str:
        """The same for paths and tables: `python_mine_make.low=0.9`."""
        more = (re.sub(UNFIT, "_", f"{key}={value}") for key, value in self._options)
        return ".".join([short_name(self.policy), *more])[:LONGEST_NAME]

    @property
    def _options(self) -> list[tuple[str, str]]:
        return sorted(self.options.items())

    def of(self, protocol: str, task: str) -> "EvaluationSpec":
        """The same in another task or under another protocol."""
        return replace(self, episode=replace(self.episode, task=task, protocol=protocol))

    @property
    def key(self) -> tuple[str, str]:
        """Protocol and task."""
        return self.episode.protocol, self.episode.task


@checked_dataclass(frozen=True, config=CLOSED)
class EvaluationHeader:
    """The first line of a ledger: what two runs must share to continue each other."""

    spec: EvaluationSpec
    fingerprint: Fingerprint  # of the certified list, as it is where the policy is run
    policy_files: str = ""  # digest over the files that the policy's name leads to


def short_name(policy: str) -> str:
    """Name of a policy in paths and tables: `robotwin:.../pi0/deploy_policy.py` -> `pi0`."""
    name, _, argument = policy.partition("?")[0].partition(":")
    if not argument:
        return name
    path = PurePath(argument)
    last = path.parent.name if path.suffix in (".py", ".yml") and path.parent.name else path.name
    full = last if name == "robotwin" else f"{name}_{last}"
    return re.sub(r"[^A-Za-z0-9._-]+", "_", full)[:LONGEST_NAME]


def ledger_file(out: Path, protocol: str, task: str) -> Path:
    """`<out>/<protocol>/<task>.ledger`."""
    return out / protocol / f"{task}.ledger"


def video_file(out: Path, protocol: str, task: str, seed: int, success: bool) -> Path:
    """`<out>/video/<protocol>/<task>/<seed>_success.mp4`, or `<seed>_failure.mp4`."""
    outcome = "success" if success else "failure"
    return out / "video" / protocol / task / f"{seed}_{outcome}.mp4"


def is_evaluation(folder: Path) -> bool:
    """Whether an evaluation has written into a folder."""
    return any(folder.glob(LEDGERS))


def headers(out: Path) -> dict[Path, EvaluationHeader]:
    """First line of each ledger of a result folder that has begun. Raises `BadFile`."""
    if (out / "run.json").exists():
        raise BadFile(out, "holds results of an earlier version, which are not read")
    paths = filter(has_begun, sorted(out.glob(LEDGERS)))
    return {path: read_header(EvaluationHeader, path) for path in paths}


@dataclass(frozen=True, eq=False)
class Results:
    """Everything in the result folder of one policy's evaluation."""

    path: Path
    headers: Mapping[tuple[str, str], EvaluationHeader]  # by (protocol, task), where it has begun
    records: Mapping[tuple[str, str], Sequence[EpisodeRecord]]  # by (protocol, task)
    lists: Mapping[tuple[str, str], InstanceList]  # certified seeds, same keys

    @property
    def spec(self) -> EvaluationSpec:
        """That of any task, since they differ in nothing else."""
        return next(iter(self.headers.values())).spec

    @property
    def policy(self) -> str:
        return self.spec.policy

    @property
    def robot(self) -> str:
        return self.spec.episode.embodiment

    def ground(self, protocol: str, task: str) -> Mapping[str, str]:
        """What decides an episode but its seed, as a table of short texts; versions that matter."""
        found = {"robot": self.robot, "split": self.spec.episode.split}
        found |= {"sentences": self.spec.hears}
        if (header := self.headers.get((protocol, task))) is not None:
            of, versions = header.fingerprint, header.fingerprint.versions
            digests = {"domain": of.domain.digest, "look": of.look, "assets": of.assets}
            digests |= {key: versions.get(key, "") for key in ENFORCED if key != "robot"}
            found |= {key: digest[:DIGITS] for key, digest in digests.items()}
        return found

    def unfinished(self, protocol: str, task: str) -> tuple[int, int] | None:
        """How many episodes were run, and of how many; None where all were."""
        done = len(self.records[protocol, task])
        wanted = len(self.lists[protocol, task].feasible)
        return (done, wanted) if done < wanted else None


def read_results(out: str | Path) -> Results:
    """Reads a result folder, finished or not.

    Raises `BadFile`: it is no result folder, or a file in it is damaged.
    """
    out = Path(out)
    known = headers(out)
    if not known:
        raise BadFile(out, "holds no results: there is no ledger that rtphys evaluate writes")
    begun = {header.spec.key: header for header in known.values()}
    records = {header.spec.key: [*read_rows(EpisodeRecord, path)] for path, header in known.items()}
    lists = {
        (path.stem, task): listed
        for path in sorted((out / INSTANCES).glob("*.jsonl"))
        for task, listed in read_lists(path).items()
    }
    if missing := records.keys() - lists:
        protocol, task = min(missing)
        raise BadFile(out / INSTANCES, f"has no list of {task}, {protocol}")
    return Results(out, begun, {key: records.get(key, []) for key in lists}, lists)
