"""Compares an episode that was made again with the stored one, and says what differs."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from rtphys.core.bounds import LARGEST_EPISODE
from rtphys.core.errors import BadFile, counted, short_repr
from rtphys.core.untrusted import JSON, parse_mapping
from rtphys.data import files, jpeg, staging, video
from rtphys.data.episode import Frames
from rtphys.data.hdf5_episode import episode_bytes, read_episode, read_frames, read_pictures
from rtphys.data.hdf5_file import open_read, text, texts
from rtphys.data.json_text import plain
from rtphys.data.layout import EpisodePaths

MAX_NAMED = 5  # differences that one sentence names
# Another renderer draws the edges of things elsewhere by a fraction of a pixel, another encoder
# rounds otherwise. What the same scene may differ by, of pixels between 0 and 255:
FAR = 32  # levels from which a pixel counts as another one
OTHER_PIXELS = 0.01  # share of such pixels in one picture; between SAPIEN's shaders: 0.0005

PICTURES, VIDEO, CONTAINER = "pictures", "video", "HDF5 file"


@dataclass(frozen=True, eq=False)
class RegeneratedEpisode:
    """An episode that was made again."""

    frames: Frames
    label: Mapping[str, JSON]
    scene_info: Mapping[str, JSON]
    instructions: Mapping[str, JSON]
    folder: Path | None  # where `staging.stage_episode` wrote it; None: nothing was drawn


@dataclass
class Comparison:
    """What came of comparing.

    Another renderer or encoder explains what is `alike`. Where something of the same kind was
    `exact`, it was the same one, so what is only alike is a problem.
    """

    problems: list[tuple[Path, str]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    alike: list[tuple[str, Path, str]] = field(default_factory=list)  # kind, file, sentence
    exact: set[str] = field(default_factory=set)  # kinds of which something was equal to the bit
    made: bool = True  # False: nothing could be made again


def compare_episode(paths: EpisodePaths, layout: str, made: RegeneratedEpisode) -> Comparison:
    """Compares all four files. Files that cannot be read are problems, not errors."""
    found = Comparison()
    for path, check in (
        (paths.hdf5, lambda: _hdf5(paths.hdf5, layout, made, found)),
        (paths.video, lambda: _video(paths.video, made, found)),
        (paths.phys_meta, lambda: _json(paths.phys_meta, made.label, made, found)),
        (paths.instruction, lambda: _json(paths.instruction, made.instructions, made, found)),
    ):
        try:
            check()
        except BadFile as error:
            found.problems.append((path, error.problem))
        except (video.BadVideo, jpeg.BadImage) as error:
            found.problems.append((path, str(error)))
    return found


def _hdf5(path: Path, layout: str, made: RegeneratedEpisode, found: Comparison) -> None:
    new = None if made.folder is None else made.folder / staging.HDF5
    if new is not None and _same_bytes(path, new):
        found.exact |= {PICTURES, CONTAINER}
        return
    with open_read(path) as file:
        stored = read_frames(file, layout)
        if new is None:
            stored = replace(stored, cameras={})
        problems = _frame_differences(stored, made.frames)
        shared = sorted(stored.cameras.keys() & made.frames.cameras.keys())
        pictures = {name: read_pictures(file, layout, name).streams for name in shared}
    found.problems += [(path, problem) for problem in problems]
    if new is None:
        return
    equal = not problems
    with open_read(new) as file:
        for name, old in pictures.items():
            again = read_pictures(file, layout, name).streams
            if len(old) != len(again):
                problem = f"has {counted(len(old), 'pictures')} of {name}, made again {len(again)}"
                found.problems.append((path, problem))
                equal = False
                continue
            other = [index for index in range(len(again)) if old[index] != again[index]]
            if len(other) < len(again):
                found.exact.add(PICTURES)
            decoded = ((jpeg.decode(old[index]), jpeg.decode(again[index])) for index in other)
            _judge((PICTURES, path, f"of {name}"), other, decoded, found)
            equal &= not other
    if not equal:
        return
    frames, images, sensed = read_episode(path, layout)
    with open_read(path) as file:
        sentences = texts(text(file, "instructions"), file) if layout == "native" else ()
    if episode_bytes(layout, frames, images, sentences, sensed) == files.read(new, LARGEST_EPISODE):
        clause = "has all that is read of it in other bytes, as another HDF5 library writes it"
        found.alike.append((CONTAINER, path, clause))
    else:
        found.problems.append((path, "holds other sentences, notes or senses than made again"))


def _same_bytes(one: Path, other: Path) -> bool:
    """Of files of any size that is read. Raises `BadFile`."""
    return files.read(one, LARGEST_EPISODE) == files.read(other, LARGEST_EPISODE)


def _frame_differences(stored: Frames, made: Frames) -> list[str]:
    if len(stored) != len(made):
        return [f"has {counted(len(stored), 'frames')}, made again {len(made)}"]
    problems, clauses = list[str](), list[str]()
    for key in ("joint_names", "stages", "object_poses", "contacts", "cameras"):
        both = (getattr(frames, key) for frames in (stored, made))
        old, new = (sorted(one) if isinstance(one, Mapping) else list(one) for one in both)
        if old != new:
            problems.append(f"{key} are {short_repr(old)}, made again {short_repr(new)}")
    arrays = stored.shapes()
    for key, (new, _) in made.shapes().items():
        old = arrays[key][0] if key in arrays else new
        if old.shape != new.shape:
            clauses.append(f"{key} has shape {old.shape}, not {new.shape}")
        elif not np.array_equal(old, new):
            gaps = np.abs(np.asarray(old, np.float64) - np.asarray(new, np.float64))
            first = int(np.flatnonzero(gaps.reshape(len(gaps), -1).max(axis=1))[0])
            clauses.append(f"{key} from frame {first} by up to {gaps.max():.3g}")
    if clauses:
        more = f" and {len(clauses) - MAX_NAMED} more" if len(clauses) > MAX_NAMED else ""
        problems.append(f"not as made again: {'; '.join(clauses[:MAX_NAMED])}{more}")
    return problems


def _video(path: Path, made: RegeneratedEpisode, found: Comparison) -> None:
    if made.folder is None:
        return
    old, new = files.read(path), files.read(made.folder / staging.VIDEO)
    if old == new:
        found.exact.add(VIDEO)
        return
    counts = video.frame_count(old), video.frame_count(new)
    if counts[0] != counts[1]:
        found.problems.append((path, f"has {counts[0]} frames, made again {counts[1]}"))
        return
    decoded = zip(video.decode(old), video.decode(new), strict=False)
    _judge((VIDEO, path, "of the video"), range(counts[0]), decoded, found)


def _judge(
    what: tuple[str, Path, str],
    numbers: Sequence[int],
    pairs: Iterator[tuple[NDArray[np.uint8], NDArray[np.uint8]]],
    found: Comparison,
) -> None:
    """Pixel for pixel. `numbers`: of the pictures whose bytes differ."""
    if not numbers:
        return
    kind, path, whose = what
    shares, highest = list[float](), 0  # of pixels that are `FAR` away; the largest difference
    for old, new in pairs:
        share, level = 1.0, 255
        if old.shape == new.shape:
            levels = np.abs(old.astype(np.int16) - new.astype(np.int16)).max(axis=-1)
            share, level = float((levels > FAR).mean()), int(levels.max())
        shares.append(share)
        highest = max(highest, level)
    worst = int(np.argmax(shares))
    text = (
        f"{len(numbers)} pictures {whose} are not those made again: number {numbers[worst]} "
        f"by more than {FAR} levels in {shares[worst]:.2%} of its pixels, by {highest} at most"
    )
    if shares[worst] > OTHER_PIXELS:
        found.problems.append((path, text))
    else:
        found.alike.append((kind, path, text))


def _json(
    path: Path, value: Mapping[str, JSON], made: RegeneratedEpisode, found: Comparison
) -> None:
    stored, new = parse_mapping(files.read(path), path), plain(value)
    assert isinstance(new, dict)
    if made.folder is None and "cameras" in new:
        stored["cameras"] = new["cameras"]
    found.problems += [(path, text) for text in json_differences(stored, new)]


def json_differences(stored: JSON, made: JSON, place: str = "") -> list[str]:
    """One sentence for each value that is not the same, keys joined by dots; few are named."""

    def compared(stored: JSON, made: JSON, place: str) -> Iterator[str]:
        if isinstance(stored, dict) and isinstance(made, dict):
            for key in sorted({*stored, *made}, key=lambda key: (key != "state_hash", key)):
                inside = f"{place}.{key}" if place else key
                if key not in stored or key not in made:
                    yield f"{inside} is {'missing' if key in made else 'not there when made again'}"
                else:
                    yield from compared(stored[key], made[key], inside)
        elif stored != made or type(stored) is not type(made):
            yield f"{place or 'it'} is {short_repr(stored)}, made again {short_repr(made)}"

    named = [*compared(stored, made, place)]
    more = [f"and {len(named) - MAX_NAMED} values more"] if len(named) > MAX_NAMED else []
    return named[:MAX_NAMED] + more
