"""The report page: its data, and its behaviour in a real browser."""

import json
import re
import shutil
import subprocess
from pathlib import Path

import pytest
import synthetic
from collected import collect, labelled, write

from rtphys.data.dataset import Dataset
from rtphys.report import page as module
from rtphys.report.page import axes, write_report


@pytest.fixture(scope="module")
def dataset(tmp_path_factory: pytest.TempPathFactory) -> Dataset:
    out = tmp_path_factory.mktemp("report <!--<script> page")
    collect(out, 3)
    collect(out, 2, what=synthetic.header(task="press_bell"))
    return Dataset(out)


@pytest.fixture(scope="module")
def page(dataset: Dataset) -> Path:
    seen: list[tuple[int, int]] = []
    path = write_report(dataset, dataset.path / "report.html", lambda *at: seen.append(at))
    assert seen[-1] == (10, 10)
    return path


def data(page: Path) -> dict:
    found = re.search(r'<script type="application/json" id="data">(.*?)</script>', page.read_text())
    assert found
    return json.loads(found[1])


def test_data_is_the_dataset(page: Path, dataset: Dataset) -> None:
    facts = data(page)
    assert len(facts["episodes"]) == 5
    assert [a[1] for a in facts["attempts"]] == [1, 1, 0, 1, 1, 1]
    friction = [*axes()].index("friction")
    assert facts["parts"][0]["spans"][friction] == [0.01, 1.25]
    grippers = [*axes()].index("gripper_joint_damping")
    assert facts["parts"][0]["spans"][grippers] == [0.5, 3.0]  # the arms' range
    for row, episode in zip(facts["episodes"], dataset, strict=True):
        assert row["values"][friction] == episode.physics["friction"]
        assert row["video"].startswith("data:video/mp4;base64,")
        strain = episode.meta.verdict.strain
        assert (row["force"], row["torque"]) == (strain.force, strain.torque) and strain.force > 0
    assert facts["failures"] == []
    assert facts["attempts"][2][2 + friction] == 0.1, "a rejected attempt's physics is told"


def test_what_is_read_of_an_episode_is_forgotten(dataset: Dataset, tmp_path: Path) -> None:
    """0.3 MB each: a large dataset did not fit into memory."""
    fresh = Dataset(dataset.path)
    write_report(fresh, tmp_path / "report.html")
    assert not any({"frames", "meta"} & {*vars(one)} for one in fresh)


def test_failures_that_were_kept(tmp_path: Path) -> None:
    collect(tmp_path / "kept", 9, synthetic.header(keep_failures="all"), attempts=7)
    out = write_report(Dataset(tmp_path / "kept"), tmp_path / "report.html")
    first, second = data(out)["failures"]
    assert (first["seed"], first["reason"], first["event"]) == (2, "slipped", "slip")
    assert (first["frame"], first["when"], first["stage"]) == (2, 0.12, "press")
    assert len(first["around"]) == 3 and len({*first["around"]}) > 1, "the bell moves"
    assert second["video"].startswith("data:video/mp4;base64,")
    counted = data(out)["parts"][0]["rejections"]
    assert counted == {"slipped": 2} and len(data(out)["episodes"]) == 5


def test_cards_of_a_sweep_and_of_two_robots_have_names_of_their_own(tmp_path: Path) -> None:
    """Files are numbered anew under each value; a robot is named where there are several."""
    for value in (0.1, 0.5):
        collect(tmp_path / "data", 1, synthetic.header(overrides={"friction": value}))
    collect(tmp_path / "data", 1, synthetic.header(embodiment="franka-panda"))
    facts = data(write_report(Dataset(tmp_path / "data"), tmp_path / "report.html"))
    parts = [facts["parts"][one["part"]] for one in facts["episodes"]]
    names = {(part["protocol"], part["robot"]) for part in parts}
    assert len(names) == 3 and {robot for _, robot in names} == {"aloha-agilex", "franka-panda"}


def test_an_attribute_that_did_not_act_is_marked(tmp_path: Path) -> None:
    idle = {"could_act": False, "acted": False}
    made = labelled(restitution={"acted": False}, object_mass=idle)
    path = write_report(write(tmp_path / "data", made), tmp_path / "a.html")
    (row,), keys = data(path)["episodes"], axes().values()
    known = {key: (row["could_act"][n], row["acted"][n]) for n, key in enumerate(keys)}
    assert known["restitution"] == (True, False) and known["object_mass"] == (False, False)
    assert known["friction"] == (True, None), "nobody measured it"
    page = path.read_text()
    assert "(did not act)" in page and '"could not act"' in page


def test_page_needs_nothing_else(page: Path) -> None:
    text = page.read_text()
    assert not re.search(r'(src|href)="?https?:', text)
    assert text.count("</script>") == 2
    assert "text-overflow" not in text, "no value is cut off"
    assert text.count("name(part, ") == 2, "cards are named by task, configuration and number"


def test_part_of_a_dataset(dataset: Dataset, tmp_path: Path) -> None:
    path = write_report(dataset.where(task="click_bell"), tmp_path / "part.html")
    assert [part["task"] for part in data(path)["parts"]] == ["click_bell"]
    assert len(data(path)["attempts"]) == 4


# A document that takes everything, and prints what the page's script has made.
DOCUMENT = r"""
const page = require("fs").readFileSync(process.argv[1], "utf8");
const data = page.match(/id="data">([^]*?)<[/]script>/)[1];
const made = tag => ({tag, style: {}, value: "", children: [], setAttribute() {},
  append(...all) { this.children.push(...all); }, replaceChildren(...all) { this.children = all; },
  get firstChild() { return this.children[0]; }, addEventListener() {}});
const known = {data: {textContent: data}};
const createElement = made, createElementNS = (_, tag) => made(tag);
globalThis.document = {getElementById: id => known[id] ||= made(), createElement, createElementNS};
new Function(page.match(/<script>([^]*)<[/]script>/)[1])();
const [card] = known.episodes.children;
console.log([known.counts.textContent, card.children[0].tag, card.children[0].autoplay].join("; "));
"""


def shown(page: Path) -> str:
    node = shutil.which("node")
    if node is None:
        pytest.skip("needs node")
    done = subprocess.run([node, "-e", DOCUMENT, page], check=False, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


def test_a_page_of_very_many_attempts(page: Path, tmp_path: Path) -> None:
    """A function of node takes about 125,000 arguments."""
    facts = data(page)
    facts["attempts"] *= 40_000
    text = json.dumps(facts).replace("<", "\\u003c")
    many = tmp_path / "many.html"
    many.write_text(re.sub(r'(id="data">).*?(</script>)', lambda m: m[1] + text + m[2],
                           page.read_text()))  # fmt: skip
    assert shown(many).startswith("5 episodes, 240000 attempts (83 % accepted), 2 of 2")


def test_pictures_beyond_what_a_page_holds_are_those_of_the_videos(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """V8 holds no text of half a gigabyte: 100,000 thumbnails would be more."""
    collect(tmp_path / "kept", 9, synthetic.header(keep_failures="all"), attempts=7)
    monkeypatch.setattr(module, "EMBEDDED", -1)
    out = write_report(Dataset(tmp_path / "kept"), tmp_path / "report.html")
    facts = data(out)
    assert {one["thumb"] for one in facts["episodes"]} == {""}
    assert [one["around"] for one in facts["failures"]] == [[], []]
    assert facts["episodes"][0]["video"].endswith(".mp4") and out.stat().st_size < 100_000
    assert shown(out).endswith("; video; false")


def test_in_a_browser(page: Path) -> None:
    """Loads without errors, filters, and plays."""
    browser = shutil.which("chromium") or shutil.which("google-chrome")
    api = pytest.importorskip("playwright.sync_api", reason="needs playwright and Chromium")
    if browser is None:
        pytest.skip("needs Chromium")
    errors: list[str] = []
    with api.sync_playwright() as p:
        chromium = p.chromium.launch(executable_path=browser, args=["--no-sandbox"])
        tab = chromium.new_page()
        tab.on("pageerror", lambda error: errors.append(str(error)))
        tab.on("console", lambda m: errors.append(m.text) if m.type == "error" else None)
        tab.goto(page.as_uri())
        assert tab.locator(".episode").count() == 5
        assert tab.locator("#physics .box").count() == len(axes())
        tab.select_option("#axis", label="friction")
        values = sorted(
            float(t.split()[0])
            for t in tab.locator("dt:text-is('friction') + dd").all_inner_texts()
        )
        tab.fill("#from", str(values[-1] - 1e-3))
        kept = sum(value > values[-1] - 1e-3 for value in values)
        assert tab.locator(".episode").count() == kept < 5
        counts = f"{kept} episode{'s' * (kept > 1)}, {kept} attempt{'s' * (kept > 1)} (100 %"
        assert counts in tab.locator("#counts").inner_text()
        tab.click("#clear")
        tab.select_option("#task", "press_bell")
        assert tab.locator(".episode").count() == 2
        tab.click("#clear")
        assert tab.locator(".episode").count() == 5
        titles = tab.locator(".episode h3").all_inner_texts()
        assert len({*titles}) == len(titles) == 5
        wide = "[...document.querySelectorAll('dd')].filter(d => d.scrollWidth > d.clientWidth)"
        assert tab.evaluate(f"{wide}.length") == 0, "a value is cut off"
        tab.locator(".play").first.click()
        tab.wait_for_function("document.querySelector('video').currentTime > 0", timeout=10_000)
        chromium.close()
    assert errors == []
