"""What may lie on table and wall in one pack: its pictures, or surfaces drawn from their names."""

from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import cast

from rtphys.assets.material import Picture
from rtphys.assets.model import read_json
from rtphys.assets.surfaces import NAMES, SPLITS, Place, draw_surface
from rtphys.core.errors import UnknownName

FOLDERS = ("textures", "background_texture")  # in packs of ours, and in the official one


class Textures:
    """The textures of the pack in the folder `root`, without its fallback's."""

    def __init__(self, root: Path) -> None:
        self.root = root
        self._pictures: dict[str, dict[str, Path]] = {}  # read once per process

    def names(self, split: str, place: Place) -> tuple[str, ...]:
        """Names in a fixed order; a picture lies on tables and walls alike. Raises UnknownName."""
        if split not in SPLITS:
            raise UnknownName("texture split", split, SPLITS)
        return tuple(self._files(split)) or self._listed.get((split, place), ())

    def find(self, place: Place, split: str, name: str) -> Path | Picture:
        """The file of a picture, or a drawn surface. Raises UnknownName."""
        return self._files(split).get(name) or draw_surface(place, f"{split}/{name}")

    def _files(self, split: str) -> dict[str, Path]:
        if split not in self._pictures:
            folders = (self.root / name / split for name in FOLDERS)
            listings = (sorted(f.glob("*.png"), key=lambda p: p.name) for f in folders)
            self._pictures[split] = {p.stem: p for p in next(filter(None, listings), ())}
        return self._pictures[split]

    @cached_property
    def _listed(self) -> dict[tuple[str, str], tuple[str, ...]]:
        file = self.root / FOLDERS[0] / NAMES
        data = read_json(file) if file.is_file() else {}
        listed = {split: cast(Mapping[str, list[str]], data.get(split, {})) for split in SPLITS}
        return {(split, p): tuple(names) for split in SPLITS for p, names in listed[split].items()}
