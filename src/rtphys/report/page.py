"""One self-contained HTML page about a dataset: its data as JSON, pictures and videos."""

import base64
import json
import os
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from importlib.resources import files
from pathlib import Path
from typing import Any
from urllib.parse import quote

from rtphys.core.errors import BadFile
from rtphys.core.untrusted import JSON
from rtphys.data import jpeg
from rtphys.data.attempts import Accepted
from rtphys.data.dataset import Dataset, Episode, columns, flattened
from rtphys.data.files import make_folder, open_binary, read, replace_file
from rtphys.data.video import VIDEO_CAMERA
from rtphys.physics.attribute import attribute, attributes, is_attribute
from rtphys.physics.distribution import extremes
from rtphys.physics.reach import split
from rtphys.spec.rules import Rules

THUMBNAIL = 200  # [px]
AROUND = (-8, 0, 8)  # frames about the instant at which a failure went wrong, about half a second
EMBEDDED = 64_000_000  # bytes inside the page, of videos and of pictures; further videos are linked


def write_report(
    dataset: Dataset, out: Path, progress: Callable[[int, int], None] | None = None
) -> Path:
    """Writes the report page; what does not fit into it is linked by relative path.

    `progress` is called with (steps done, total steps). Raises `BadFile`: an episode is damaged;
    `CannotWrite`: the page cannot be written.
    """
    total = 2 * len(dataset)
    facts = gather(dataset, lambda done: progress(done, total) if progress else None)
    embedded, drawn, rows = 0, 0, facts["episodes"] + facts["failures"]
    episodes = map(replace, (*dataset, *dataset.failures()))  # copies, to forget what is read
    for number, (row, episode) in enumerate(zip(rows, episodes, strict=True), start=1):
        open_binary(video := episode.paths.video).close()  # an ordinary file, no link
        embedded += video.stat().st_size
        if embedded <= EMBEDDED:
            row["video"] = _inline("video/mp4", read(video))
        else:
            row["video"] = quote(Path(os.path.relpath(video, out.parent)).as_posix())
        failure, frames = episode.failure, [row["frames"] // 2]
        if failure is not None:
            frames = [failure.frame + step for step in AROUND]
        pictures = [_thumbnail(episode, frame) for frame in frames] if drawn <= EMBEDDED else []
        drawn += sum(map(len, pictures))
        if failure is not None:
            row["around"] = pictures
            continue
        row["thumb"] = "".join(pictures)
        if progress:
            progress(len(dataset) + number, total)
    # "</script>" inside a JSON string would end the script early.
    data = json.dumps(facts, allow_nan=False).replace("<", "\\u003c")
    page = (files("rtphys.report") / "page.html").read_text(encoding="utf-8")
    make_folder(out.parent)
    replace_file(out, page.replace("/*DATA*/", data).encode())
    return out


def _thumbnail(episode: Episode, frame: int) -> str:
    camera = VIDEO_CAMERA if VIDEO_CAMERA in episode.cameras else episode.cameras[0]
    picture = episode.image(camera, min(max(frame, 0), len(episode) - 1))
    return _inline("image/jpeg", jpeg.thumbnail(picture, THUMBNAIL))


def _inline(kind: str, data: bytes) -> str:
    return f"data:{kind};base64,{base64.b64encode(data).decode()}"


def axes(keys: Iterable[str] = ()) -> dict[str, str]:
    """Column -> key of what has a histogram: each attribute, here or of one prop."""
    every = sorted({*attributes(), *filter(is_attribute, keys)})
    return {column: key for key in every for column in columns(key)}


def gather(dataset: Dataset, progress: Callable[[int], None] | None = None) -> dict[str, Any]:
    """What the page's script reads: every label and trajectory of a dataset, but no picture.

    Raises `BadFile`: an episode is damaged.
    """
    entries = dataset.task_datasets
    rules = [entry.header.rules for entry in entries]
    shown = axes(key for one in rules for key in (*one.domain.keys, *one.held))
    several = len(dataset.embodiments) > 1
    parts: list[JSON] = []
    attempts: list[JSON] = []  # task dataset, accepted, one value per axis
    for index, entry in enumerate(entries):
        parts.append(
            {
                "task": entry.spec.episode.task,
                "protocol": entry.spec.name,
                "robot": entry.spec.episode.embodiment if several else "",
                "episodes": entry.episodes,
                "attempts": entry.attempts,
                "rejections": dict(entry.rejections),
                "spans": [_span(entry.header.rules, key) for key in shown.values()],
            }
        )
        for row in entry.rows(dataset.path):
            accepted, known = int(isinstance(row, Accepted)), flattened(row.physics)
            attempts.append([index, accepted, *map(known.get, shown)])
    at = {entry.below(dataset.path).folder: n for n, entry in enumerate(entries)}
    episodes: list[JSON] = []
    for done, episode in enumerate(map(replace, dataset), start=1):  # as above
        episodes.append(_episode(episode, at[episode.paths.hdf5.parents[1]], shown))
        if progress:
            progress(done)
    failures = [
        _failure(one, at[one.paths.hdf5.parents[2]], shown)
        for one in map(replace, dataset.failures())
    ]
    return {
        "title": dataset.path.resolve().name,
        "axes": [
            {"title": re.sub("[_.]", " ", column), "unit": attribute(key).unit}
            for column, key in shown.items()
        ],
        "parts": parts,
        "attempts": attempts,
        "episodes": episodes,
        "failures": failures,
    }


def _span(rules: Rules, key: str) -> JSON:
    """Lowest and highest value that could have been drawn; None where nothing is drawn."""
    rule = rules.domain.rule(key)
    drawn = key not in rules.held and (rules.only is None or {key, split(key)[0]} & {*rules.only})
    ends = [end for end in extremes(rule) if isinstance(end, float)] if rule and drawn else []
    return [min(ends), max(ends)] if ends else None


def _failure(episode: Episode, part: int, shown: Mapping[str, str]) -> dict[str, JSON]:
    """As of an episode, and what went wrong, when, and in which of the expert's stages."""
    failure, frames = episode.failure, episode.frames
    if failure is None or not 0 <= failure.frame < len(frames):
        raise BadFile(episode.paths.phys_meta, "tells no frame at which it went wrong")
    return _episode(episode, part, shown) | {
        "reason": failure.reason,
        "detail": failure.detail,
        "event": failure.event,
        "object": failure.object,
        "side": failure.side,
        "frame": failure.frame,
        "when": round(float(frames.time[failure.frame] - frames.time[0]), 3),
        "stage": frames.stages[int(frames.stage[failure.frame])] if frames.stages else "",
    }


def _episode(episode: Episode, part: int, shown: Mapping[str, str]) -> dict[str, JSON]:
    frames, meta = episode.frames, episode.meta
    acting = {key: label for key, label in meta.attributes.items() if label.could_act}
    known, keys = flattened({key: one.value for key, one in acting.items()}), shown.values()
    if len(frames) < 2:
        raise BadFile(episode.paths.hdf5, "holds fewer than two frames")
    return {
        "part": part,
        "number": episode.number,
        "seed": episode.seed,
        "frames": len(frames),
        "seconds": round(float(frames.time[-1] - frames.time[0]), 3),
        "says": episode.instructions.seen[0] if episode.instructions.seen else "",
        "success": meta.verdict.first_success_time,
        "force": meta.verdict.strain.force,
        "torque": meta.verdict.strain.torque,
        "values": [known.get(column) for column in shown],
        "could_act": [key in acting for key in keys],
        "acted": [acting[key].acted if key in acting else False for key in keys],
        "varied": [key in acting and acting[key].varied for key in keys],
    }
