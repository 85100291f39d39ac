"""Another domain than the task's own: drawn from, recorded whole, seen by resume and verify."""

from dataclasses import replace
from pathlib import Path

import pytest
from collecting import complete

from rtphys.assets.pack import default_pack
from rtphys.core.errors import BadValue
from rtphys.data.dataset import Dataset
from rtphys.data.faults import DatasetMismatch
from rtphys.data.verify import verify
from rtphys.physics import Domain, load_domain
from rtphys.spec.collection import CollectionSpec
from rtphys.spec.episode import EpisodeSpec
from rtphys.spec.recording import RecordingSpec
from rtphys.spec.stored import stored as spec_json
from rtphys.studies.collect import check, collect, header_of
from rtphys.studies.requests import Run
from rtphys.task.spec import load_task

ICY = """\
extends: global
physics:
  friction: {uniform: [0.3, 0.4]}
"""


@pytest.fixture
def icy(tmp_path: Path) -> Domain:
    path = tmp_path / "icy.yaml"
    path.write_text(ICY)
    return load_domain(path)


def test_a_recipe_draws_from_the_given_domain_and_holds_it_whole(icy: Domain) -> None:
    recipe = EpisodeSpec("click_bell", "phys_random", ranges=icy).at(3)
    assert 0.3 <= recipe.spec.domain.sample(3).scalar("friction", 0.0) <= 0.4
    stored = spec_json(recipe)["spec"]["ranges"]
    assert isinstance(stored, dict)
    assert Domain.from_json(stored).digest == icy.digest
    assert (
        recipe.spec.domain.digest
        != EpisodeSpec("click_bell", "phys_random").at(3).spec.domain.digest
    )


def test_a_protocol_without_physics_stays_nominal(icy: Domain) -> None:
    assert not EpisodeSpec("click_bell", "clean", ranges=icy).at(3).spec.domain.rules
    plan = CollectionSpec(EpisodeSpec("click_bell", "clean", ranges=icy), episodes=1)
    with pytest.raises(BadValue, match=r"icy.*varies no physics"):
        check([plan], Run())


def test_the_header_holds_the_domain(icy: Domain) -> None:
    spec = EpisodeSpec("beat_block_hammer", "phys_random")
    specs = [CollectionSpec(one) for one in (spec, replace(spec, ranges=icy))]
    task, pack = load_task("beat_block_hammer"), default_pack()
    own, other = (header_of(one, task, pack).resolved.domain for one in specs)
    assert (own["name"], other["name"]) == ("beat_block_hammer", "icy")
    assert other["digest"] == icy.digest


@pytest.mark.sim
@pytest.mark.render
def test_episodes_verify_and_another_domain_does_not_continue_them(
    icy: Domain, tmp_path: Path
) -> None:
    out = tmp_path / "data"
    spec, run = EpisodeSpec("click_bell", "phys_random", ranges=icy), Run(out, workers=1)
    plan = CollectionSpec(spec, episodes=1, recording=RecordingSpec(cameras=("head",)))
    assert complete(collect([plan], run))
    assert verify(out).problems == []
    (episode,) = Dataset(out)
    assert 0.3 <= float(str(episode.meta.attributes["friction"].value)) <= 0.4
    with pytest.raises(DatasetMismatch, match="domain"):
        collect([replace(plan, episodes=2, episode=replace(spec, ranges=None))], run)
