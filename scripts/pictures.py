"""Draw pictures of the documents into docs/images: `pictures.py NAME...`.

contact_sheet.webp: five moments of every task; physics_suite.webp: of that suite. moving.webp: four
tasks at real speed. protocols.jpg: one seed of eight tasks under each protocol. maps: figures of
docs/maps.md. first_task.png: frames, and the episode of docs/first_task.md.
"""

import os
import re
import sys
import tempfile
from collections.abc import Callable, Sequence
from itertools import count
from pathlib import Path

import rtphys.core.pinned  # noqa: F401  # isort: skip  (before numpy)
import numpy as np
from PIL import Image, ImageDraw
from relevance import draw_relevance, relevance

import results
from rtphys.analysis.identify import read_result
from rtphys.assets.contact_sheet import tile
from rtphys.assets.pack import default_pack
from rtphys.core import library
from rtphys.episode.generate import attempt, prepare, settle, start
from rtphys.episode.render import StateTrajectory, render_frames
from rtphys.report import figures
from rtphys.sim import renderer
from rtphys.sim.recorder import Recording
from rtphys.spec.episode import EpisodeSpec, Recipe
from rtphys.spec.protocol import BUILTIN
from rtphys.spec.recording import RecordingSpec
from rtphys.task.spec import load_task, task_names

IMAGES = Path(__file__).resolve().parents[1] / "docs" / "images"
COLUMNS, SHEET_SIZE, STRIP = 5, (192, 144), 16  # pictures of a task, their size, the title [px]
MAX_SEEDS = 20  # tried for the contact sheet
MOVING = ("stack_bowls_two", "handover_block", "open_laptop", "hanging_mug")
MOVING_SIZE = (208, 156)  # [px] of each of the four
EVERY = 2  # of the frames, which are 60 ms apart
SECONDS = 6.0  # all four end together, and start anew
LARGEST = 400_000  # [bytes] of the moving picture
PROTOCOL_SEEDS = {
    "click_bell": 0,
    "stack_blocks_three": 1,
    "grab_roller": 2,
    "place_mouse_pad": 4,
    "open_laptop": 5,
    "beat_block_hammer": 6,
    "handover_block": 7,
    "move_stapler_pad": 9,
}
FRAMED_SIZE = (240, 180)
FRAMED = (("043_book", 0), ("057_toycar", 0), ("074_displaystand", 0))
PROTOCOL_SIZE, HEAD = (256, 192), 22  # [px] of a picture; height of the protocols' names


def head_camera(recipe: Recipe, recording: Recording, moments: Sequence[int]) -> list[Image.Image]:
    """Pictures of some rows of an episode."""
    recording.rows = [recording.rows[i] for i in moments]
    task, states = load_task(recipe.task), StateTrajectory.of(recording)
    frames = render_frames(recipe, task, default_pack(), states, RecordingSpec(("head",)))
    return [Image.fromarray(images["head_camera"]) for images in frames.images]


def accepted(spec: EpisodeSpec, max_seeds: int | None = None) -> tuple[Recipe, Recording] | None:
    """The first seed of which the expert's episode is accepted."""
    for seed in count() if max_seeds is None else range(max_seeds):
        done = attempt(spec.at(seed), load_task(spec.task), default_pack())
        if done.accepted and done.recording:
            return spec.at(seed), done.recording
    return None


def contact_sheet(names: Sequence[str], protocol: str, file: str) -> None:
    """Evenly spaced pictures of every task's first accepted seed, a row a task."""
    rows = []
    for name in names:
        found = accepted(EpisodeSpec(name, protocol), MAX_SEEDS)
        if found is None:
            print(f"{name}: no success in {MAX_SEEDS} seeds", file=sys.stderr)
            continue
        recipe, recording = found
        moments = np.linspace(0, len(recording.rows) - 1, COLUMNS).round().astype(int)
        width, height = SHEET_SIZE
        row = Image.new("RGB", (COLUMNS * width, STRIP + height), "white")
        title = f"{name}, {recipe.protocol}, seed {recipe.seed}"
        ImageDraw.Draw(row).text((4, 2), title, fill="black")
        for column, picture in enumerate(head_camera(recipe, recording, moments.tolist())):
            small = picture.resize(SHEET_SIZE, Image.Resampling.LANCZOS)
            row.paste(small, (column * width, STRIP))
        rows.append(np.asarray(row))
    Image.fromarray(np.vstack(rows)).save(IMAGES / file, quality=65, method=6)


def moving() -> None:
    """Ends of four episodes side by side; a shorter one waits at its last picture."""
    films: list[list[Image.Image]] = []
    for name in MOVING:
        found = accepted(EpisodeSpec(name, "phys_random_all"))
        assert found is not None
        recipe, recording = found
        moments = range(len(recording.rows))[-round(SECONDS / 0.06) :: EVERY]
        pictures = head_camera(recipe, recording, moments)
        films.append([p.resize(MOVING_SIZE, Image.Resampling.LANCZOS) for p in pictures])
    frames = []
    for i in range(max(map(len, films))):
        four = [np.asarray(film[min(i, len(film) - 1)]) for film in films]
        frames.append(Image.fromarray(np.vstack([np.hstack(four[:2]), np.hstack(four[2:])])))
    out, timing = IMAGES / "moving.webp", {"duration": 60 * EVERY, "loop": 0, "method": 6}
    for quality in (60, 45, 30, 15):
        frames[0].save(out, save_all=True, append_images=frames[1:], quality=quality, **timing)
        if (size := out.stat().st_size) <= LARGEST:
            print(f"{out}: {len(frames)} pictures, {size / 1e3:.0f} kB, quality {quality}")
            return
    raise SystemExit(f"{out}: {size} bytes; show less")


def protocols() -> None:
    """Eight tasks before the first action: four to a half, a column a protocol."""
    names = [protocol.name for protocol in BUILTIN]
    head = Image.new("RGB", (PROTOCOL_SIZE[0] * len(names), HEAD), "white")
    for n, name in enumerate(names):
        ImageDraw.Draw(head).text((n * PROTOCOL_SIZE[0] + 6, 5), name, fill="black")
    rows = []
    for task, seed in PROTOCOL_SEEDS.items():
        row = []
        for name in names:
            recipe = EpisodeSpec(task, name).at(seed)
            instance = prepare(recipe, load_task(task), default_pack())
            settle(instance)
            picture = head_camera(recipe, start(instance).recorder.recording, [0])[0]
            row.append(picture.resize(PROTOCOL_SIZE, Image.Resampling.BOX))
        rows.append(np.hstack(row))
    halves = [np.vstack([np.asarray(head), *part]) for part in (rows[:4], rows[4:])]
    gap = np.full((len(halves[0]), 8, 3), 255, np.uint8)
    sheet = Image.fromarray(np.hstack([halves[0], gap, halves[1]]))
    sheet.save(IMAGES / "protocols.jpg", quality=82)


def maps() -> None:
    """Sensitivity, identifiability, and both."""
    tolerated = figures.tolerated_shares([*results.load("sensitivity_replay").values()])
    r2 = read_result(results.RESULTS / "identify_trees.json").r2()
    figures.draw_task_map(tolerated, figures.SENSITIVITY, IMAGES / "sensitivity.png")
    figures.draw_task_map(r2, figures.IDENTIFIABILITY, IMAGES / "identifiability.png")
    draw_relevance(relevance(tolerated, r2), IMAGES / "relevance.png")


def first_task() -> None:
    """Models with the axes of their own frames and points; below, moments of an episode."""
    models = [tile(default_pack(), name, model, FRAMED_SIZE[0]) for name, model in FRAMED]
    text = (IMAGES.parent / "first_task.md").read_text()
    code = re.search(r"```python\n(# my_lab/tasks/(\w+)\.py\n.*?)```", text, re.DOTALL)
    assert code is not None
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "tasks").mkdir()
        (Path(folder) / "tasks" / f"{code[2]}.py").write_text(code[1])
        os.environ["RTPHYS_LIBRARY"] = folder
        found = accepted(EpisodeSpec(code[2], "clean"), MAX_SEEDS)
        assert found is not None
        recipe, recording = found
        moments = np.linspace(0, len(recording.rows) - 1, len(FRAMED)).round().astype(int)
        pictures = head_camera(recipe, recording, moments.tolist())
    row = [np.asarray(p.resize(FRAMED_SIZE, Image.Resampling.LANCZOS)) for p in pictures]
    sheet = Image.fromarray(np.vstack([np.hstack(models), np.hstack(row)]))
    sheet.quantize(256, dither=Image.Dither.NONE).save(IMAGES / "first_task.png", optimize=True)


PICTURES: dict[str, Callable[[], None]] = {
    "contact_sheet": lambda: contact_sheet(task_names(), "phys_random", "contact_sheet.webp"),
    "physics_suite": lambda: contact_sheet(
        library.suites()["physics"], "clean", "physics_suite.webp"
    ),
    "moving": moving,
    "protocols": protocols,
    "maps": maps,
    "first_task": first_task,
}


def main(names: Sequence[str]) -> None:
    """Draw what is named."""
    renderer.configure()
    for name in names:
        PICTURES[name]()


if __name__ == "__main__":
    main(sys.argv[1:])
