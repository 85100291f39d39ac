"""The command in real worlds: known answers, and the same file however it was made."""

import json
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pages import ran
from rtphys.analysis import sensitivity as module
from rtphys.analysis.sensitivity import (
    Axis,
    Bisection,
    Level,
    SearchSpec,
    SensitivityPlan,
    SensitivityRow,
    SensitivityTask,
    SensitivityWorker,
    TaskSensitivity,
    TaskSpec,
    answer,
    axes,
    sensitivity,
)
from rtphys.assets.pack import default_pack
from rtphys.campaign.local import limits_for_user_code
from rtphys.campaign.pool import Limits
from rtphys.campaign.series import Listener
from rtphys.cli.authoring import TEMPLATE
from rtphys.core import library
from rtphys.core.errors import BadValue, UnknownName
from rtphys.data.faults import DatasetMismatch
from rtphys.data.ledger import Ledger
from rtphys.episode.fingerprint import fingerprint_of
from rtphys.physics.attribute import attributes
from rtphys.physics.distribution import Fixed, SameAs
from rtphys.physics.load import domain_for_task, load_domain
from rtphys.spec.collection import CollectionSpec
from rtphys.spec.episode import EpisodeSpec
from rtphys.spec.stored import stored
from rtphys.studies.collect import without_effect
from rtphys.studies.requests import CertificationRun
from rtphys.task.spec import load_task

PACK = default_pack()


class Killed(BaseException):
    """Stands for a signal."""


class Killer(Listener):
    """Ends the run after so many rounds of results."""

    def __init__(self, after: int) -> None:
        self.left = after

    def ticked(self) -> None:
        self.left -= 1
        if self.left < 0:
            raise Killed


def plan(out: Path, workers: int = 1) -> SensitivityPlan:
    keys = ("camera_angle", "table_height")
    return SensitivityPlan(("click_bell",), SearchSpec(keys, seeds=2, steps=1), out, workers)


@dataclass(frozen=True)
class OldSpec:
    """The first line of a ledger before it knew the files of a policy."""

    task: str
    search: dict[str, Any]
    fingerprint: dict[str, Any]


class Silent(Listener):
    """Keeps what it is given to read."""

    def __init__(self) -> None:
        self.read: list[str] = []

    def noticed(self, text: str) -> None:
        self.read.append(text)


@pytest.fixture
def nobody_acts(monkeypatch: pytest.MonkeyPatch) -> None:
    """So there are no paired seeds."""
    monkeypatch.setattr(TaskSensitivity, "rounds", lambda self: iter(()))


def test_a_policy_that_cannot_run_in_a_task_is_refused(tmp_path: Path) -> None:
    search = SearchSpec(("friction",), "feels", seeds=1, steps=1)
    with pytest.raises(BadValue, match="lift_pot has no `feel`"):
        sensitivity(SensitivityPlan(("lift_pot",), search, tmp_path, 1), PACK)


def test_what_could_not_act_is_said_and_has_no_answer(tmp_path: Path, nobody_acts: None) -> None:
    search, heard = SearchSpec(("object_mass", "friction"), seeds=1, steps=1), Silent()
    plan = SensitivityPlan(("heavy_below",), search, tmp_path, 1)
    sensitivity(plan, PACK, heard)
    assert heard.read == [
        "object_mass could not act in heavy_below: every object that can move has its own value "
        "(object_mass@first, object_mass@second)"
    ]
    ground = fingerprint_of(load_task("heavy_below"), "phys_random", PACK).to_json()
    spec = TaskSpec("heavy_below", search, ground)
    assert TaskSensitivity(plan, spec).sides.keys() == {"friction"}


def test_the_attribute_of_one_prop_can_be_asked_for(tmp_path: Path, nobody_acts: None) -> None:
    """As `--set` and `collect --only` take it; a line says where a domain has no rule for it."""
    search, heard = SearchSpec(("friction@puck", "table_tilt"), seeds=1, steps=1), Silent()
    plan = SensitivityPlan(("slide_to_mark", "turn_switch"), search, tmp_path, 1)
    sensitivity(plan, PACK, heard)
    assert heard.read == [
        "table_tilt could not act in slide_to_mark: domain slide_to_mark does not vary it",
        "friction@puck could not act in turn_switch: domain turn_switch does not vary it",
    ]
    ground = fingerprint_of(load_task("slide_to_mark"), "phys_random", PACK).to_json()
    found = TaskSensitivity(plan, TaskSpec("slide_to_mark", search, ground)).sides
    assert [*found] == ["friction@puck"] and len(found["friction@puck"]) == 1
    with pytest.raises(UnknownName, match=r"unknown attribute 'fraction'; did you mean 'friction'"):
        SearchSpec(("fraction@puck",))


@pytest.mark.sim
def test_a_camera_cannot_matter_open_loop_and_a_lower_table_must(tmp_path: Path) -> None:
    (result,) = sensitivity(plan(tmp_path / "one"), PACK)
    attributes = result["attributes"]
    assert isinstance(attributes, dict) and result["seeds"] == [0, 1]
    assert attributes["camera_angle"]["share"] == 1.0
    assert attributes["table_height"]["share"] < 1.0
    file = tmp_path / "one" / "click_bell.json"
    before = file.read_bytes()
    sensitivity(plan(tmp_path / "one"), PACK)  # measures nothing again
    assert file.read_bytes() == before

    with pytest.raises(Killed):
        sensitivity(plan(tmp_path / "two"), PACK, Killer(2))
    sensitivity(plan(tmp_path / "two", workers=2), PACK)
    assert (tmp_path / "two" / "click_bell.json").read_bytes() == before
    assert sorted(p.name for p in (tmp_path / "two").glob("*.json")) == ["click_bell.json"]

    words = ["sensitivity", "--task", "click_bell", "--only", "camera_angle,table_height"]
    more = ["--seeds", "2", "--steps", "1", "--out", str(tmp_path / "one")]
    figure = tmp_path / "map.png"
    done = ran([*words, *more, "--figure", str(figure), "--json"])
    assert json.loads(done.stdout)[0]["attributes"] == attributes
    assert figure.read_bytes().startswith(b"\x89PNG")
    with pytest.raises(DatasetMismatch, match=r"search\.steps was 1, now 2"):
        sensitivity(replace(plan(tmp_path / "one"), search=SearchSpec(seeds=2, steps=2)), PACK)


CRASHES = """
class Silent(Exception):
    def __str__(self): raise RuntimeError
class Policy:
    needs_images = False
    def __init__(self, setup): self.at, self.split = setup.options['at'], setup.split
    def play(self, episode):
        spoken = ValueError(f'no {self.at} of {self.split}, which is {episode.recipe.spec.split}')
        raise (spoken, Silent(), OSError('caf\\udce9'))[episode.seed - 3]
    def close(self): 1 / 0
"""


@pytest.mark.sim
def test_a_policy_that_crashes_fails_and_its_error_is_said(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Also where the error cannot be said, nor the policy closed."""
    (file := tmp_path / "broken.py").write_text(CRASHES)
    search = SearchSpec(policy=f"python:{file}:Policy", options={"at": "act.pt"})
    worker = SensitivityWorker(PACK, search)
    for seed, said in (
        (3, "ValueError: no act.pt of seen, which is seen"),
        (4, "Silent: <exception str() failed>"),
        (5, "OSError: caf\\udce9"),
    ):
        assert not worker.do(SensitivityTask("click_bell", seed))
        out = capsys.readouterr().out.encode().decode()
        assert out.startswith(f"click_bell, seed {seed}: the policy fails by ")
        assert out.endswith(f"{said}\n")


GIVES_UP = """
class Policy:
    needs_images = False
    def __init__(self, setup): ...
    def play(self, episode): ...
    def close(self): ...
"""


@pytest.mark.sim
def test_a_policy_has_the_time_and_memory_that_it_has_in_evaluate(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A large one was killed at 6 GB or 600 CPU-s, and that counted as its failure."""

    class Seen(Exception):
        pass

    def pool(setup: object, size: int, limits: Limits) -> None:
        assert limits == limits_for_user_code(2, 77.0)
        raise Seen

    monkeypatch.setattr(module, "LocalPool", pool)
    with pytest.raises(Seen):
        sensitivity(SensitivityPlan(("click_bell",), out=tmp_path, timeout=77, workers=2), PACK)


def test_what_an_edited_policy_did_is_not_continued(tmp_path: Path) -> None:
    (file := tmp_path / "mine.py").write_text(GIVES_UP)
    search = SearchSpec(("friction",), f"python:{file}:Policy", 1, 1)
    plan = SensitivityPlan(("click_bell",), search, tmp_path / "out", 2)
    (first,) = sensitivity(plan, PACK)
    assert [first] == sensitivity(plan, PACK)
    file.write_text(f"{GIVES_UP}# another one")
    said = "out: .*policy_files: the files of the policy were edited since. Choose another folder"
    with pytest.raises(DatasetMismatch, match=said):
        sensitivity(plan, PACK)
    with pytest.raises(DatasetMismatch, match=r"search\.steps was 1, now 2"):
        sensitivity(replace(plan, search=replace(search, steps=2)), PACK)
    sensitivity(replace(plan, out=tmp_path / "other"), PACK)


def test_a_folder_without_a_digest_is_continued_where_the_actor_has_no_files(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "run_all", lambda *_: None)
    for policy, of in (("replay", ""), ("expert", ""), ("python:mine:make", "1")):
        search = SearchSpec(("friction",), policy, seeds=1, steps=1)
        plan = SensitivityPlan(("click_bell",), search, tmp_path / policy[:3], 1)
        ground = fingerprint_of(load_task("click_bell"), "phys_random", PACK).to_json()
        old = stored(TaskSpec("click_bell", search, ground))
        del old["policy_files"]
        path = plan.out / "click_bell.jsonl"
        Ledger(path, OldSpec(**old), SensitivityRow).start()
        if of:
            with pytest.raises(DatasetMismatch, match="does not record the files of the policy"):
                TaskSensitivity(plan, TaskSpec("click_bell", search, ground, of))
        else:
            sensitivity(plan, PACK)


def test_what_cannot_be_is_refused_before_any_work(tmp_path: Path) -> None:
    with pytest.raises(UnknownName, match="did you mean 'friction'"):
        SearchSpec(("frictoin",))
    with pytest.raises(BadValue, match="makes its own demonstrations"):
        SensitivityPlan(("click_bell",), SearchSpec(policy="replay:data"))
    with pytest.raises(UnknownName, match="policy"):
        SensitivityPlan(("click_bell",), SearchSpec(policy="repaly"))
    for policy in ("expert", "replay"):
        with pytest.raises(BadValue, match=rf"'speed=2' .*the policy {policy} has no options"):
            SensitivityPlan(("click_bell",), SearchSpec(policy=policy, options={"speed": "2"}))


DOMAINS = tuple(library.names("domains"))


@pytest.mark.parametrize("name", DOMAINS)
@pytest.mark.parametrize("key", attributes())
def test_every_level_can_be_held_and_the_end_is_the_domains(name: str, key: str) -> None:
    domain = load_domain(name)
    found, rule = axes(domain, key), domain.rules[key]
    source = domain.rules[rule.source] if isinstance(rule, SameAs) else rule
    assert bool(found) != isinstance(source, Fixed)
    for axis in found:
        for share in (0.01, 0.5, 1.0):
            held = axis.overrides(share, (0.001, -0.001, 0.0005))
            assert EpisodeSpec("click_bell", "clean", overrides=held).draw(3)[key] == held[key]
        if not axis.vector:
            mode = {key: v for key, v in axis.needs.items() if key == "camera_mode"}
            drawn = EpisodeSpec(
                "click_bell", "clean", overrides={**mode, key: axis.value(1.0)}
            ).draw(3)
            assert drawn[key] in source


def test_both_sides_of_nominal() -> None:
    low, high = axes(load_domain("global"), "friction")
    assert (low.nominal, low.end, high.end) == (0.5, 0.01, 1.25)
    assert low.value(0.5) == pytest.approx(0.255) and high.value(1.0) == 1.25
    (up,) = axes(load_domain("global"), "restitution")
    assert (up.nominal, up.end) == (0.0, 0.5)


def test_a_range_on_one_side_of_nominal_has_one_axis_to_its_farther_end() -> None:
    """The way from 0.5 to 0.13 is a part of that to 0.04, and counted twice it is 89 % of all."""
    (down,) = axes(domain_for_task("slide_to_mark"), "friction@puck")
    assert (down.nominal, down.end) == (0.5, 0.04)
    (held,) = axes(domain_for_task("carry_the_loaded"), "friction@beam")
    assert (held.nominal, held.end) == (0.5, 0.25)


def test_a_seed_without_a_layout_hides_no_attribute(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "tasks").mkdir()
    text = TEMPLATE.replace("where=free", "where=lambda s: draw.seed not in (0, 100_000)")
    (tmp_path / "tasks" / "late.py").write_text(text)
    monkeypatch.setenv("RTPHYS_LIBRARY", str(tmp_path))
    plan = SensitivityPlan(("late",), SearchSpec(("object_mass",)), tmp_path / "out", 1)
    task = TaskSensitivity(plan, TaskSpec("late", plan.search, {}))
    assert not task.idle and len(task.sides["object_mass"]) == 2
    run = CertificationRun(("late",), ("only_object_mass",), tmp_path)
    assert not run.left_out()
    assert without_effect([CollectionSpec(EpisodeSpec("late", "only_object_mass"))]) == []


AXIS = Axis("friction", 0.5, 0.1)


def search(threshold: float, steps: int, seeds: int = 10) -> Bisection:
    """All seeds succeed up to a share of the way, none beyond."""
    bisection = Bisection(AXIS, steps)
    while (share := bisection.next) is not None:
        successes = seeds if share <= threshold else 0
        bisection.levels.append(Level(share, successes, seeds))
    return bisection


@given(st.floats(0, 0.999), st.integers(0, 10))
def test_the_answer_is_bracketed_to_the_last_halving(threshold: float, steps: int) -> None:
    found = search(threshold, steps)
    low, high = found.bracket
    assert low <= threshold < high and high - low == pytest.approx(0.5**steps)
    assert len(found.levels) == steps + 1
    assert found.interval == (low, high)


def test_a_range_that_is_tolerated_takes_one_level() -> None:
    found = search(1.0, 5)
    assert found.bracket == (1.0, 1.0) and len(found.levels) == 1
    assert found.to_json()["tolerance"] == 0.1


def test_half_of_the_seeds_holds_but_is_not_sure() -> None:
    found = Bisection(AXIS, 1, [Level(1.0, 0, 10), Level(0.5, 5, 10)])
    assert found.bracket == (0.5, 1.0) and found.interval == (0.0, 1.0)


def test_the_share_of_a_range_counts_both_sides_by_their_width() -> None:
    below, above = search(1.0, 2), Bisection(Axis("friction", 0.5, 1.3), 1)
    above.levels += [Level(1.0, 0, 10), Level(0.5, 10, 10)]
    found = answer([below, above])
    assert found["range"] == [0.1, 1.3] and found["tolerance"] == [0.1, 0.9]
    assert found["share"] == pytest.approx((0.4 + 0.4) / (0.4 + 0.8))
