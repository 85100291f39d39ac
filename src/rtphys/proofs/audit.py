"""Everything that an audit reads from a dataset."""

from collections.abc import Iterator, Mapping
from pathlib import Path

from rtphys.data.dataset import Dataset
from rtphys.data.journal import read_journal
from rtphys.physics.registry import attributes
from rtphys.proofs.audit_selection import Selection, selections


def selections_by_task_dataset(dataset: Dataset) -> dict[str, list[Selection]]:
    """Task dataset -> its selections; all task datasets of one protocol together as "all".

    Raises:
        BadFile: a task dataset's journal is missing or damaged: attempts are told nowhere else.
    """
    units = {key: attribute.unit for key, attribute in attributes().items()}
    found: dict[str, list[Selection]] = {}
    everything: list[tuple[Mapping[str, object], bool]] = []
    for name, entry in dataset.manifest.task_datasets.items():
        own = list(_attempts(entry.below(dataset.path).journal))
        found[name] = selections(own, units)
        everything += own
    if len(found) > 1:
        found["all"] = selections(everything, units)
    return found


def _attempts(journal: Path) -> Iterator[tuple[Mapping[str, object], bool]]:
    for line in read_journal(journal).lines[1:]:
        physics = line.entry.get("physics")
        # An attempt that was refused before its physics was drawn tells nothing about physics.
        if isinstance(physics, Mapping) and physics:
            yield physics, line.entry["verdict"] == "accepted"
