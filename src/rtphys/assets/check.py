"""Checks an asset pack by loading everything in it."""

from dataclasses import dataclass, field

from rtphys.assets.pack import Pack
from rtphys.assets.pair_urdf import check_meshes, parsed_urdf
from rtphys.assets.surfaces import KINDS, SPLITS
from rtphys.core.errors import RtphysError


@dataclass(frozen=True)
class Report:
    """Which models of a pack load, and which do not."""

    loaded: dict[str, int] = field(default_factory=dict)  # id_name or robot -> models that load
    problems: tuple[str, ...] = ()  # one sentence each, naming the file
    textures: dict[str, int] = field(default_factory=dict)  # split -> pictures


def check_pack(pack: Pack) -> Report:
    """Load every object and robot of a pack and of its fallback, and count the textures."""
    loaded: dict[str, int] = {}
    problems: list[str] = []
    for name in pack.names:
        for index in _indices(pack, name, problems):
            try:
                _load(pack, name, index)
                loaded[name] = loaded.get(name, 0) + 1
            except RtphysError as problem:
                problems.append(str(problem))
    for name in pack.embodiments:
        try:
            pack.embodiment(name)
            loaded[name] = 1
        except RtphysError as problem:
            problems.append(str(problem))
    return Report(loaded, tuple(problems), _textures(pack))


def _load(pack: Pack, name: str, index: int) -> None:
    if pack.is_articulated(name):
        urdf = pack.articulation(name, index).urdf
        check_meshes(urdf, parsed_urdf(urdf))
    else:
        pack.model(name, index)


def _indices(pack: Pack, name: str, problems: list[str]) -> tuple[int, ...]:
    try:
        return pack.indices(name)
    except RtphysError as problem:
        problems.append(str(problem))
        return ()


def _textures(pack: Pack) -> dict[str, int]:
    counts = {}
    for split in SPLITS:
        try:
            counts[split] = sum(len(pack.textures(split, place)) for place in KINDS)
        except RtphysError:
            counts[split] = 0
    return counts
