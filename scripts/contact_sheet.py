"""One row of head-camera pictures for each task of a dataset: `contact_sheet.py DATA OUT.png`."""

import sys
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw

from rtphys.dataset import Dataset, Episode

COLUMNS, WIDTH, HEIGHT, STRIP = 6, 240, 180, 16


def row(episode: Episode) -> Image.Image:
    """Evenly spaced pictures from first to last, under the task's name and its first sentence."""
    sheet = Image.new("RGB", (COLUMNS * WIDTH, STRIP + HEIGHT), "white")
    sentence = next(iter(episode.instructions.seen), "")
    ImageDraw.Draw(sheet).text((4, 2), f"{episode.task}   {sentence}", fill="black")
    moments = np.linspace(0, len(episode) - 1, COLUMNS).round().astype(int)
    for column, frame in enumerate(moments):
        picture = Image.fromarray(episode.image("head_camera", int(frame)))
        small = picture.resize((WIDTH, HEIGHT), Image.Resampling.LANCZOS)
        sheet.paste(small, (column * WIDTH, STRIP))
    return sheet


def main(data: str, out: str) -> None:
    dataset = Dataset(data)
    rows = [row(dataset.where(task)[0]) for task in dataset.tasks]
    sheet = Image.new("RGB", (COLUMNS * WIDTH, sum(r.height for r in rows)))
    for i, strip in enumerate(rows):
        sheet.paste(strip, (0, i * strip.height))
    Path(out).parent.mkdir(parents=True, exist_ok=True)
    # 256 colours are plenty for renderings, and a third of the bytes.
    sheet.quantize(256, dither=Image.Dither.NONE).save(out, optimize=True)


if __name__ == "__main__":
    main(*sys.argv[1:3])
