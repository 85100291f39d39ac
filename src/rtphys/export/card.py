"""Metadata of a dataset: README with Hugging Face's front matter, and Croissant 1.1.

Croissant lists every file of an episode with its SHA-256, and every episode with its physics.
"""

import json
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields, replace
from datetime import date
from itertools import pairwise
from math import inf
from pathlib import Path
from typing import Annotated

import numpy as np

from rtphys.core.errors import BadValue, counted
from rtphys.data.dataset import Dataset
from rtphys.data.files import facts_of, replace_file
from rtphys.data.json_text import check_spelled, plain, pretty
from rtphys.data.layout import MANIFEST
from rtphys.data.manifest import dataset_digest
from rtphys.data.state_digests import DIGITS, state_digest
from rtphys.export.lerobot_plan import physics_of
from rtphys.physics.attribute import attribute, is_attribute
from rtphys.physics.reach import split
from rtphys.spec.option import Option

CARD, CROISSANT = "README.md", "croissant.json"
SIZES = ("1K", "10K", "100K", "1M", "10M", "100M", "1B", "10B", "100B", "1T")
FORMATS = {
    "hdf5": "application/x-hdf5",
    "mp4": "video/mp4",
    "json": "application/json",
    "jsonl": "application/jsonl",
    "txt": "text/plain",
}
TYPES = {int: "sc:Integer", float: "sc:Float", str: "sc:Text"}
# The terms of Croissant that have its prefix; those that it writes otherwise follow.
TERMS = (
    *("arrayShape", "citeAs", "column", "containedIn", "dataBiases", "dataCollection"),
    *("equivalentProperty", "extract", "field", "fileObject", "fileProperty", "fileSet", "format"),
    *("includes", "isArray", "isLiveDataset", "jsonPath", "key", "md5", "parentField", "path"),
    *("personalSensitiveInformation", "recordSet", "references", "regex", "repeated", "replace"),
    *("samplingRate", "separator", "source", "subField", "transform"),
)
CONTEXT = {
    "@language": "en",
    "@vocab": "https://schema.org/",
    **{term: f"cr:{term}" for term in TERMS},
    "conformsTo": "dct:conformsTo",
    "cr": "http://mlcommons.org/croissant/",
    "data": {"@id": "cr:data", "@type": "@json"},
    "dataType": {"@id": "cr:dataType", "@type": "@vocab"},
    "dct": "http://purl.org/dc/terms/",
    "examples": {"@id": "cr:examples", "@type": "@json"},
    "rai": "http://mlcommons.org/croissant/RAI/",
    "sc": "https://schema.org/",
}


@dataclass(frozen=True)
class CardText:
    """Facts about a publication that the manifest does not hold."""

    name: Annotated[str, Option("Name of the dataset.")] = "rtphys demonstrations"
    license: Annotated[str, Option("SPDX identifier, such as CC-BY-4.0. Default: none.")] = ""
    url: Annotated[str, Option("Address where it will be published.")] = ""
    published: Annotated[str, Option("Date of publication, YYYY-MM-DD.")] = ""

    def __post_init__(self) -> None:
        """Raises `BadValue`: no such date, or a text that is not UTF-8."""
        for one in fields(self):
            check_spelled(one.name, getattr(self, one.name), "the card is UTF-8 text")
        try:
            spelled = self.published and date.fromisoformat(self.published).isoformat()
        except ValueError:
            spelled = ""
        if spelled != self.published:  # Python takes 20261121 and 2026-W47-6, too
            raise BadValue("published", self.published, "allowed: YYYY-MM-DD")


def write_card(dataset: Dataset, text: CardText) -> list[Path]:
    """Write README.md and croissant.json beside the manifest and return their paths.

    Raises `CannotWrite`; `BadFile`: an episode's label cannot be read.
    """
    metadata = pretty(plain(croissant(dataset, text)), sort=False)
    contents = {CARD: card(dataset, text).encode(), CROISSANT: metadata}
    for name, data in contents.items():
        replace_file(dataset.path / name, data)
    return [dataset.path / name for name in contents]


def card(dataset: Dataset, text: CardText) -> str:
    """Text of the README."""
    entries = dataset.task_datasets
    frames = sum(entry.frames for entry in entries)
    front = [
        "---",
        # Hugging Face spells SPDX's identifiers in small letters.
        *([f"license: {json.dumps(text.license.lower())}"] if text.license else []),
        *("language:", "- en", f"pretty_name: {json.dumps(text.name, ensure_ascii=False)}"),
        *("task_categories:", "- robotics", "tags:"),
        *(f"- {tag}" for tag in ("robotics", "manipulation", "bimanual", "RoboTwin", "physics")),
        *("size_categories:", f"- {_size(frames)}", "---"),
    ]
    reasons: Counter[str] = Counter()
    versions: dict[str, set[str]] = {}
    for entry in entries:
        reasons.update(entry.rejections)
        for name, version in entry.resolved.versions.items():
            versions.setdefault(name, set()).add(version)
    counts = ", ".join(f"{reason} {count}" for reason, count in reasons.most_common())
    made = ", ".join(f"{name} {' / '.join(sorted(v))}" for name, v in sorted(versions.items()))
    digest = dataset_digest((dataset.path / MANIFEST).read_bytes())
    ranges = _ranges(dataset)
    layouts = [LAYOUTS[one] for one in dict.fromkeys(e.spec.recording.layout for e in entries)]
    parts = [
        "\n".join(front),
        f"# {text.name}",
        f"{counted(len(dataset), 'bimanual demonstrations')} ({frames} frames at 16.67 Hz) of "
        f"{counted(len(dataset.tasks), 'simulated tasks')}. Each episode "
        f"stores the {_count(ranges)} as they were in force in the contact solver.",
        "## Episodes",
        _task_table(dataset),
        f"Attempts without an episode, by reason: {counts}." if counts else "",
        "## Physics",
        _physics_table(ranges),
        "## Files",
        "\n".join([FILES, *(FILES_OF.format(**layout) for layout in layouts)]),
        "\n".join([*(PICTURES.format(**layout) for layout in layouts), POSES]),
        "## Use",
        USE,
        "## Provenance",
        f"Made in simulation by {_who(dataset)}: {made}. "
        f"Dataset format {dataset.manifest.dataset_version}.",
        f"Digest of this dataset: `{digest}`, which `rtphys verify` prints for every copy of it. "
        "`croissant.json` has a state digest of each episode, "
        "of its seed, states, actions and label: the same on every machine that collects it again, "
        "whatever draws the pictures.",
    ]
    return "\n\n".join(part for part in parts if part) + "\n"


FILES = """\
| path | content |
|---|---|
| `manifest.json` | attempts, rejections by reason, domains, the checksum of every ledger |"""

FILES_OF = """\
| `{folder}/ledger.jsonl` | every attempt, and SHA-256 of every file |
| `…/data/` | trajectories, {format} |
| `…/video/` | the head camera as MP4 |
| `…/phys_meta/` | the physics of each episode as read back from the simulator |
| `…/{words}/` | sentences, seen and unseen |"""

LAYOUTS = {
    "native": {
        "folder": "<config>/<task>/<embodiment>",
        "format": "RoboTwin's XPolicyLab v1.0 HDF5",
        "words": "instruction",
        "colours": "are standard RGB, marked by a comment `XPL-RGB1` as XPolicyLab's are",
    },
    "legacy": {
        "folder": "<task>/<config>",
        "format": "the older HDF5 of RoboTwin",
        "words": "instructions",
        "colours": "have red and blue exchanged, as RoboTwin's readers expect",
    },
}

PICTURES = "JPEG streams below `{folder}` {colours}."
POSES = "Poses are x y z [m] and qw qx qy qz in the world frame."

USE = """\
```python
import rtphys

for episode in rtphys.Dataset("path/to/this/folder"):
    print(episode.task, episode.seed, episode.physics["friction"])
    pictures = episode.images("head_camera")   # (T, H, W, 3), RGB
    actions = episode.action                   # (T - 1, N), commanded joint targets, openings
```

`rtphys verify path/to/this/folder` checks every file, and derives the sampled physics of
every episode from its seed again."""


def _size(number: int) -> str:
    """Hugging Face's category."""
    for digits, (low, high) in enumerate(pairwise(("", *SIZES)), start=3):
        if number < 10**digits:
            return f"{low}<n<{high}" if low else f"n<{high}"
    return f"n>{SIZES[-1]}"


def _who(dataset: Dataset) -> str:
    """Who acts in the episodes."""
    names = dict.fromkeys(entry.spec.policy for entry in dataset.task_datasets)
    return " and ".join(f"the policy `{one}`" if one else "a scripted expert" for one in names)


def _task_table(dataset: Dataset) -> str:
    rows = [
        "| task | configuration | robot | episodes | attempts | accepted |",
        "|---|---|---|---:|---:|---:|",
    ]
    for entry in dataset.task_datasets:
        tried, of = entry.attempts, entry.spec.episode
        share = f"{entry.episodes / tried:.0%}" if tried else "–"
        names = f"{of.task} | {entry.spec.name} | {of.embodiment}"
        rows.append(f"| {names} | {entry.episodes} | {tried} | {share} |")
    return "\n".join(rows)


@dataclass
class _Range:
    """Of an attribute in the episodes in which it could act."""

    varied: int = 0  # episodes
    low: float = inf
    high: float = -inf


def _ranges(dataset: Dataset) -> dict[str, _Range]:
    """Of every attribute that an episode has, those of single props too."""
    found: dict[str, _Range] = {}
    for episode in map(replace, dataset):  # copies, to forget what is read of them
        for key, label in episode.meta.attributes.items():
            if not is_attribute(key):
                continue
            of = found.setdefault(key, _Range())
            if label.could_act:
                of.varied += label.varied
                numbers = [] if label.value is None else np.ravel(label.value).tolist()
                of.low, of.high = min([of.low, *numbers]), max([of.high, *numbers])
    return dict(sorted(found.items()))


def _count(keys: Iterable[str]) -> str:
    return counted(len({split(key)[0] for key in keys}), "physical attributes")


def _physics_table(ranges: Mapping[str, _Range]) -> str:
    rows = ["| attribute | unit | varied in | smallest | largest |", "|---|---|---:|---:|---:|"]
    for key, of in ranges.items():
        low, high = (f"{of.low:.4g}", f"{of.high:.4g}") if of.low <= of.high else ("", "")
        rows.append(f"| `{key}` | {attribute(key).unit} | {of.varied} | {low} | {high} |")
    return "\n".join(rows)


# ---- Croissant -----------------------------------------------------------------------------------


def croissant(dataset: Dataset, text: CardText) -> dict[str, object]:
    """JSON-LD document of a dataset. Raises `BadFile`: an episode's label cannot be read."""
    return {
        "@context": CONTEXT,
        "@type": "sc:Dataset",
        "conformsTo": "http://mlcommons.org/croissant/1.1",
        "name": text.name,
        "description": f"{counted(len(dataset), 'simulated bimanual manipulation episodes')} "
        f"with {_count(_ranges(dataset))} each, as they were in force in the contact solver.",
        **({"license": f"https://spdx.org/licenses/{text.license}"} if text.license else {}),
        "url": text.url or "https://example.org/not-published-yet",
        "version": "1.0.0",
        **({"datePublished": text.published} if text.published else {}),
        "citeAs": text.name,
        "distribution": _files(dataset),
        "recordSet": [_episodes(dataset)],
    }


def _files(dataset: Dataset) -> list[dict[str, object]]:
    listed = {path: facts.sha256 for path, facts in dataset.files()}
    listed[MANIFEST] = facts_of(dataset.path / MANIFEST).sha256
    return [
        {
            "@type": "cr:FileObject",
            "@id": path,
            "name": path,
            "contentUrl": path,
            "encodingFormat": FORMATS.get(path.rpartition(".")[2], "application/octet-stream"),
            "sha256": digest,
        }
        for path, digest in sorted(listed.items())
    ]


def _episodes(dataset: Dataset) -> dict[str, object]:
    """Record set with one inline record per episode, to search a dataset by."""
    records: list[dict[str, int | float | str | None]] = [
        {
            "task": episode.task,
            "protocol": episode.protocol,
            "config": episode.config,
            "embodiment": episode.embodiment,
            "number": episode.number,
            "seed": episode.seed,
            "state_digest": state_digest(episode)[:DIGITS],
            "trajectory": episode.paths.hdf5.relative_to(dataset.path).as_posix(),
            **physics_of(episode, acting=True),
        }
        for episode in map(replace, dataset)  # copies, to forget what is read of them
    ]
    types = {
        key: next((TYPES[type(r[key])] for r in records if r.get(key) is not None), "sc:Float")
        for key in dict.fromkeys(key for record in records for key in record)
    }
    return {
        "@type": "cr:RecordSet",
        "@id": "episodes",
        "name": "episodes",
        "description": "One record per episode: seed, files, physics; null where it could not act.",
        "field": [
            {"@type": "cr:Field", "@id": f"episodes/{key}", "name": key, "dataType": kind}
            for key, kind in types.items()
        ],
        # Every field in each, which readers insist on: an attribute of a prop is one task's alone.
        "data": [{f"episodes/{key}": record.get(key) for key in types} for record in records],
    }
