"""The documents: every link leads somewhere, every command and every example is one that exists."""

import importlib
import re
import shlex
from pathlib import Path

import pytest
import yaml

from pages import PAGES, ROOT, blocks, commands, parse, parts

GENERATED = {"tasks.md"}  # scripts/site.py writes it when the site is built


def heading_anchors(page: Path) -> set[str]:
    titles = re.findall(r"^#+ (.+)$", page.read_text(), re.MULTILINE)
    plain = (re.sub(r"[`*]|\]\([^)]*\)|\[", "", title).strip().lower() for title in titles)
    return {re.sub(r"[^\w\- ]", "", title).replace(" ", "-") for title in plain}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_links_lead_somewhere(page: Path) -> None:
    broken = []
    for target in re.findall(r"\]\(([^)\s]+)\)", page.read_text()):
        place, _, anchor = target.partition("#")
        if "://" in place or Path(place).name in GENERATED:
            continue
        path = (page.parent / place).resolve() if place else page
        there = path.exists()
        if not there or (anchor and path.suffix == ".md" and anchor not in heading_anchors(path)):
            broken.append(target)
    assert not broken


@pytest.mark.parametrize("package", ["task", "physics", "gym", "policies", "results", "episode"])
def test_the_reference_describes_every_public_name(package: str) -> None:
    pages = "".join(page.read_text() for page in (ROOT / "docs" / "reference").glob("*.md"))
    described = set(re.findall(r"^::: (\S+)", pages, re.MULTILINE))
    module = importlib.import_module(f"rtphys.{package}")
    missing = []
    for name in module.__all__:
        home = getattr(getattr(module, name), "__module__", None)
        if home and home.startswith("rtphys") and not {home, f"{home}.{name}"} & described:
            missing.append(f"{home}.{name}")
    assert not missing


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_commands_and_their_options_exist(
    page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    wrong = []
    for words in commands(page):
        try:
            parse(words)
        except Exception as error:
            wrong.append(f"{shlex.join(words)}: {error}")
    assert not wrong


def test_a_wrong_command_line_is_seen() -> None:
    for line in ("tasks --jsn", "colect --task click_bell", "domains shw click_bell"):
        with pytest.raises(Exception, match=r"(?i)no such|unknown"):
            parse(line.split())


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_examples_can_be_read(page: Path) -> None:
    for text in blocks(page, "python"):
        compile(text, str(page), "exec")
    for text in blocks(page, "yaml"):
        if "…" not in text:  # an excerpt
            list(yaml.safe_load_all(text))


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_code_has_lines_of_100_characters_at_most(page: Path) -> None:
    """As many fit on the site and in most terminals."""
    lines = [line for part in parts(page) for line in part.text.splitlines()]
    assert not [line for line in lines if len(line) > 100]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_lists_and_tables_are_blocks_for_the_site_too(page: Path) -> None:
    """GitHub is lenient. The site's Markdown wants four spaces within a list, and empty lines."""
    text = re.sub(r"(?ms)^```.*?^```$", "", page.read_text())  # no code
    wrong = re.findall(r"\n\n {1,3}\S.*", text)
    wrong += re.findall(r"\n *\|.*\n(?! *\||<!-- end)[^\n]+", text)
    wrong += re.findall(r"\n\n    .*\n(?:    .*\n)*(?:\*|-|\d+\.) .*", text)
    assert not wrong


def test_the_site_has_every_page() -> None:
    nav = (ROOT / "mkdocs.yml").read_text()
    missing = [p.name for p in (ROOT / "docs").rglob("*.md") if str(p.relative_to(ROOT)) not in nav]
    assert not missing
