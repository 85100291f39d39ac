"""`manifests/*.yaml`: what to collect, written down."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from rtphys.core import library
from rtphys.core.errors import BadFile, BadValue, UnknownName
from rtphys.data import schema
from rtphys.data.schema_collect import Collection, CollectionRun
from rtphys.data.schema_model import Model
from rtphys.physics.auxiliary import AUXILIARY
from rtphys.physics.load import load_domain
from rtphys.physics.registry import attributes
from rtphys.physics.values import plain_value
from rtphys.studies.collect.plan import CollectPlan
from rtphys.studies.collect.sweep import swept


def find_collection(text: str) -> Path:
    """A file, or the name of one in a library.

    Raises:
        UnknownName: neither.
    """
    path = Path(text)
    return path if path.is_file() else library.find("manifests", text)


def read_collection(path: Path) -> Collection:
    """Raises `BadFile` or `UnknownName`, which name the file, the key and the nearest match."""
    content = library.read_yaml(path)
    _check_keys(content, Collection, "key", path)
    runs = content.get("collect")
    for number, run in enumerate(runs if isinstance(runs, list) else []):
        if isinstance(run, Mapping):
            _check_keys(run, CollectionRun, f"key of collect.{number}", path)
    try:
        found = schema.check("collection", content)
    except schema.SchemaError as error:
        raise BadFile(path, "; ".join(error.problems)) from error
    assert isinstance(found, Collection)
    return found


def _check_keys(content: Mapping, model: type[Model], kind: str, path: Path) -> None:
    for key in content:
        if key not in model.model_fields:
            raise UnknownName(kind, str(key), model.model_fields, path)


def plans_of(path: Path, how: CollectPlan) -> tuple[CollectPlan, ...]:
    """One plan a run of the manifest, several if it is swept.

    Args:
        how: where and with what; its tasks and all that a manifest says are replaced.

    Raises:
        BadFile, UnknownName, BadValue: from the file; a leaf that two runs collect.
    """
    found: list[CollectPlan] = []
    for number, run in enumerate(read_collection(path).collect):
        place = f"{path}: collect.{number}"
        plan = replace(
            how,
            tasks=library.matching("tasks", run.tasks, place),
            episodes=run.episodes,
            protocol=run.protocol,
            first_seed=run.first_seed,
            only=None if run.only is None else tuple(run.only),
            ranges=load_domain(run.domain) if run.domain else None,
            recovery=run.recovery,
            overrides=_held(run, place),
            twin=run.twin,
            cameras=tuple(run.cameras),
            layout=run.layout,
            split=run.split,
            most_attempts=run.max_attempts,
        )
        found += swept(plan, run.sweep) if run.sweep else (plan,)
    leaves = [plan.leaf_name(task) for plan in found for task in plan.tasks]
    if twice := next((leaf for leaf in leaves if leaves.count(leaf) > 1), None):
        raise BadFile(path, f"{twice} is collected by two runs")
    return tuple(found)


def _held(run: CollectionRun, place: str) -> dict:
    known = [*attributes(), *AUXILIARY]
    for key in run.set:
        if key not in known:
            raise UnknownName("attribute", key, known, place)
    try:
        return {key: plain_value(value) for key, value in run.set.items()}
    except ValueError as error:
        raise BadValue("set", run.set, str(error), place) from error
