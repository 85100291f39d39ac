"""Certification fingerprint of a task, as it is on this machine now."""

import hashlib
import platform
from functools import lru_cache
from importlib import metadata
from pathlib import Path

from rtphys.assets.embodiment import DEFAULT, named_pair
from rtphys.assets.identity import content_digest
from rtphys.assets.pack import Pack
from rtphys.core import library
from rtphys.core.code_digest import code_digest, imported_files
from rtphys.data.json_text import compact
from rtphys.results.instances import DomainDigest, Fingerprint
from rtphys.spec.collection import DATASET_VERSION
from rtphys.spec.episode import EpisodeSpec
from rtphys.task.spec import Task

# Whatever can change a bit of an episode. The renderer's driver is not among them: states are.
SHAPING = ("rtphys", "sapien", "numpy", "scipy", "pin", "coal", "toppra", "ruckig")
PACKAGE = Path(__file__).parents[1]


def fingerprint_of(
    task: Task, protocol: str, pack: Pack | None, embodiment: str = DEFAULT
) -> Fingerprint:
    """Fingerprint of a task under a protocol: rules, assets, robot and versions.

    `pack`: None where there is none yet; `assets` is empty then. Raises `UnknownName`: no such
    protocol.
    """
    spec = EpisodeSpec(task.name, protocol)
    domain, visual = spec.domain, spec.visual()
    return Fingerprint(
        domain=DomainDigest(name=domain.name, digest=domain.digest),
        look=hashlib.sha256(compact(visual.to_json())).hexdigest() if visual else "",
        assets=pack.digest if pack else "",
        versions={**versions(task, embodiment), "dataset": DATASET_VERSION},
        embodiment=embodiment,
    )


def versions(task: Task, embodiment: str = DEFAULT) -> dict[str, str]:
    """Everything that decides what a seed of this task looks like, besides assets and domain."""
    found = {**packages(), "task": task.digest, "code": code()}
    # Robots of a user's library, which the digest of the assets does not count.
    known = library.names("robots")
    if own := [known[name] for name in dict.fromkeys(named_pair(embodiment)[:2]) if name in known]:
        text = "+".join(map(content_digest, own))
        found["robot"] = hashlib.sha256(text.encode()).hexdigest()
    return found


@lru_cache(maxsize=1)
def packages() -> dict[str, str]:
    """Versions of the packages that can change a bit of an episode, and of Python."""
    known = {name: metadata.version(name) for name in SHAPING}
    return {**known, "python": platform.python_version(), "machine": platform.machine()}


@lru_cache(maxsize=1)
def code() -> str:
    """Digest of the code between a recipe and its states: physics, simulation, planner, expert."""
    return code_digest(shaping_files())


def shaping_files() -> frozenset[Path]:
    """The files of that code: what `generate.py` and each attribute import, directly or not."""
    # Attributes are found by looking into folders, so that nothing imports them by name.
    found = [PACKAGE / "episode" / "generate.py", *(PACKAGE / "physics/attributes").glob("*.py")]
    own = library.names("attributes").values()
    return frozenset[Path]().union(
        *(imported_files(path, PACKAGE) for path in found),
        *(imported_files(path, library.top_of("attributes", path)) for path in own),
    )
