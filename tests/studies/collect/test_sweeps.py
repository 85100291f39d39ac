"""Sweeps: one attribute held at each of several values, on the same seeds."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest
from collecting import PLAN, complete, content
from robotless import HARD, plans

from rtphys.campaign import series
from rtphys.core.errors import BadValue
from rtphys.data.attempts import Accepted, Rejected, read_attempts
from rtphys.data.dataset import Dataset
from rtphys.data.layout import TaskDataset
from rtphys.data.rewrite import subset
from rtphys.data.verify import verify
from rtphys.spec.collection import CollectionSpec
from rtphys.spec.sweep import families, paired, swept
from rtphys.studies.collect import collect
from rtphys.studies.requests import Run, shard_of, specs_for

VALUES = (0.1, 0.2, 1.0)
SWEEP = "friction=0.1,0.2,1"


def outcomes(out: Path, specs: Sequence[CollectionSpec]) -> list[dict[int, str]]:
    """Of each value seed -> "" or why it gave no episode."""
    found: list[dict[int, str]] = []
    for spec in specs:
        rows = read_attempts(TaskDataset.of(out, spec).ledger)
        found.append({r.seed: r.reason if isinstance(r, Rejected) else "" for r in rows})
    return found


@pytest.mark.usefixtures("without_robot")
def test_a_seed_is_kept_only_where_every_value_succeeds(tmp_path: Path) -> None:
    specs = specs_for(plans()[0], ["click_bell", "lift_pot"], SWEEP)
    assert complete(collect(specs, Run(tmp_path, workers=3)))
    for task in ("click_bell", "lift_pot"):
        own = [spec for spec in specs if spec.episode.task == task]
        of_value = outcomes(tmp_path, own)
        assert of_value[0].keys() == of_value[1].keys() == of_value[2].keys()
        seeds = [{seed for seed, why in of.items() if not why} for of in of_value]
        assert seeds[0] == seeds[1] == seeds[2] and len(seeds[0]) == own[0].episodes


@pytest.mark.usefixtures("without_robot")
def test_with_failures_every_seed_is_there_with_every_value(tmp_path: Path) -> None:
    (spec,) = plans(1, 5)
    specs = swept(replace(spec, keep_failures="all"), SWEEP)
    assert complete(collect(specs, Run(tmp_path / "a", workers=3)))
    of_value = outcomes(tmp_path / "a", specs)
    whole = [seed for seed in of_value[0] if not any(of[seed] for of in of_value)]
    assert len(whole) == 5 and whole[-1] == max(of_value[0])
    assert len({tuple(of.values()) for of in of_value}) > 1, "values fail in different seeds"
    for seed in of_value[0]:
        for one, of in zip(specs, of_value, strict=True):
            rows = read_attempts(TaskDataset.of(tmp_path / "a", one).ledger)
            (row,) = (row for row in rows if row.seed == seed)
            assert row.on_disk is not None and isinstance(row, Accepted) is not bool(of[seed])
    fewer = [replace(one, episodes=2) for one in specs]
    assert complete(collect(fewer, Run(tmp_path / "b", workers=2)))
    assert complete(collect(specs, Run(tmp_path / "b", workers=1)))
    assert content(tmp_path / "b") == content(tmp_path / "a")


@pytest.mark.usefixtures("without_robot")
def test_it_is_given_up_after_as_many_attempts_if_it_is_cut_off(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also where one value alone succeeds now and then."""
    monkeypatch.setattr(series, "FRUITLESS", 20)
    hard = replace(plans(1, 5)[0], keep_failures="all").of_task(HARD)
    specs = swept(hard, SWEEP)
    (whole,) = collect(specs, Run(tmp_path / "whole", workers=1))
    assert whole.stopped == "none of the last 20 attempts was accepted"
    cut = [replace(one, max_attempts=whole.attempts - 4) for one in specs]
    assert not complete(collect(cut, Run(tmp_path / "cut", workers=1)))
    (again,) = collect(specs, Run(tmp_path / "cut", workers=1))
    assert (again.stopped, again.new_attempts) == (whole.stopped, 4)
    assert content(tmp_path / "cut") == content(tmp_path / "whole")


@pytest.mark.usefixtures("without_robot")
@pytest.mark.parametrize("kept", [None, "all"])
def test_the_episodes_of_all_values_are_counted(kept: str | None, tmp_path: Path) -> None:
    specs = swept(replace(plans(1, 5)[0], keep_failures=kept), SWEEP)
    (first,) = collect([replace(one, episodes=2) for one in specs], Run(tmp_path, workers=1))
    assert first.made == len(Dataset(tmp_path))
    (then,) = collect(specs, Run(tmp_path, workers=1))
    assert first.made + then.made == len(Dataset(tmp_path))


def test_a_shard_has_all_values_of_a_sweep() -> None:
    specs = specs_for(plans(1)[0], ["click_bell", "lift_pot"], SWEEP)
    for text in ("1/2", "2/2"):
        own = shard_of(specs, text)
        assert len(own) == 3 and len({one.episode.task for one in own}) == 1
    first, second = (shard_of(specs[::2], f"{n}/4") for n in (1, 2))
    assert {one.shard for one in first} == {1} and {one.shard for one in second} == {2}
    assert [one.name for one in first] == [one.name for one in second]
    assert len(first) == 3


def test_values_are_in_the_order_of_the_sweep_and_twins_beside_theirs() -> None:
    spec = replace(plans(1)[0], twin="phys_random")
    mains = swept(spec, "friction=1,0.2,0.1")
    (family,) = families(mains[::-1])
    assert [one.swept for one in family] == [("friction", 1), ("friction", 0.2), ("friction", 0.1)]
    sides = [side for one in mains for side in one.sides]
    (group,) = paired(sorted(sides, key=lambda one: one.name))
    assert [one.name for one in group] == [one.name for one in sides]
    (other,) = swept(replace(spec, first_seed=9), "friction=1")
    assert len(families([*mains, other])) == 2
    kept = swept(replace(spec, keep_failures="3"), "friction=1,2")
    assert paired(kept) == []


def test_specs_of_many_tasks_are_compared_by_task_first(monkeypatch: pytest.MonkeyPatch) -> None:
    """A sweep of ten values of 50 tasks took seconds, each time that it was put in groups."""
    template = plans(1)[0]
    specs = [
        replace(one, episode=replace(one.episode, task=f"task{n}"))
        for n in range(20)
        for one in swept(template, "friction=0.2,1")
    ]
    made = list[CollectionSpec]()
    unswept = CollectionSpec.unswept.fget
    assert unswept is not None
    monkeypatch.setattr(
        CollectionSpec, "unswept", property(lambda one: made.append(one) or unswept(one))
    )
    assert len(families(specs)) == 20
    assert len(made) <= 2 * len(specs)


def test_twins_of_the_values_of_a_sweep_are_a_sweep_too() -> None:
    mains = swept(replace(plans(1)[0], twin="phys_random"), "friction=0.2,1")
    first, second = families([side for one in mains for side in one.sides])
    assert (first, second) == ([*mains], [one.sides[1] for one in mains])


def test_a_twin_that_cannot_hold_the_value_is_refused_as_such() -> None:
    with pytest.raises(BadValue, match=r"twin = 'clean' .* beside a sweep it must vary physics"):
        swept(replace(plans(1)[0], twin="clean"), "friction=0.2,1")


def test_a_sweep_holds_its_own_attribute() -> None:
    with pytest.raises(BadValue, match=r"sweep = 'friction=0\.1,0\.2'"):
        replace(plans(1)[0], sweep="friction=0.1,0.2")


@pytest.mark.sim
@pytest.mark.render
def test_a_sweep_is_sound_made_again_and_read_by_value(tmp_path: Path) -> None:
    specs = specs_for(replace(PLAN, episodes=2), ["click_bell"], "friction=0.1,0.5")
    assert complete(collect(specs, Run(tmp_path / "data", workers=1)))
    assert not verify(tmp_path / "data").problems
    groups = Dataset(tmp_path / "data").sweep()
    assert [list(group) for group in groups] == [[0.1, 0.5]] * 2
    for group in groups:
        assert len({one.seed for one in group.values()}) == 1
        assert [one.physics["friction"] for one in group.values()] == [0.1, 0.5]
        low, high = (dict(one.physics) for one in group.values())
        del low["friction"], high["friction"]
        assert low == high
    first = Dataset(tmp_path / "data").where(seeds=[groups[0][0.1].seed])
    subset(first, tmp_path / "part")
    assert len(Dataset(tmp_path / "part").sweep()) == 1 and not verify(tmp_path / "part").problems
