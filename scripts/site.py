"""Stage the pages of the documentation site: `site.py OUT [--no-pictures]`.

Every document keeps its place, so that links between them hold. One page is made here: every task
with its success condition, rates and tolerance, and its first certified episode, which is solved
and drawn now (minutes) and never committed.
"""

import re
import shutil
import sys
from pathlib import Path

from pictures import head_camera

import results
from rtphys.assets.pack import Pack, default_pack
from rtphys.core import library
from rtphys.episode.generate import attempt
from rtphys.physics.attribute import attribute
from rtphys.results.instances import benchmark_file, read_list
from rtphys.sim import renderer
from rtphys.spec.episode import EpisodeSpec
from rtphys.studies.rates import rates
from rtphys.task.spec import Task, load_task, task_names

ROOT = Path(__file__).resolve().parents[1]
PAGES = ("README.md", "CONTRIBUTING.md", "CHANGELOG.md")
PROTOCOL = "phys_random"
FRAME_MS = 60  # between two recorded frames
MAX_PICTURES = 32  # of one episode


def stage(out: Path) -> None:
    """Copy all documents.

    Links to what the site does not hold become names of files. A picture leads to itself, because
    most are wider than a page.
    """
    shutil.rmtree(out, ignore_errors=True)
    shutil.copytree(ROOT / "docs", out / "docs")
    for name in PAGES:
        shutil.copy(ROOT / name, out / name)
    for page in out.rglob("*.md"):
        text = _linked(page.read_text(), page.parent, out)
        if not re.search("^(## |::: )", text, re.MULTILINE):  # room for its table instead
            text = f"---\nhide: [toc]\n---\n\n{text}"
        page.write_text(text)


def _linked(text: str, folder: Path, out: Path) -> str:
    def replaced(link: re.Match[str]) -> str:
        words, target = link[1], link[2].partition("#")[0]
        if not target or "://" in target:
            return link[0]
        path = (folder / target).resolve()
        held = path.is_file() or path == out / "docs" / "tasks.md"
        name = f"`{path.relative_to(out)}`"
        return link[0] if held else name if words.strip("`") in name else f"{words} ({name})"

    text = re.sub(r"(?<!!)\[([^\]]+)\]\(([^)\s]+)\)", replaced, text)
    return re.sub(r"!\[[^\]]*\]\(([^)\s]+)\)", r"[\g<0>](\1)", text)


def tasks_page(out: Path, pictures: bool) -> None:
    """Write docs/tasks.md: what each task is, when it counts as solved, and how often it is."""
    names, measured, domains = task_names(), rates(), library.names("domains")
    lines = [
        "# Every task",
        "",
        f"The {len(names)} tasks: what the robot does, what counts as success, the share of tried "
        "seeds that the expert solves under each protocol, and the values of each attribute with "
        "which open-loop replays of clean demonstrations still succeed "
        "([Sensitivity](sensitivity.md)). *Upstream* is RoboTwin.",
    ]
    if pictures:
        lines[-1] += (
            f" The pictures show the first certified episode under `{PROTOCOL}` at real speed, as "
            "the head camera sees it."
        )
    pack = default_pack()
    for name in names:
        task = load_task(name)
        own = f"`{name}`" if name in domains else "`global`"
        shares = [f"`{protocol}` {rate}" for protocol, rate in measured.get(name, {}).items()]
        lines += ["", f"## {name}", ""]
        if pictures:
            picture = out / "docs" / "images" / "tasks" / f"{name}.webp"
            draw(task, pack, picture)
            lines += [f"![{name}](images/tasks/{name}.webp)", ""]
        lines += [task.doc, ""]
        lines += [f"* mechanism: {task.mechanism}; arms: {task.arms}; {task.step_limit} steps"]
        lines += [f"* domain: {own}", f"* the expert solves: {', '.join(shares) or 'not measured'}"]
        lines += [f"* replays tolerate: {tolerance(name)}"]
    (out / "docs" / "tasks.md").write_text("\n".join(lines) + "\n")


def tolerance(name: str) -> str:
    """What a replay of clean demonstrations of a task tolerates of each attribute, in words."""
    found = results.load("sensitivity_replay").get(name)
    if found is None:
        return "not measured"
    narrow = []
    for key, one in found["attributes"].items():
        if one["share"] < 1:
            (low, high), (least, most) = one["tolerance"], one["range"]
            unit = attribute(key).unit.strip("1")
            tolerated = f"`{key}` {low:.3g} to {high:.3g} {unit}".rstrip()
            narrow.append(f"{tolerated} (range: {least:g} to {most:g})")
    count = len(found["seeds"])
    rest = "all other attributes in" if narrow else "all attributes in"
    return f"{'; '.join([*narrow, rest])} their whole range ({count} seeds)"


def draw(task: Task, pack: Pack, path: Path) -> None:
    """Moving picture of the first certified seed that the expert solves here."""
    path.parent.mkdir(parents=True, exist_ok=True)
    listed = read_list(benchmark_file(PROTOCOL, task.name), task.name)
    for one in listed.instances if listed else ():
        recipe = EpisodeSpec(task.name, PROTOCOL).at(one.seed)
        if one.feasible and (result := attempt(recipe, task, pack)).accepted and result.recording:
            break
    else:
        raise SystemExit(f"{task.name}: the expert solves none of its certified seeds")
    rows = len(result.recording.rows)
    shown = min(MAX_PICTURES, rows)
    moments = [round(i * (rows - 1) / (shown - 1)) for i in range(shown)]
    first, *others = head_camera(recipe, result.recording, moments)
    pause = FRAME_MS * rows // shown
    first.save(path, save_all=True, append_images=others, duration=pause, loop=0, quality=70)


def main(out: str, *flags: str) -> None:
    """Stage all pages in `out`."""
    folder = Path(out).resolve()
    stage(folder)
    pictures = "--no-pictures" not in flags
    if pictures:
        renderer.configure()
    tasks_page(folder, pictures)


if __name__ == "__main__":
    main(*sys.argv[1:])
