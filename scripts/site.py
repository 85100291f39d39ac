"""Stage the pages of the documentation site: `site.py OUT [--no-pictures]`.

Every document keeps its place, so that links between them hold. One page is made here: every task
with its rates, and a picture of its first certified seed, which is drawn now and never committed.
"""

import re
import shutil
import sys
from pathlib import Path

from PIL import Image

from rtphys.assets.pack import Pack, default_pack
from rtphys.core import library
from rtphys.episode import begin
from rtphys.setting.setting import Setting
from rtphys.sim import renderer
from rtphys.task.rates import rates
from rtphys.task.spec import Task, load_task, task_names

ROOT = Path(__file__).resolve().parents[1]
PAGES = ("README.md", "CONTRIBUTING.md", "CHANGELOG.md")
PROTOCOL = "phys_random"


def stage(out: Path) -> None:
    """Copy all documents; links to what the site does not hold become names of files."""
    shutil.rmtree(out, ignore_errors=True)
    shutil.copytree(ROOT / "docs", out / "docs")
    for name in PAGES:
        shutil.copy(ROOT / name, out / name)
    for page in out.rglob("*.md"):
        page.write_text(_linked(page.read_text(), page.parent, out))


def _linked(text: str, folder: Path, out: Path) -> str:
    def replaced(link: re.Match[str]) -> str:
        words, target = link[1], link[2].partition("#")[0]
        if not target or "://" in target:
            return link[0]
        path = (folder / target).resolve()
        held = path.is_file() or path == out / "docs" / "tasks.md"
        return link[0] if held else f"{words} (`{path.relative_to(out)}`)"

    return re.sub(r"(?<!!)\[([^\]]+)\]\(([^)\s]+)\)", replaced, text)


def tasks_page(out: Path, pictures: bool) -> None:
    """Write docs/tasks.md: what each task is, when it counts as solved, and how often it is."""
    names, measured, domains = task_names(), rates(), library.names("domains")
    lines = [
        "# Every task",
        "",
        f"The {len(names)} tasks, with the share of tried seeds that the expert solves under each "
        "protocol, and the start of one episode as the head camera sees it.",
    ]
    pack = default_pack()
    for name in names:
        task = load_task(name)
        own = f"`{name}`" if name in domains else "`global`"
        shares = [f"{protocol} {rate}" for protocol, rate in measured.get(name, {}).items()]
        lines += ["", f"## {name}", ""]
        if pictures:
            picture = out / "docs" / "images" / "tasks" / f"{name}.webp"
            draw(task, pack, picture)
            lines += [f"![{name}](images/tasks/{name}.webp)", ""]
        lines += [task.doc, ""]
        lines += [f"* mechanism: {task.mechanism}; arms: {task.arms}; {task.step_limit} steps"]
        lines += [f"* domain: {own}", f"* expert: {', '.join(shares) or 'not measured'}"]
    (out / "docs" / "tasks.md").write_text("\n".join(lines) + "\n")


def draw(task: Task, pack: Pack, path: Path) -> None:
    """Head-camera picture of the start of seed 0."""
    path.parent.mkdir(parents=True, exist_ok=True)
    episode = begin(Setting(task.name, PROTOCOL).at(0), task, pack)
    Image.fromarray(episode.observe().images["head"]).save(path, quality=80)


def main(out: str, *flags: str) -> None:
    """Stage all pages in `out`."""
    folder = Path(out).resolve()
    stage(folder)
    pictures = "--no-pictures" not in flags
    if pictures:
        renderer.configure()
        renderer.hold_anchor()
    tasks_page(folder, pictures)


if __name__ == "__main__":
    main(*sys.argv[1:])
