"""Certified lists as YAML: a header, one line a feasible seed, the infeasible ones by reason."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path

from rtphys.core import library
from rtphys.core.errors import BadFile
from rtphys.data import files
from rtphys.data.episode import JSON
from rtphys.results.instances import InstanceList, Slot

FORMAT = 1
COLUMNS = ("seed", "state", "replay", "twin")
WIDTH = 10  # infeasible seeds a line


def instance_file(folder: Path, protocol: str, task: str) -> Path:
    """Where a list lies: `<folder>/<protocol>/<task>.yaml`."""
    return folder / protocol / f"{task}.yaml"


def write_instances(path: Path, instances: InstanceList) -> None:
    """Replaces the file by a rename. Equal lists give equal bytes. Raises `CannotWrite`."""
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


def read_instances(path: Path) -> InstanceList:
    """Inverse of `write_instances`.

    Raises:
        BadFile: missing, not such a list, or its seeds have gaps or contradict its counts.
    """
    data = library.read_yaml(path)
    if data.get("format") != FORMAT:
        raise BadFile(path, f"is no list of certified instances of format {FORMAT}")
    try:
        slots = _slots(data)
        fingerprint: dict[str, JSON] = {
            key: data[key]  # type: ignore[misc] - compared, never computed with
            for key in ("domain", "look", "assets", "versions")
        }
        measured = tuple(map(str, data["baselines"]))  # type: ignore[call-overload]
        found = InstanceList(str(data["task"]), str(data["protocol"]), fingerprint, slots, measured)
        counts = data["attempts"], data["feasible"]
    except (KeyError, TypeError, ValueError) as error:
        raise BadFile(path, f"is damaged: {type(error).__name__}: {error}") from error
    seeds = [slot.seed for slot in slots]
    if seeds and seeds != list(range(seeds[0], seeds[0] + len(seeds))):
        raise BadFile(path, "a seed is missing or stands there twice; certify it anew")
    if counts != (found.attempts, len(found.feasible)):
        raise BadFile(path, f"holds other counts than attempts, feasible = {counts}")
    return found


def _slots(data: Mapping[str, object]) -> tuple[Slot, ...]:
    rows, rejected = data["instances"], data["infeasible"]
    if not isinstance(rows, Sequence) or not isinstance(rejected, Mapping):
        raise TypeError("instances is a list, infeasible a mapping")
    found = []
    for seed, state, replay, twin in rows:
        found.append(Slot(_integer(seed), "", str(state), _flag(replay), _flag(twin)))
    for reason, seeds in rejected.items():
        found += [Slot(_integer(seed), str(reason)) for seed in seeds]
    return tuple(sorted(found, key=lambda slot: slot.seed))


def _integer(value: object) -> int:
    if isinstance(value, bool) or not isinstance(value, int):
        raise TypeError(f"{value!r} is no seed")
    return value


def _flag(value: object) -> bool | None:
    if value is not None and not isinstance(value, bool):
        raise TypeError(f"{value!r} is neither true, false nor null")
    return value
