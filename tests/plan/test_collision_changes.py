"""A checker that moved, swapped and re-ruled its bodies answers as one that knows only these."""

import numpy as np
from b1_arms import LIMITS

from rtphys.core.poses import Pose
from rtphys.plan.collision import CollisionChecker, Obstacle

TABLE = Obstacle("table", np.array([0.6, 0.35, 0.025]), Pose((0, 0, 0.715)))
CUBE = np.array([(x, y, z) for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
IN_HAND = 0.02 * CUBE + np.array([0.15, 0, 0])  # [m] link6 frame
NAMES = ("a", "b", "c")


class State:
    """What a checker should know, and a random walk through it."""

    def __init__(self, seed: int) -> None:
        self.rng = np.random.default_rng(seed)
        self.places = {name: self._place() for name in NAMES}
        self.shapes = {name: np.full(3, 0.03) for name in NAMES}
        self.load = IN_HAND
        self.ignored: set[tuple[str, str]] = set()
        self.carried: str | None = None

    def _place(self) -> Pose:
        return Pose(self.rng.uniform([-0.4, -0.3, 0.75], [0.4, 0.2, 1.0]))

    def change(self, checker: CollisionChecker) -> None:
        """One change, told to the checker as the expert would."""
        name = str(self.rng.choice(NAMES))
        match self.rng.integers(5):
            case 0:
                self.places[name] = self._place()
                checker.set_obstacles(self.obstacles())
            case 1:
                self.ignored.add(("right", name))
                checker.ignore("right", name)
            case 2:
                self.ignored.discard(("right", name))
                checker.stop_ignoring("right", name)
            case 3:
                checker.detach("left")
                self.carried = None if self.carried else name
                checker.set_obstacles(self.obstacles())
                if self.carried:
                    self.load = IN_HAND * self.rng.uniform(0.5, 2)
                    checker.attach("left", name, self.load)
            case 4:  # as from one episode to the next: another size, now and then another kind
                half = self.rng.uniform(0.01, 0.1, 3)
                self.shapes[name] = half if self.rng.random() < 0.6 else half * CUBE
                checker.set_obstacles(self.obstacles())

    def obstacles(self) -> list[Obstacle]:
        """Everything that is not carried."""
        free = [n for n in NAMES if n != self.carried]
        return [TABLE, *(Obstacle(n, self.shapes[n], self.places[n]) for n in free)]

    def tell(self, checker: CollisionChecker) -> None:
        """All at once, to a checker that knows nothing."""
        checker.reset()
        checker._models.clear()
        checker.set_obstacles(self.obstacles())
        if self.carried:
            checker.attach("left", self.carried, self.load)
        for side, name in self.ignored:
            checker.ignore(side, name)


def test_changes_leave_no_trace(embodiment) -> None:
    changed, fresh = CollisionChecker(embodiment), CollisionChecker(embodiment)
    state, touched = State(0), 0
    changed.set_obstacles(state.obstacles())
    for _ in range(60):
        state.change(changed)
        state.tell(fresh)
        assert changed.pair_count == fresh.pair_count
        for q in state.rng.uniform(LIMITS[:, 0], LIMITS[:, 1], (12, 2, 6)):
            found = changed.contacts(*q)
            assert found == fresh.contacts(*q)
            assert changed.clear(*q) == (not found)
            touched += bool(found)
    assert 0 < touched < 720


def test_a_set_of_bodies_that_comes_back_is_not_made_anew(embodiment) -> None:
    checker, state = CollisionChecker(embodiment), State(1)
    q = np.zeros(6)
    checker.set_obstacles(state.obstacles())
    checker.clear(q, q)
    first = checker._model
    checker.attach("left", "a", IN_HAND)
    checker.clear(q, q)
    assert checker._model is not first
    checker.detach("left")
    checker.set_obstacles(state.obstacles())
    checker.clear(q, q)
    assert checker._model is first


def test_models_are_kept_while_they_are_small(embodiment, monkeypatch) -> None:
    checker, q = CollisionChecker(embodiment), np.zeros(6)

    def kept(most: int) -> int:
        monkeypatch.setattr("rtphys.plan.collision._KEPT_PAIRS", most)
        for k in range(6):
            thing = Obstacle(f"thing {k}", np.full(3, 0.03), Pose((0, 0, 2)))
            checker.set_obstacles([TABLE, thing])
            checker.clear(q, q)
        return len(checker._models)

    assert kept(10**6) == 6
    assert kept(3 * checker.pair_count) == 3
    assert kept(1) == 1
