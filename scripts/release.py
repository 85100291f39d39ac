"""Build wheel and sdist into dist/: `make release`, which also tries the wheel.

Refuses before that if the files that name the version or its date disagree.
"""

import re
import subprocess
import sys
import tomllib
import venv
from pathlib import Path

import yaml

ROOT = Path(__file__).resolve().parents[1]


def disagreements(root: Path = ROOT) -> list[str]:
    """Files that name another version than pyproject.toml, or no date, a line each."""
    version = tomllib.loads((root / "pyproject.toml").read_text())["project"]["version"]
    citation = yaml.safe_load((root / "CITATION.cff").read_text())
    title = f"## {version} ({citation['date-released']})"
    found = []
    if str(citation["version"]) != version:
        found.append(f"CITATION.cff: version {citation['version']}, not {version}")
    environment = tomllib.loads((root / "lerobot_env_rtphys" / "pyproject.toml").read_text())
    if (other := environment["project"]["version"]) != version:
        found.append(f"lerobot_env_rtphys/pyproject.toml: version {other}, not {version}")
    wheel = f"rtphys-{version}-py3-none-any.whl"
    if wheel not in (root / "docs" / "install.md").read_text():
        found.append(f"docs/install.md: does not name {wheel}")
    for name in ("CHANGELOG.md", "docs/releases.md"):
        first = re.search(r"^## .*$", (root / name).read_text(), re.MULTILINE)
        if first is None or first[0] != title:
            found.append(f"{name}: the first title is {first and first[0]!r}, not {title!r}")
    return found


def build() -> None:
    """Writes both files, by PyPA's `build` in an environment of its own."""
    home = ROOT / "build" / "release"
    venv.create(home, with_pip=True)
    python = home / "bin" / "python"
    for words in (["pip", "install", "--quiet", "build"], ["build", "--outdir", "dist", "."]):
        subprocess.run([python, "-m", *words], cwd=ROOT, check=True)


if __name__ == "__main__":
    if problems := disagreements():
        sys.exit("\n".join(problems))
    build()
