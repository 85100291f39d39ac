"""The versions of packages with which lists are certified, and how this environment differs."""

from collections.abc import Iterable
from importlib import metadata
from pathlib import Path

from rtphys.core import library

FILE = "constraints.txt"  # in the bundled library's manifests/


def constraints() -> Path:
    """The file that pip takes with `-c`."""
    return library.bundled() / "manifests" / FILE


def certified_versions() -> dict[str, str]:
    """Package -> version, as the constraints file has it."""
    lines = constraints().read_text().splitlines()
    pairs = (line.partition("#")[0].strip().partition("==") for line in lines)
    return {name: version for name, equals, version in pairs if equals}


def other_versions(packages: Iterable[str] | None = None) -> list[str]:
    """One clause for each installed package of another version: `numpy 2.2.6, not 2.4.6`.

    Args:
        packages: only these; by default all of the constraints file.
    """
    wanted = certified_versions()
    clauses: list[str] = []
    for name in wanted if packages is None else packages:
        try:
            have = metadata.version(name)
        except metadata.PackageNotFoundError:
            continue  # what is missing is another check's finding
        if name in wanted and have != wanted[name]:
            clauses.append(f"{name} {have}, not {wanted[name]}")
    return clauses
