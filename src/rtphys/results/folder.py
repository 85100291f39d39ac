"""Where the results of one evaluation lie, and how to read them again.

for record in rtphys.results.read_results("eval/pi0").records[("phys_random", "click_bell")]:
    print(record.seed, record.success, record.physics["friction"])
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from rtphys.core.errors import BadFile
from rtphys.data import files
from rtphys.data.episode import JSON
from rtphys.data.json_text import parse_mapping
from rtphys.results.instance_file import instance_file, read_instances
from rtphys.results.instances import InstanceList
from rtphys.results.record import EpisodeRecord
from rtphys.results.record_file import read_records

RUN = "run.json"
SUMMARY = "summary.json"
INSTANCES = "instances"


def record_file(out: Path, protocol: str, task: str) -> Path:
    """`<out>/<protocol>/<task>.jsonl`."""
    return out / protocol / f"{task}.jsonl"


def video_file(out: Path, protocol: str, task: str, seed: int) -> Path:
    """`<out>/video/<protocol>/<task>/<seed>.mp4`."""
    return out / "video" / protocol / task / f"{seed}.mp4"


@dataclass(frozen=True, eq=False)
class Results:
    """One evaluation of one policy."""

    path: Path
    run: Mapping[str, JSON]  # policy, split, episodes, versions, ...
    records: Mapping[tuple[str, str], Sequence[EpisodeRecord]]  # by (protocol, task)
    lists: Mapping[tuple[str, str], InstanceList]  # what each was run on

    @property
    def policy(self) -> str:
        return str(self.run["policy"])


def read_results(out: str | Path) -> Results:
    """A result folder, also of a run that is not finished.

    Raises:
        BadFile: no result folder, or a file in it is damaged.
    """
    out = Path(out)
    if not (out / RUN).is_file():
        raise BadFile(out, f"holds no results: there is no {RUN}, which rtphys evaluate writes")
    run = parse_mapping(files.read(out / RUN), out / RUN)
    records, lists = {}, {}
    for protocol in _names(run, "protocols", out):
        for task in _names(run, "tasks", out):
            path = record_file(out, protocol, task)
            records[protocol, task] = read_records(path) if path.exists() else []
            copied = instance_file(out / INSTANCES, protocol, task)
            lists[protocol, task] = read_instances(copied)
    return Results(out, run, records, lists)


def _names(run: Mapping[str, JSON], key: str, out: Path) -> list[str]:
    names = run.get(key)
    if not isinstance(names, list):
        raise BadFile(out / RUN, f"{key} must be a list")
    return [str(name) for name in names]
