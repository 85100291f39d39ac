"""`make release` refuses what does not name one version."""

import importlib.util
import re
import shutil
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).parents[1]
NAMES = ("pyproject.toml", "lerobot_env_rtphys/pyproject.toml", "CITATION.cff", "docs/install.md")
TITLED = ("CHANGELOG.md", "docs/releases.md")

pytestmark = pytest.mark.skipif(not (ROOT / "CITATION.cff").exists(), reason="not a checkout")


@pytest.fixture
def released(tmp_path: Path) -> Path:
    """The files that name a version, as if it were released."""
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text())
    title = f"# Title\n\n## {citation['version']} ({citation['date-released']})\n"
    for name in (*NAMES, *TITLED):
        (tmp_path / name).parent.mkdir(exist_ok=True, parents=True)
        shutil.copy(ROOT / name, tmp_path / name)
    for name in TITLED:
        (tmp_path / name).write_text(title)
    return tmp_path


def disagreements(root: Path) -> list[str]:
    spec = importlib.util.spec_from_file_location("release", ROOT / "scripts" / "release.py")
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.disagreements(root)


def test_files_that_agree_pass(released: Path) -> None:
    assert disagreements(released) == []


@pytest.mark.parametrize("name", [*NAMES[1:], *TITLED])
def test_each_file_that_names_another_version_is_refused(released: Path, name: str) -> None:
    path = released / name
    path.write_text(re.sub(r"\d+\.\d+\.\d+", "9.9.9", path.read_text()))
    assert [line for line in disagreements(released) if line.startswith(name)]
