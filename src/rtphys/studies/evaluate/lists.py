"""The certified instances of an evaluation; it never searches for any itself."""

from collections.abc import Mapping
from pathlib import Path

from rtphys.core import library
from rtphys.core.errors import BadFile, BadValue, RtphysError
from rtphys.data.conditions import differences
from rtphys.data.dataset import Dataset
from rtphys.data.episode import JSON
from rtphys.data.layout import MANIFEST
from rtphys.results.instance_file import instance_file, read_instances
from rtphys.results.instances import Ground, InstanceList, Slot
from rtphys.studies.evaluate.plan import BENCHMARK, EvaluatePlan

# Which package versions made a list is told, not enforced: they rarely decide what is feasible.
ENFORCED = ("dataset", "task")


class NotCertified(RtphysError):
    """There is no list, or it holds too little."""

    def __init__(self, where: Path, problem: str, task: str, protocol: str, wanted: int) -> None:
        cure = f"rtphys certify --task {task} --protocol {protocol} --feasible {wanted}"
        super().__init__(
            f"{where}: {problem}; to certify: {cure} --out FOLDER, then --instances FOLDER"
        )


class OtherGround(RtphysError):
    """A list was certified with another task file, domain, look or asset pack."""

    def __init__(self, where: Path, found: list[str]) -> None:
        super().__init__(
            f"{where}: was certified on other ground: {'; '.join(found)}. What was feasible may "
            "not be so now: certify anew, or say --accept-changes"
        )


def certified(plan: EvaluatePlan, task: str, protocol: str, ground: Ground) -> InstanceList:
    """The instances to evaluate: the list up to the last episode that is asked for.

    Raises:
        NotCertified: there is none, or too few in it; names the command that makes one.
        OtherGround: and `plan.accept_changes` is false.
        BadFile: it is damaged, or another task's or protocol's.
    """
    folder, wanted = plan.instances, plan.episodes
    if folder is not None and (folder / MANIFEST).is_file():
        where, found = folder, _of_dataset(folder, task, protocol, ground)
    else:
        where = _file(folder, task, protocol)
        if not where.is_file():
            raise NotCertified(where, "does not exist", task, protocol, wanted or 100)
        found = read_instances(where)
        if (found.protocol, found.task) != (protocol, task):  # --accept-changes must not hide it
            raise BadFile(where, f"is the list of {found.task}, {found.protocol}")
    if (held := len(found.feasible)) < (least := wanted or 1):
        problem = f"{task}, {protocol}: holds {held} feasible seeds, not {least}"
        raise NotCertified(where, problem, task, protocol, least)
    if not plan.accept_changes and (changed := _changes(found.ground, ground.to_json())):
        raise OtherGround(where, changed)
    return found.first(wanted or held)


def _file(folder: Path | None, task: str, protocol: str) -> Path:
    if folder is not None:
        return instance_file(folder, protocol, task)
    places = [
        instance_file(root / "manifests" / BENCHMARK, protocol, task) for root in library.roots()
    ]
    return next((place for place in reversed(places) if place.is_file()), places[0])


def _changes(stored: Mapping[str, JSON], now: Mapping[str, JSON]) -> list[str]:
    return differences(_enforced(stored), _enforced(now))


def _enforced(ground: Mapping[str, JSON]) -> dict[str, JSON]:
    versions = ground.get("versions")
    known = versions if isinstance(versions, Mapping) else {}
    return {**ground, "versions": {key: known.get(key) for key in ENFORCED}}


def _of_dataset(folder: Path, task: str, protocol: str, ground: Ground) -> InstanceList:
    """Every seed that was tried for a dataset; its manifest has vouched for the ground."""
    leaves = [leaf for leaf in Dataset(folder).task_datasets if leaf.task == task]
    if not leaves:
        raise BadValue("--instances", str(folder), f"the dataset has no episodes of {task}")
    own = [leaf for leaf in leaves if protocol in (leaf.protocol, leaf.config)]
    # Another protocol's seeds will do: the layout of a seed is the same under every one.
    leaf = (own or leaves)[0]
    if leaf.only is not None or leaf.overrides:
        told = "it was collected with --only or --set, which an evaluation does not know"
        raise BadValue("--instances", str(folder), told)
    slots = tuple(
        Slot(one.seed, (one.reason or "rejected") if one.verdict == "rejected" else "")
        for one in leaf.attempts
    )
    return InstanceList(task, protocol, ground.to_json(), slots)
