"""In every task the centre of mass that is put in force lies inside every body."""

from functools import lru_cache

import numpy as np
import pytest
from com_inside import Bodies, narrowed, survival
from scipy.optimize import linprog

from rtphys.assets.pack import default_pack
from rtphys.physics import Domain, domain_for_task, load_domain
from rtphys.physics.hull import inside
from rtphys.task.spec import load_task, task_names

pytestmark = pytest.mark.sim

SEEDS = range(12)


@lru_cache(maxsize=1)
def bodies() -> Bodies:
    return Bodies(default_pack())


def holds(vertices: np.ndarray, point: np.ndarray) -> bool:
    """Whether some weights, none negative and together 1, make the point of the vertices."""
    weights = np.vstack([vertices.T, np.ones(len(vertices))])
    return linprog(np.zeros(len(vertices)), A_eq=weights, b_eq=[*point, 1.0]).status == 0


def test_what_the_hull_of_a_cube_holds() -> None:
    cube = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    assert holds(cube, np.array([0.5, 0.99, 0.01]))
    assert not holds(cube, np.array([0.5, 1.01, 0.5]))


@pytest.mark.parametrize("name", task_names())
def test_it_lies_inside_every_body(name: str) -> None:
    """By the definition of a hull, which the sampler does not use."""
    task, domain = load_task(name), domain_for_task(name)
    for seed in SEEDS:
        solids = bodies().solids(task.props(seed))
        scale = domain.sample(seed).scalar("object_scale")
        named = {str(number): solid for number, solid in enumerate(solids)}
        physics = domain.sample(seed, inside=inside(named, domain.smallest_scale))
        assert physics.scalar("object_scale") == scale
        offset = np.array(physics.vector("center_of_mass"))
        for solid in solids:
            assert holds(np.asarray(solid.vertices) * scale, np.asarray(solid.com) * scale + offset)


def rejected(name: str, domain: Domain) -> float:
    return 1 - survival(name, domain, bodies(), range(60)).share


def test_a_narrow_domain_needs_no_second_draw_where_the_global_one_would() -> None:
    own = {name: rejected(name, domain) for name, domain in narrowed().items()}
    whole = {name: rejected(name, load_domain("global")) for name in own}
    assert len(own) >= 6
    assert set(own.values()) == {0.0}
    assert whole["dump_bin_bigbin"] > 0.8
    assert sum(share > 0.03 for share in whole.values()) >= 4


def test_rejection_narrows_the_spread_along_the_thin_axis_of_a_body() -> None:
    found = survival("move_playingcard_away", load_domain("global"), bodies(), range(200))
    assert 0.2 < found.share < 0.9
    assert (found.left < 0.8 * found.drawn).any()
    assert np.allclose(found.drawn, found.drawn.mean(), rtol=0.2)
