"""Certified lists as YAML files: a header, a line per feasible seed, infeasible seeds by reason."""

import json
from itertools import pairwise
from pathlib import Path
from typing import Annotated

from pydantic import ConfigDict, Field, JsonValue, ValidationError

from rtphys.core import library
from rtphys.core.errors import BadFile
from rtphys.data import files
from rtphys.data.schema_model import Model, SchemaError
from rtphys.results.instances import InstanceList, Slot

FORMAT = 1
COLUMNS = ("seed", "state", "replay", "twin")
WIDTH = 10  # infeasible seeds per line


def instance_file(folder: Path, protocol: str, task: str) -> Path:
    """Path of a list: `<folder>/<protocol>/<task>.yaml`."""
    return folder / protocol / f"{task}.yaml"


def write_instances(path: Path, instances: InstanceList) -> None:
    """Write a list, replacing the file atomically. Equal lists give equal bytes.

    Raises:
        CannotWrite: the file system refuses.
    """
    files.make_folder(path.parent)
    files.replace_file(path, "\n".join([*_lines(instances), ""]).encode())


def _lines(instances: InstanceList) -> list[str]:
    feasible = instances.feasible
    head: dict[str, object] = {
        "format": FORMAT,
        "task": instances.task,
        "protocol": instances.protocol,
        "attempts": instances.attempts,
        "feasible": len(feasible),
        **instances.fingerprint,
        "baselines": list(instances.baselines),
        "columns": list(COLUMNS),
    }
    # JSON is YAML: every value on one line, and quoted where it must be.
    lines = ["# Written by rtphys certify; docs/evaluate.md tells what it means."]
    lines += [f"{key}: {_flow(value)}" for key, value in head.items()]
    lines += ["instances:" if feasible else "instances: []"]
    lines += [f"- {_flow([s.seed, s.state, s.replay, s.twin])}" for s in feasible]
    lines += ["infeasible:" if instances.rejected else "infeasible: {}"]
    for reason in sorted(instances.rejected):
        seeds = [str(slot.seed) for slot in instances.slots if slot.reason == reason]
        rows = [", ".join(seeds[i : i + WIDTH]) for i in range(0, len(seeds), WIDTH)]
        lines.append(f"  {reason}: [{(',' + chr(10) + '    ').join(rows)}]")
    return lines


def _flow(value: object) -> str:
    return json.dumps(value, sort_keys=True)


class _File(Model):
    """What a list file must hold. Other keys are ignored."""

    model_config = ConfigDict(extra="ignore")

    task: str
    protocol: str
    attempts: int
    feasible: int
    domain: dict[str, JsonValue]
    look: str
    assets: str
    versions: dict[str, JsonValue]
    embodiment: str | None = None  # None: the aloha
    baselines: list[str]
    instances: list[Annotated[tuple[int, str, bool | None, bool | None], Field(strict=False)]]
    infeasible: dict[str, list[int]]  # seeds by reason


def read_instances(path: Path) -> InstanceList:
    """Inverse of `write_instances`.

    Raises:
        BadFile: missing, of another format, or its seeds have gaps or contradict its counts.
        SchemaError: a key is missing or has a wrong value.
    """
    data = library.read_yaml(path)
    if data.get("format") != FORMAT:
        raise BadFile(path, f"is no list of certified instances of format {FORMAT}")
    try:
        file = _File.model_validate(data)
    except ValidationError as error:
        raise SchemaError(str(path), error) from error
    slots = [Slot(seed, "", state, *baselines) for seed, state, *baselines in file.instances]
    slots += [Slot(seed, reason) for reason, seeds in file.infeasible.items() for seed in seeds]
    slots.sort(key=lambda slot: slot.seed)
    if any(after.seed != before.seed + 1 for before, after in pairwise(slots)):
        raise BadFile(path, "a seed is missing or occurs twice; certify it again")
    included = {"domain", "look", "assets", "versions", "embodiment"}
    fingerprint = file.model_dump(include=included, exclude_none=True)
    instances = InstanceList(
        file.task, file.protocol, fingerprint, tuple(slots), tuple(file.baselines)
    )
    said, counted = (file.attempts, file.feasible), (len(slots), len(instances.feasible))
    if said != counted:
        raise BadFile(path, f"attempts, feasible are {said}, but it holds {counted} seeds")
    return instances
